"""The frame timing budget: what each stage cost each core, over all frames of a run.

Every number is in whole CCLK cycles; only the frame rate is a float. The median and the 95th percentile are
nearest-rank, so each is a cost that one frame really had.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

from bfsim.trace import REST, BudgetRow, CoreFrame, FrameRecord, RunRecord, StageCost, StallReason

FRAME = "Frame"
"""The row that sums all others."""

FRAMES_FOR_P95 = 20
"""A p95 is worth telling of so many frames: of fewer, the nearest rank of 95 % is the last one, the maximum."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """How a number varied from frame to frame, in the number's own unit."""

    minimum: int
    median: int
    p95: int
    maximum: int
    total: int

    @classmethod
    def of(cls, values: Sequence[int]) -> Spread:
        """Summarise at least one value."""
        ranked = sorted(values)
        return cls(
            minimum=ranked[0],
            median=_nearest_rank(ranked, 50),
            p95=_nearest_rank(ranked, 95),
            maximum=ranked[-1],
            total=sum(ranked),
        )


def _nearest_rank(ranked: Sequence[int], percent: int) -> int:
    return ranked[-(-len(ranked) * percent // 100) - 1]


@dataclass(frozen=True, slots=True, kw_only=True)
class StageRow:
    """One row of one core's budget. `issue_cclk`, `stall_cclk` and `idle_cclk` are totals over all frames.

    `within` is the row that this one is a part of, and that holds its cycles too.
    """

    name: str
    within: str | None
    reference_ms: float | None
    elapsed_cclk: Spread
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]
    idle_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CoreBudget:
    """The rows of one core, and `frame`, which those that are no part of another sum to."""

    core: str
    rows: tuple[StageRow, ...]
    frame: StageRow

    @property
    def all_rows(self) -> tuple[StageRow, ...]:
        """The rows, and the frame as the last one."""
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


def milliseconds(cclk: float, cclk_hz: float) -> float:
    """Convert cycles to ms."""
    return cclk * 1000 / cclk_hz


def frame_rate_hz(frames: Sequence[FrameRecord], cclk_hz: float) -> float:
    """Frames per second from frame end to frame end; of a single frame, one over its duration.

    Firmware that waits for every picture is as fast as these come, from picture to picture: in a few frames, a first one that took
    long would make it faster than its cameras.
    """
    ends = [max(core.end_cclk for core in frame.cores) for frame in frames]
    if len(frames) == 1:
        return cclk_hz / (ends[0] - min(core.begin_cclk for core in frames[0].cores))
    if all(_idles(core) for frame in frames[1:] for core in frame.cores):
        ends = [frame.last_line_cclk for frame in frames]
    return (len(frames) - 1) * cclk_hz / (ends[-1] - ends[0])


def _idles(frame: CoreFrame) -> bool:
    return any(cost.idle_cclk for cost in frame.stages)


def latency_cclk(frame: FrameRecord) -> int:
    """Cycles from the last line coming in to the result going out."""
    return frame.result_cclk - frame.last_line_cclk


def has_p95(run: RunRecord) -> bool:
    """Whether a run has frames enough for a p95."""
    return len(run.frames) >= FRAMES_FOR_P95


def stage_names(run: RunRecord) -> tuple[str, ...]:
    """The rows of the budget in the firmware's order; (the rest) comes last."""
    declared = [row.stage for row in run.rows]
    seen = [cost.stage for frame in run.frames for core in frame.cores for cost in core.stages]
    return (*(name for name in dict.fromkeys([*declared, *seen]) if name != REST), REST)


def budget_rows(run: RunRecord) -> tuple[BudgetRow, ...]:
    """The rows of the budget, with those that the firmware did not declare."""
    declared = {row.stage: row for row in run.rows}
    return tuple(declared.get(name, BudgetRow(stage=name)) for name in stage_names(run))


def costs_of(frame: CoreFrame, row: BudgetRow, rows: Sequence[BudgetRow]) -> list[StageCost]:
    """What `row` cost one core in one frame, with its parts among `rows`."""
    stages = {row.stage, *(each.stage for each in rows if each.within == row.stage)}
    return [cost for cost in frame.stages if cost.stage in stages]


def elapsed_cclk(costs: Iterable[StageCost]) -> int:
    """Cycles of all these together."""
    return sum(cost.elapsed_cclk for cost in costs)


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
        rows=tuple(_row(row, [costs_of(frame, row, rows) for frame in frames]) for row in rows),
        frame=_row(whole, [frame.stages for frame in frames]),
    )


def _row(row: BudgetRow, costs: Sequence[Sequence[StageCost]]) -> StageRow:
    """Sum up a row whose costs are given for each frame."""
    stall: Counter[StallReason] = Counter()
    for cost in chain(*costs):
        stall.update(cost.stall_cclk)
    return StageRow(
        name=row.stage,
        within=row.within,
        reference_ms=row.reference_ms,
        elapsed_cclk=Spread.of([elapsed_cclk(each) for each in costs]),
        issue_cclk=sum(cost.issue_cclk for cost in chain(*costs)),
        stall_cclk={reason: stall[reason] for reason in StallReason if stall[reason]},
        idle_cclk=sum(cost.idle_cclk for cost in chain(*costs)),
    )
