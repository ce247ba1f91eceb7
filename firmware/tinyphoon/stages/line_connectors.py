"""Connectors of line segments: near ones by their ends, far ones by their Muff parameters (T §5.2.2, steps 2 and 3).

Both connect the end of a segment with the start of another that has the same direction. If several fit, they take the
nearest. The last segment of the table fills the place of one that was connected.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u8
from tinyphoon.stages.line_fit import fit_line
from tinyphoon.stages.line_segments import (
    DIRECTION,
    EDGES,
    END_X,
    END_Y,
    NONE,
    SEGMENT_WORDS,
    START_X,
    START_Y,
    SUM_X,
    SUM_XX,
    SUM_XY,
    SUM_Y,
    SUM_YY,
    copy_segment,
    turn_between,
)
from tinyphoon.stores.lines import LINE_AHEAD, LINE_BEHIND, LINE_WORDS


@kernel
def gap_between(segments: i32[:], first: i32, second: i32) -> i32:
    """Return the distance from the end of a segment to the start of another: the longer of its sides, in pixels."""
    dx = segments[second * SEGMENT_WORDS + START_X] - segments[first * SEGMENT_WORDS + END_X]
    dy = segments[second * SEGMENT_WORDS + START_Y] - segments[first * SEGMENT_WORDS + END_Y]
    return max(abs(dx), abs(dy))


@kernel
def is_ahead(segments: i32[:], first: i32, second: i32) -> i32:
    """Return 1 if the end of `second` lies further on in the direction of `first` than the end of that; else 0."""
    a = first * SEGMENT_WORDS
    b = second * SEGMENT_WORDS
    along_x = (segments[a + END_X] - segments[a + START_X]) * (segments[b + END_X] - segments[a + END_X])
    along_y = (segments[a + END_Y] - segments[a + START_Y]) * (segments[b + END_Y] - segments[a + END_Y])
    return 1 if along_x + along_y > 0 else 0


@kernel
def join_segments(segments: i32[:], first: i32, second: i32) -> None:
    """Extend `first` to the end of `second`, with the edges of both and the direction of the one with more."""
    a = first * SEGMENT_WORDS
    b = second * SEGMENT_WORDS
    if segments[b + EDGES] > segments[a + EDGES]:
        segments[a + DIRECTION] = segments[b + DIRECTION]
    segments[a + EDGES] = segments[a + EDGES] + segments[b + EDGES]
    segments[a + SUM_X] = segments[a + SUM_X] + segments[b + SUM_X]
    segments[a + SUM_Y] = segments[a + SUM_Y] + segments[b + SUM_Y]
    segments[a + SUM_XX] = segments[a + SUM_XX] + segments[b + SUM_XX]
    segments[a + SUM_XY] = segments[a + SUM_XY] + segments[b + SUM_XY]
    segments[a + SUM_YY] = segments[a + SUM_YY] + segments[b + SUM_YY]
    segments[a + END_X] = segments[b + END_X]
    segments[a + END_Y] = segments[b + END_Y]


@kernel
def connect_near(segments: i32[:], count: i32, near_gap: i32, angle_range: i32) -> i32:
    """Connect segments whose ends meet within `near_gap` pixels, and return how many of `count` are left."""
    first = 0
    while first < count:
        best = NONE
        best_gap = near_gap
        direction = segments[first * SEGMENT_WORDS + DIRECTION]
        for second in range(count):
            if second != first:
                gap = gap_between(segments, first, second)
                turn = turn_between(segments[second * SEGMENT_WORDS + DIRECTION], direction)
                if gap <= best_gap and abs(turn) <= angle_range and is_ahead(segments, first, second) != 0:
                    best = second
                    best_gap = gap - 1
        if best == NONE:
            first = first + 1
        else:
            join_segments(segments, first, best)
            count = count - 1
            copy_segment(segments, count, best)
            if first == count:
                first = best
    return count


@kernel
def around(position: i32, other: i32, perimeter: i32) -> i32:
    """Return how far apart two positions on the border of a picture are, the shorter way around."""
    apart = abs(position - other)
    return min(apart, perimeter - apart)


@kernel
def connect_far(
    segments: i32[:],
    lines: i16[:],
    count: i32,
    atan: u8[:],
    width: i32,
    height: i32,
    far_gap: i32,
    muff_range: i32,
) -> i32:
    """Connect segments on one line, at most `far_gap` pixels apart, and return how many of `count` are left.

    `lines` are their lines. Two are on one line if both Muff parameters differ by at most `muff_range`; as they go from
    start to end, lines in opposite directions have them exchanged.
    """
    perimeter = 2 * (width + height - 2)
    first = 0
    while first < count:
        best = NONE
        best_gap = far_gap
        behind = lines[first * LINE_WORDS + LINE_BEHIND]
        ahead = lines[first * LINE_WORDS + LINE_AHEAD]
        for second in range(count):
            if second != first:
                off = max(
                    around(behind, lines[second * LINE_WORDS + LINE_BEHIND], perimeter),
                    around(ahead, lines[second * LINE_WORDS + LINE_AHEAD], perimeter),
                )
                if off <= muff_range and is_ahead(segments, first, second) != 0:
                    gap = gap_between(segments, first, second)
                    if gap <= best_gap:
                        best = second
                        best_gap = gap - 1
        if best == NONE:
            first = first + 1
        else:
            join_segments(segments, first, best)
            fit_line(segments, first, lines, first, atan, width, height)
            count = count - 1
            if best != count:
                copy_segment(segments, count, best)
                for word in range(LINE_WORDS):
                    lines[best * LINE_WORDS + word] = lines[count * LINE_WORDS + word]
            if first == count:
                first = best
    return count
