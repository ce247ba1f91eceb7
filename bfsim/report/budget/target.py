"""A frame rate that firmware must keep, and how much of its time is left."""

from __future__ import annotations

import re
from dataclasses import dataclass

from bfsim.errors import ConfigError, shown
from bfsim.report.budget.rows import budget_rows, costs_of
from bfsim.report.budget.spread import Spread
from bfsim.report.budget.times import milliseconds
from bfsim.report.budget.waits import busy_cclk, other_core_cclk
from bfsim.trace import CoreFrame, FrameRecord, RunRecord

STAGES_TOLD = 3
WAIT = "waits for the other core"
_TARGET = re.compile(r"(\d{1,9}(?:\.\d{1,9})?) ?(Hz|ms)", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Target:
    """A limit on the time of a frame, in ms."""

    frame_ms: float

    def __str__(self) -> str:
        return f"{1000 / self.frame_ms:.6g} Hz, {self.frame_ms:.2f} ms a frame"


def target_of(text: str) -> Target:
    """Return the target for a frame rate, such as 15Hz, or a frame time, such as 66.7ms.

    Raises ConfigError for anything else.
    """
    found = _TARGET.fullmatch(text.strip())
    number = float(found[1]) if found else 0.0
    if not found or not number:
        raise ConfigError(
            f"must be a frame rate such as 15Hz or a frame time such as 66ms, not {shown(text)}"
        )
    return Target(1000 / number if found[2].lower() == "hz" else number)


def used_cclk(frame: CoreFrame) -> int:
    """Return the cycles of a frame on one core that count against a target: all but those with nothing to do.

    Waits for the other core count: the frame is not done before they end.
    """
    return sum(cost.elapsed_cclk - cost.idle_cclk for cost in frame.stages)


def most_used_cclk(frame: FrameRecord) -> int:
    """Return the cycles of the core that used most of a frame."""
    return max(used_cclk(core) for core in frame.cores)


@dataclass(frozen=True, slots=True, kw_only=True)
class CoreSlack:
    """What one core used of a frame in ms: median and maximum, which is that of `worst_frame`.

    `kept` counts the frames within the target; without one, all.
    """

    core: str
    used_ms: float
    most_ms: float
    worst_frame: int
    kept: int


def slacks_of(run: RunRecord, target: Target | None) -> tuple[CoreSlack, ...]:
    """Compare each core of a run of at least one frame with a target."""
    return tuple(_slack(run, number, target) for number in range(len(run.frames[0].cores)))


def _slack(run: RunRecord, number: int, target: Target | None) -> CoreSlack:
    hz = run.identity.cclk_hz
    used = [used_cclk(frame.cores[number]) for frame in run.frames]
    spread = Spread.of(used)
    return CoreSlack(
        core=run.frames[0].cores[number].core,
        used_ms=milliseconds(spread.median, hz),
        most_ms=milliseconds(spread.maximum, hz),
        worst_frame=run.frames[used.index(spread.maximum)].index,
        kept=sum(target is None or milliseconds(cclk, hz) <= target.frame_ms for cclk in used),
    )


def kept_frames(run: RunRecord, target: Target) -> int:
    """Return how many frames of a run kept a target on all cores."""
    hz = run.identity.cclk_hz
    return sum(milliseconds(most_used_cclk(frame), hz) <= target.frame_ms for frame in run.frames)


def target_words(run: RunRecord, target: Target) -> str:
    """Say how a run keeps a target, and what its worst frame has left or must save, and where.

    The run has at least one frame.
    """
    hz, frames = run.identity.cclk_hz, len(run.frames)
    worst = max(run.frames, key=most_used_cclk)
    core = _own_core(worst)
    slack_ms = target.frame_ms - milliseconds(most_used_cclk(worst), hz)
    kept = f"{target}: kept by {kept_frames(run, target):,} of {frames:,} frame{'s' if frames > 1 else ''}"
    if slack_ms >= 0:
        return f"{kept}; the worst, frame {worst.index}, has {slack_ms:.2f} ms left."
    told = ", ".join(f"{name} {ms:.2f}" for name, ms in _dearest(run, core))
    return f"{kept}; the worst, frame {worst.index}, must save {-slack_ms:.2f} ms. Most of it, on core {core.core}: {told}."


def _own_core(frame: FrameRecord) -> CoreFrame:
    """Return the core that used most of a frame for its own work: the other one waited for it."""
    return max(frame.cores, key=lambda core: busy_cclk(core.stages))


def _dearest(run: RunRecord, core: CoreFrame) -> list[tuple[str, float]]:
    """Return what took a core longest in a frame, in ms: stages without waits for the other core, and those waits."""
    rows = budget_rows(run)
    parts = {WAIT: other_core_cclk(*core.stages)}
    for row in rows:
        if row.within is None:
            parts[row.stage] = busy_cclk(costs_of(core, row, rows))
    dearest = sorted(parts.items(), key=lambda each: -each[1])[:STAGES_TOLD]
    return [(name, milliseconds(cclk, run.identity.cclk_hz)) for name, cclk in dearest if cclk]
