"""The source of the dearest kernels, with what each line cost: its work, and what it waited for."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from bfsim.report.profile.costs import Cost
from bfsim.trace import KernelRecord, RunRecord

MOST = 12
"""Kernels whose source is shown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceLine:
    """A line of a kernel over the whole run; `share` is its part of the kernel's cycles and `issue_share` that of its work, 0..1."""

    line: int
    text: str
    executions: int
    cost: Cost
    share: float
    issue_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class KernelSource:
    """A kernel in one stage on all cores, without its callees; `share` is its part of the cycles of all kernels, 0..1."""

    kernel: str
    stage: str
    place: str
    calls: int
    cost: Cost
    share: float
    lines: tuple[SourceLine, ...]


def dearest_sources(run: RunRecord, most: int = MOST) -> tuple[KernelSource, ...]:
    """Return the kernels of a run that took most cycles, stalls included, the dearest first."""
    groups: dict[tuple[str, str, str], list[KernelRecord]] = {}
    for record in run.kernels:
        groups.setdefault((record.stage, record.kernel, record.symbol), []).append(record)
    whole_cclk = sum(record.elapsed_cclk for record in run.kernels)
    sources = [_source(records, whole_cclk) for records in groups.values()]
    return tuple(sorted(sources, key=lambda each: -each.cost.elapsed_cclk)[:most])


def _source(records: Sequence[KernelRecord], whole_cclk: int) -> KernelSource:
    first, cost = records[0], Cost()
    for record in records:
        cost.add(record.issue_cclk, record.stall_cclk)
    return KernelSource(
        kernel=first.kernel,
        stage=first.stage,
        place=f"{PurePath(first.file).name}:{first.first_line}",
        calls=sum(record.calls for record in records),
        cost=cost,
        share=_part(cost.elapsed_cclk, whole_cclk),
        lines=_lines(records, cost.elapsed_cclk),
    )


def _lines(records: Sequence[KernelRecord], kernel_cclk: int) -> tuple[SourceLine, ...]:
    """Add up the lines of a kernel on different cores; those without a cost stand among them."""
    executions, costs = Counter[int](), defaultdict[int, Cost](Cost)
    for line in (line for record in records for line in record.lines):
        executions[line.line] += line.executions
        costs[line.line].add(line.issue_cclk, line.stall_cclk)
    return tuple(
        SourceLine(
            line=number,
            text=text.expandtabs().rstrip(),
            executions=executions[number],
            cost=costs[number],
            share=_part(costs[number].elapsed_cclk, kernel_cclk),
            issue_share=_part(costs[number].issue_cclk, kernel_cclk),
        )
        for number, text in enumerate(records[0].text, start=records[0].first_line)
    )


def _part(cclk: int, of_cclk: int) -> float:
    return cclk / of_cclk if of_cclk else 0.0
