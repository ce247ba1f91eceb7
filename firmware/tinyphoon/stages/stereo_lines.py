"""3-D lines: lines of the left picture with a corresponding line in the right one, and their depth (T §5.2.7).

The disparity at both ends of the left line is measured to the other line's straight continuation, as lines may be cut
into different segments (T Eq. 5.10 to 5.12; 5.12 as printed takes x and y of different ends). `line_votes.py` decides
which lines to believe.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from bfsim.api import Buffer, Core, Frame, Row, i16, i32, kernel, u32
from tinyphoon.exchange import as_words, copy_words, shared_count
from tinyphoon.fields import allowed
from tinyphoon.geometry import FARTHEST_MM, disparity_at, store_point
from tinyphoon.stages.line_correspondence import LEVEL, best_line, column_at, line_slopes, nearest_line
from tinyphoon.stages.line_pixels import line_pixels
from tinyphoon.stages.line_segments import NONE, SEGMENT_CAPACITY
from tinyphoon.stages.line_votes import LineVote
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_X1, LINE_Y0, LINE_Y1
from tinyphoon.stores.lines3d import LINE3D_LEFT, LINE3D_RIGHT, LINE3D_WORDS, LINE3D_X0, LINE3D_X1


class Correspondence(IntEnum):
    """How the corresponding line is chosen."""

    NEAREST = 0  # T §5.2.7
    MUTUAL = 1  # [ours]


@dataclass(frozen=True, slots=True, kw_only=True)
class StereoLineThresholds:
    """What makes two lines correspond.

    `correspondence`: how the line is chosen. `angle_range`: how far its angle may differ, in 1/256 of a turn.
    `min_rise`: rows by columns, in 1/256, from which a line is not nearly horizontal, 16 or more. Only for MUTUAL:
    `nearest_mm` and `farthest_mm`, the depths between which lines are wanted, and `min_common`, the rows that both lines
    have by the rows that either has, in 1/256. `edge_range`: how far a 3-D edge that votes on a line may be from it, and its
    disparity from the line's to be for it, in 1/16 px; 0 for no vote.
    """

    correspondence: Correspondence
    angle_range: int = allowed(0, 64)
    min_rise: int = allowed(16, 4096)
    nearest_mm: int = allowed(1, FARTHEST_MM, at_most="farthest_mm")
    farthest_mm: int = allowed(1, FARTHEST_MM)
    min_common: int = allowed(0, 256)
    edge_range: int = allowed(0, 256)

    def __post_init__(self) -> None:
        if self.min_rise < 16:  # a slope of 16 over 2048 rows still fits in 32 bits
            raise ValueError(f"min_rise must be 16 or more, not {self.min_rise}")
        check_depths(self.nearest_mm, self.farthest_mm)


def check_depths(nearest_mm: int, farthest_mm: int) -> None:
    """Raise ValueError unless these can be the least and the greatest wanted depth."""
    if not 1 <= nearest_mm <= farthest_mm:
        raise ValueError(f"depths must be 1 mm or more and rise, not {nearest_mm} to {farthest_mm}")


def stereo_line_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage on core A, in L1 if there is room."""
    return (Buffer("lines_3d", i16, LINE3D_WORDS * SEGMENT_CAPACITY, "data1"),)


@kernel
def store_line3d(
    geometry: i32[:],
    lines: i16[:],
    line: i32,
    others: i16[:],
    other: i32,
    other_slopes: i32[:],
    width: i32,
    height: i32,
    lines_3d: i16[:],
    number: i32,
) -> i32:
    """Store 3-D line `number` of a line and the corresponding one; return how many there are then.

    It is not stored if one of its ends has no depth: the disparity must be above 0 (T Eq. 5.11, 5.12).
    """
    a = line * LINE_WORDS
    base = number * LINE3D_WORDS
    x0 = lines[a + LINE_X0]
    y0 = lines[a + LINE_Y0]
    x1 = lines[a + LINE_X1]
    y1 = lines[a + LINE_Y1]
    d0 = x0 - column_at(others, other, other_slopes, y0)
    d1 = x1 - column_at(others, other, other_slopes, y1)
    stored = store_point(geometry, x0, y0, d0, width, height, lines_3d, base + LINE3D_X0)
    if stored != 0:
        stored = store_point(geometry, x1, y1, d1, width, height, lines_3d, base + LINE3D_X1)
    lines_3d[base + LINE3D_LEFT] = line
    lines_3d[base + LINE3D_RIGHT] = other
    return number + stored


@kernel
def nearest_lines(
    geometry: i32[:],
    lines: i16[:],
    slopes: i32[:],
    count: i32,
    others: i16[:],
    other_slopes: i32[:],
    other_count: i32,
    angle_range: i32,
    width: i32,
    height: i32,
    lines_3d: i16[:],
) -> i32:
    """Make 3-D lines of `count` left lines and the nearest right ones, and return how many there are."""
    number = 0
    for line in range(count):
        if slopes[line] != LEVEL:
            other = nearest_line(lines, line, others, other_slopes, other_count, angle_range)
            if other != NONE:
                number = store_line3d(
                    geometry, lines, line, others, other, other_slopes, width, height, lines_3d, number
                )
    return number


@kernel
def mutual_lines(
    geometry: i32[:],
    lines: i16[:],
    slopes: i32[:],
    count: i32,
    others: i16[:],
    other_slopes: i32[:],
    other_count: i32,
    angle_range: i32,
    min_disparity: i32,
    max_disparity: i32,
    min_common: i32,
    width: i32,
    height: i32,
    lines_3d: i16[:],
) -> i32:
    """Make 3-D lines of left and right lines that are each other's best, and return how many there are."""
    number = 0
    for line in range(count):
        other = NONE
        back = NONE
        if slopes[line] != LEVEL:
            other = best_line(
                lines, line, slopes, others, other_slopes, other_count, 1,
                angle_range, min_disparity, max_disparity, min_common,
            )  # fmt: skip
        if other != NONE:
            back = best_line(
                others, other, other_slopes, lines, slopes, count, -1,
                angle_range, min_disparity, max_disparity, min_common,
            )  # fmt: skip
        if other != NONE and back == line:
            number = store_line3d(
                geometry, lines, line, others, other, other_slopes, width, height, lines_3d, number
            )
    return number


@dataclass(frozen=True, slots=True)
class _Workspace:
    """The L1 memory of the stage and the vote; it shares the segments, which the line detection no longer needs."""

    left_slopes: Row
    right_slopes: Row
    votes: Row
    right_words: Row
    right_lines: Row

    @classmethod
    def of(cls, core: Core) -> _Workspace:
        slopes = core.overlay("segments", i32, SEGMENT_CAPACITY)
        words = LINE_WORDS * SEGMENT_CAPACITY
        # the second row of the lines begins after the third row of slopes
        return cls(
            *slopes[:3], core.overlay("segments", u32, words // 2)[1], core.overlay("segments", i16, words)[1]
        )


def stereo_lines(
    core: Core, frame: Frame, left_count: int, thresholds: StereoLineThresholds
) -> Generator[Any, Any, LineVote]:
    """Find the 3-D lines of `left_count` lines and those of core B, in `lines_3d`. Return the vote on them.

    Core B must have posted that its lines are there. The vote needs the memory of the segments until it is closed.
    """
    work, lines, geometry = _Workspace.of(core), core.array("lines"), core.array("geometry")
    right_count = yield from shared_count(core, "right_line_count")
    words = (right_count * LINE_WORDS + 1) // 2
    yield core.run(copy_words, as_words(core, "right_lines"), work.right_words, words)
    core.at(line_pixels(lines, left_count))
    yield core.run(line_slopes, lines, left_count, work.left_slopes, thresholds.min_rise)
    yield core.run(line_slopes, work.right_lines, right_count, work.right_slopes, thresholds.min_rise)
    pictures = lines, work.left_slopes, left_count, work.right_lines, work.right_slopes, right_count
    rest = frame.width, frame.height, core.array("lines_3d")
    find, limits = nearest_lines, (thresholds.angle_range,)
    if thresholds.correspondence is Correspondence.MUTUAL:
        least: int = yield core.run(disparity_at, geometry, thresholds.farthest_mm)
        most: int = yield core.run(disparity_at, geometry, thresholds.nearest_mm)
        find, limits = mutual_lines, (*limits, least, most, thresholds.min_common)
    found: int = yield core.run(find, geometry, *pictures, *limits, *rest)
    left, right = (lines, work.left_slopes), (work.right_lines, work.right_slopes)
    core.at()
    vote = LineVote(core, found, left, right, work.votes, thresholds.edge_range)
    yield from vote.open()
    return vote
