"""How a number varied from frame to frame.

The median and the 95th percentile are nearest-rank, so each is a number that one frame really had.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bfsim.trace import RunRecord

FRAMES_FOR_P95 = 20
"""The least number of frames for a p95: with fewer, the nearest rank of 95 % is the last, so the p95 is the maximum."""


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


def has_p95(run: RunRecord) -> bool:
    """Whether a run has enough frames for a p95."""
    return len(run.frames) >= FRAMES_FOR_P95
