"""The source of the dearest kernels, with the cost of each line: its work, and its waits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bfsim.report.profile.cost import Cost
from bfsim.report.profile.library import in_callers
from bfsim.report.profile.lines import LineProfile, lines_of, place_of
from bfsim.trace import KernelRecord, RunRecord

MOST = 12
"""The number of kernels whose source is shown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceLine:
    """A line of a kernel over the whole run; `share` is its part of the kernel's cycles, `issue_share` of its work."""

    line: int
    text: str
    executions: int
    cost: Cost
    share: float
    issue_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class KernelSource:
    """A kernel in one stage on all cores, without its callees, but with routines of the compiler's library.

    `share` is its part of the cycles of all kernels, 0..1.
    """

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
    for record in in_callers(run.kernels):
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
        place=place_of(first),
        calls=sum(record.calls for record in records),
        cost=cost,
        share=_part(cost.elapsed_cclk, whole_cclk),
        lines=tuple(_line(each, cost.elapsed_cclk) for each in lines_of(records)),
    )


def _line(line: LineProfile, kernel_cclk: int) -> SourceLine:
    return SourceLine(
        line=line.line,
        text=line.text.expandtabs().rstrip(),
        executions=line.executions,
        cost=line.cost,
        share=_part(line.cost.elapsed_cclk, kernel_cclk),
        issue_share=_part(line.cost.issue_cclk, kernel_cclk),
    )


def _part(cclk: int, of_cclk: int) -> float:
    return cclk / of_cclk if of_cclk else 0.0
