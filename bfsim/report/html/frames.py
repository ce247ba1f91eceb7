"""Which frames of a run a page shows in full, and what it shows of each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from bfsim.report.budget.budget import Budget
from bfsim.report.budget.rows import budget_rows, costs_of, elapsed_cclk
from bfsim.report.budget.target import Target, most_used_cclk, used_cclk
from bfsim.report.budget.times import latency_cclk, milliseconds
from bfsim.trace import FrameRecord, RunRecord

MOST = 100
"""The most frames that are shown in full: the worst, the first and the last, and others evenly spaced."""
WORST = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameCell:
    """What a row of the budget took of a frame on one core, and how much more than in the median frame."""

    ms: float
    more_ms: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameRow:
    """A row of the budget in one frame, one cell per core."""

    name: str
    is_part: bool
    cells: tuple[FrameCell, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameFacts:
    """One frame: what each core used of it, its slack against a target, its latency, its rows and what it published."""

    frame: FrameRecord
    used_ms: dict[str, float]
    slack_ms: float | None
    latency_ms: float
    rows: tuple[FrameRow, ...]

    @property
    def most_ms(self) -> float:
        """What the core with the highest use took."""
        return max(self.used_ms.values())


def worst_of(run: RunRecord, count: int = WORST) -> tuple[FrameRecord, ...]:
    """Return the frames that took most time on a core, the worst first."""
    return tuple(sorted(run.frames, key=lambda frame: -most_used_cclk(frame))[:count])


def told_of(run: RunRecord, frames: int, most: int = MOST) -> tuple[FrameRecord, ...]:
    """Return the frames to show in full, in order, for a run that was to have `frames` frames."""
    worst = {each.index for each in worst_of(run)}
    return tuple(
        frame
        for place, frame in enumerate(run.frames)
        if is_spaced(place, frames, most) or frame.index in worst
    )


def is_spaced(place: int, frames: int, most: int = MOST) -> bool:
    """Whether a frame is shown in full even if it is not among the worst: the first, the last, and evenly spaced ones."""
    if frames <= most or place in (0, frames - 1):
        return True
    room = most - WORST - 2
    return place * room // frames > (place - 1) * room // frames


def facts_of(
    run: RunRecord, budget: Budget, frames: tuple[FrameRecord, ...], target: Target | None
) -> Iterator[FrameFacts]:
    """Yield the facts of each of the `frames` of a run."""
    hz = run.identity.cclk_hz
    for frame in frames:
        used_ms = {core.core: milliseconds(used_cclk(core), hz) for core in frame.cores}
        yield FrameFacts(
            frame=frame,
            used_ms=used_ms,
            slack_ms=None if target is None else target.frame_ms - max(used_ms.values()),
            latency_ms=milliseconds(latency_cclk(frame), hz),
            rows=tuple(_rows(run, budget, frame)),
        )


def _rows(run: RunRecord, budget: Budget, frame: FrameRecord) -> Iterator[FrameRow]:
    hz, rows = run.identity.cclk_hz, budget_rows(run)
    for number, row in enumerate(rows):
        cclk = [elapsed_cclk(costs_of(core, row, rows)) for core in frame.cores]
        medians = [core.rows[number].elapsed_cclk.median for core in budget.cores]
        if any(cclk) or any(medians):
            cells = (
                FrameCell(ms=milliseconds(own, hz), more_ms=milliseconds(own - median, hz))
                for own, median in zip(cclk, medians, strict=True)
            )
            yield FrameRow(name=row.stage, is_part=row.within is not None, cells=tuple(cells))
