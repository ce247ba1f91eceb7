"""Lines beside OpenCV's line segment detector (LSD), on the same pictures.

A line has a partner if lines of the other kind cover half of it, within 2 pixels and 5 degrees. Directions are
told apart only modulo half a turn.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.quality.seen import Lines, Seen
from benchmarks.table_6_1 import lsd_lines
from bfsim.chip.boards import CM_BF561
from bfsim.report.tables.table import percent

NEAR_PX = 2.0
NEAR_DEGREES = 5.0
LONG_PX = (20.0, 40.0)
"""From these lengths on a line of LSD is long, each limit a column of its own."""

TITLE = "Lines beside OpenCV's line segment detector (LSD)"
COLUMNS = (
    *(name for limit in LONG_PX for name in (f"LSD {limit:.0f} px+", "found %")),
    *("ours", "px", "alone %", "ms"),
)
NOTE = (
    "Found: LSD's lines of that length and more with a partner of ours, within 2 px and 5 degrees; alone: length of ours "
    "without one of LSD's; ms: median of the line detection."
)


def lengths(lines: Lines) -> NDArray[np.float64]:
    """Return the lengths of lines in pixels."""
    return np.hypot(lines[:, 2] - lines[:, 0], lines[:, 3] - lines[:, 1])


def has_partner(lines: Lines, others: Lines) -> NDArray[np.bool_]:
    """Say of each line whether `others` cover half of it: points a pixel apart are asked one by one."""
    turns = np.arctan2(others[:, 3] - others[:, 1], others[:, 2] - others[:, 0])
    steps = np.maximum(lengths(others), 1e-9)
    along = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    covered = np.zeros(len(lines), bool)
    for number, (line, length) in enumerate(zip(lines, lengths(lines), strict=True)):
        turn = np.arctan2(line[3] - line[1], line[2] - line[0]) - turns
        parallel = abs(np.sin(turn)) <= np.sin(np.radians(NEAR_DEGREES))
        points = np.linspace(line[:2], line[2:], max(round(length), 2))
        off = points[:, None] - others[None, parallel, :2]
        foot = np.clip((off * along[parallel]).sum(axis=2), 0, steps[parallel])
        distance = np.linalg.norm(off - foot[:, :, None] * along[parallel], axis=2)
        covered[number] = (distance <= NEAR_PX).any(axis=1).mean() >= 0.5
    return covered


def cells(seen: Sequence[Seen]) -> Sequence[str]:
    """Return the numbers of a recording."""
    pairs = [(each.lines, lsd_lines(each.luma)) for each in seen]
    found = np.concatenate([has_partner(lsd, own) for own, lsd in pairs])
    partner = np.concatenate([has_partner(own, lsd) for own, lsd in pairs])
    own_px, lsd_px = (np.concatenate([lengths(each) for each in side]) for side in zip(*pairs, strict=True))
    long = [found[lsd_px >= limit] for limit in LONG_PX]
    cclk = np.median([each.stages_cclk["Line detection"] for each in seen])
    return [
        *(cell for each in long for cell in (f"{len(each):,}", percent(each.sum(), len(each)))),
        f"{len(own_px):,}",
        f"{own_px.sum():,.0f}",
        percent(own_px[~partner].sum(), own_px.sum()),
        f"{1000 * cclk / CM_BF561.clocks.cclk_hz:.2f}",
    ]
