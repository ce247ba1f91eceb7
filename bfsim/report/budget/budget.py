"""The frame timing budget: what each stage cost each core, over all frames of a run.

Every number is in whole CCLK cycles; only the frame rate is a float.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

from bfsim.report.budget.rows import budget_rows, costs_in, elapsed_cclk
from bfsim.report.budget.spread import Spread
from bfsim.report.budget.times import frame_rate_hz, latency_cclk
from bfsim.trace import BudgetRow, CoreFrame, RunRecord, StageCost, StallReason

FRAME = "Frame"
"""The row that sums up all others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StageRow:
    """One row of one core's budget. `issue_cclk`, `stall_cclk` and `idle_cclk` are totals over all frames.

    `within` is the row that this one is a part of; that row holds its cycles, too.
    """

    name: str
    within: str | None
    reference_ms: float | None
    elapsed_cclk: Spread
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]
    idle_cclk: int

    @property
    def stalled_cclk(self) -> int:
        """Stalls for any reason."""
        return sum(self.stall_cclk.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class CoreBudget:
    """The rows of one core, and `frame`, the sum of those that are not part of another."""

    core: str
    rows: tuple[StageRow, ...]
    frame: StageRow

    @property
    def all_rows(self) -> tuple[StageRow, ...]:
        """The rows, with the frame as the last one."""
        return (*self.rows, self.frame)

    def share(self, row: StageRow) -> float:
        """Share of the frame time that `row` took over the whole run, 0..1."""
        return row.elapsed_cclk.total / self.frame.elapsed_cclk.total


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """A run in numbers: the budgets of the cores, core A first, the frame rate, and the latency of results."""

    cores: tuple[CoreBudget, ...]
    frame_rate_hz: float
    latency_cclk: Spread


def budget_of(run: RunRecord) -> Budget:
    """Derive the budget of a run of at least one frame."""
    rows = budget_rows(run)
    cores = zip(*(frame.cores for frame in run.frames), strict=True)
    return Budget(
        cores=tuple(_core_budget(frames, rows) for frames in cores),
        frame_rate_hz=frame_rate_hz(run.frames, run.identity.cclk_hz),
        latency_cclk=Spread.of([latency_cclk(frame) for frame in run.frames]),
    )


def _core_budget(frames: Sequence[CoreFrame], rows: Sequence[BudgetRow]) -> CoreBudget:
    known_ms = [row.reference_ms for row in rows if row.reference_ms is not None]
    whole = BudgetRow(stage=FRAME, reference_ms=sum(known_ms) if known_ms else None)
    return CoreBudget(
        core=frames[0].core,
        rows=tuple(_row(row, costs_in(frames, row, rows)) for row in rows),
        frame=_row(whole, [frame.stages for frame in frames]),
    )


def _row(row: BudgetRow, costs: Sequence[Sequence[StageCost]]) -> StageRow:
    """Sum up a row, given its costs in each frame."""
    stall = dict.fromkeys(StallReason, 0)
    for cost in chain(*costs):
        for reason, cclk in cost.stall_cclk.items():
            stall[reason] += cclk
    return StageRow(
        name=row.stage,
        within=row.within,
        reference_ms=row.reference_ms,
        elapsed_cclk=Spread.of([elapsed_cclk(each) for each in costs]),
        issue_cclk=sum(cost.issue_cclk for cost in chain(*costs)),
        stall_cclk={reason: cclk for reason, cclk in stall.items() if cclk},
        idle_cclk=sum(cost.idle_cclk for cost in chain(*costs)),
    )
