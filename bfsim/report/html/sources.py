"""The source of the dearest kernels, with what each line cost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from bfsim.trace import KernelRecord, RunRecord

MOST = 12
"""Kernels whose source is shown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceLine:
    """A line of a kernel, and its cycles over the whole run; `share` is its part of the kernel, 0..1."""

    line: int
    text: str
    executions: int
    issue_cclk: int
    stall_cclk: int
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class KernelSource:
    """A kernel in one stage on all cores; `share` is its part of the cycles of all kernels, 0..1."""

    kernel: str
    stage: str
    place: str
    calls: int
    issue_cclk: int
    share: float
    lines: tuple[SourceLine, ...]


def dearest_sources(run: RunRecord, most: int = MOST) -> tuple[KernelSource, ...]:
    """Return the kernels of a run that took most cycles, the dearest first."""
    groups: dict[tuple[str, str, str, int], list[KernelRecord]] = {}
    for record in run.kernels:
        key = record.stage, record.kernel, record.file, record.first_line
        groups.setdefault(key, []).append(record)
    whole_cclk = sum(record.issue_cclk for record in run.kernels)
    sources = [_source(records, whole_cclk) for records in groups.values()]
    return tuple(sorted(sources, key=lambda each: -each.issue_cclk)[:most])


def _source(records: Sequence[KernelRecord], whole_cclk: int) -> KernelSource:
    first = records[0]
    issue_cclk = sum(record.issue_cclk for record in records)
    return KernelSource(
        kernel=first.kernel,
        stage=first.stage,
        place=f"{PurePath(first.file).name}:{first.first_line}",
        calls=sum(record.calls for record in records),
        issue_cclk=issue_cclk,
        share=issue_cclk / whole_cclk if whole_cclk else 0.0,
        lines=_lines(records),
    )


def _lines(records: Sequence[KernelRecord]) -> tuple[SourceLine, ...]:
    """Add up the lines of a kernel on different cores; those without a cost stand among them."""
    executions, issue_cclk, stall_cclk = Counter[int](), Counter[int](), Counter[int]()
    for record in records:
        for cost in record.lines:
            executions[cost.line] += cost.executions
            issue_cclk[cost.line] += cost.issue_cclk
            stall_cclk[cost.line] += sum(cost.stall_cclk.values())
    whole_cclk = sum(issue_cclk.values()) + sum(stall_cclk.values())
    return tuple(
        SourceLine(
            line=line,
            text=text.expandtabs().rstrip(),
            executions=executions[line],
            issue_cclk=issue_cclk[line],
            stall_cclk=stall_cclk[line],
            share=(issue_cclk[line] + stall_cclk[line]) / whole_cclk if whole_cclk else 0.0,
        )
        for line, text in enumerate(records[0].text, start=records[0].first_line)
    )
