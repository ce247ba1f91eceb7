"""A frame rate that firmware must keep, and how much of its time is left over."""

from __future__ import annotations

import re
from dataclasses import dataclass

from bfsim.errors import ConfigError, shown
from bfsim.report.budget import Spread, milliseconds
from bfsim.trace import CoreFrame, RunRecord

_TARGET = re.compile(r"(\d{1,9}(?:\.\d{1,9})?) ?(Hz|ms)", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Target:
    """The longest time that a frame may take, in ms."""

    frame_ms: float

    def __str__(self) -> str:
        return f"{1000 / self.frame_ms:.6g} Hz, {self.frame_ms:.2f} ms a frame"


def target_of(text: str) -> Target:
    """Return the target that a frame rate, such as 15Hz, or a frame time, such as 66.7ms, stands for.

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
    """Return the cycles of a frame on one core that count against a target: all but those without anything to do.

    Waits for the other core count: a frame is not done before.
    """
    return sum(cost.elapsed_cclk - cost.idle_cclk for cost in frame.stages)


@dataclass(frozen=True, slots=True, kw_only=True)
class CoreSlack:
    """What one core used of a frame in ms: median and maximum, `worst_frame` being the frame of the latter.

    `kept` are the frames within the target: all where there is none.
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
    """Return how many frames of a run kept to a target on all of its cores."""
    hz = run.identity.cclk_hz
    return sum(
        all(milliseconds(used_cclk(core), hz) <= target.frame_ms for core in frame.cores)
        for frame in run.frames
    )
