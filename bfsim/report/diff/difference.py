"""The difference of two runs as plain data: a tree of contributions, each the sum of its parts."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class ContributionKind(StrEnum):
    """What a contribution comes from."""

    STAGE = "stage"
    KERNEL = "kernel"
    OTHER = "no kernel"
    FOLLOWS = "follows"
    LINE = "line"
    CAUSE = "cause"


@dataclass(frozen=True, slots=True, kw_only=True)
class Contribution:
    """Part of a difference, in CCLK cycles of all cores over all compared frames. The `parts`, if any, sum to `cclk`.

    `place` is FILE:LINE of the new run, or of the old one for what is gone. `before_cclk` and `after_cclk` are None for
    a cause, which is only a difference. Waits for the other core or for the cameras are of kind FOLLOWS, with their
    stages as parts: they grow and shrink with the time of the rest of the firmware, which does not include them.
    """

    kind: ContributionKind
    name: str
    place: str
    before_cclk: int | None
    after_cclk: int | None
    cclk: int
    parts: tuple[Contribution, ...] = ()


NOTHING = "-"
"""The value before or after, for what one side does not have."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """Something that differs between the runs: what it is, and its old and new value, in words or NOTHING."""

    what: str
    before: str
    after: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameChange:
    """A frame and the cycles of its slowest core, before and after."""

    index: int
    before_cclk: int
    after_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenChange:
    """Something that only one of the runs saw, in so many `frames`, the first of which is `first`.

    `gone`: seen before but not after.
    """

    name: str
    gone: bool
    frames: int
    first: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """Two runs compared. `frames` are those that both have; cycles are those of these frames.

    A baseline only has the cycles of all its frames together. Compared with one, all frames count, with lines, and the
    cycles of a different number of frames, `measured_frames`, are scaled.

    The `stages` sum to `after_cclk - before_cclk`, the largest contribution first, and waits (FOLLOWS) last. They have
    source lines only if both runs have the same frames (`has_lines`), since lines are counted over a whole run.
    `before_ms` and `after_ms` are times of an average frame, at the core clocks `before_cclk_hz` and `after_cclk_hz`.
    `results` are the firmware's published numbers, summed over the frames.
    """

    configuration: tuple[Change, ...]
    frames: tuple[int, ...]
    measured_frames: int
    has_lines: bool
    before_ms: float
    after_ms: float
    before_cclk_hz: float
    after_cclk_hz: float
    before_cclk: int
    after_cclk: int
    stages: tuple[Contribution, ...]
    changed_frames: tuple[FrameChange, ...]
    results: tuple[Change, ...]
    seen: tuple[SeenChange, ...]

    @property
    def cclk(self) -> int:
        """The increase in cycles."""
        return self.after_cclk - self.before_cclk
