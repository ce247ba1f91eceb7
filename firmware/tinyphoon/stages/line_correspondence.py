"""Which line of the other picture corresponds to a line of this one (T §5.2.7).

The pictures are rectified, so both show a point in the same row. The plain way of the thesis takes the nearest line
that crosses the row of the line's middle and has nearly its angle. The better way, ours, takes the line whose rows
agree best with its own: a whole line ends in the same rows of both pictures, however far apart.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel
from tinyphoon.stages.line_segments import NONE, turn_between
from tinyphoon.stores.lines import LINE_ANGLE, LINE_WORDS, LINE_X0, LINE_X1, LINE_Y0, LINE_Y1

SLOPE_BITS = 12
LEVEL = -(1 << 31)
"""Replaces the slope of a line that is too nearly level: rows say nothing about it."""

SHARE_BITS = 8
UNLIKE = 1 << SHARE_BITS
"""The disagreement of lines with nothing in common, which is above all others."""


@kernel
def line_slopes(lines: i16[:], count: i32, slopes: i32[:], min_rise: i32) -> None:
    """Find the slope of each line, columns by rows (T Eq. 5.10) in 1 / (1 << SLOPE_BITS), or LEVEL."""
    for line in range(count):
        base = line * LINE_WORDS
        across = lines[base + LINE_X1] - lines[base + LINE_X0]
        down = lines[base + LINE_Y1] - lines[base + LINE_Y0]
        slopes[line] = LEVEL
        if down != 0 and abs(down) << 8 >= abs(across) * min_rise:
            slopes[line] = ((across << SLOPE_BITS + 1) // down + 1) >> 1


@kernel
def column_at(lines: i16[:], line: i32, slopes: i32[:], y: i32) -> i32:
    """Return where a line, or its continuation, crosses row `y`; all in 1/16 px."""
    base = line * LINE_WORDS
    rise = slopes[line] * (y - lines[base + LINE_Y0])
    return lines[base + LINE_X0] + (rise + (1 << SLOPE_BITS - 1) >> SLOPE_BITS)


@kernel
def middle_row(lines: i16[:], line: i32) -> i32:
    """Return y_m of a line (T §5.2.7)."""
    return lines[line * LINE_WORDS + LINE_Y0] + lines[line * LINE_WORDS + LINE_Y1] >> 1


@kernel
def nearest_line(
    lines: i16[:], line: i32, others: i16[:], other_slopes: i32[:], count: i32, angle_range: i32
) -> i32:
    """Return the nearest of `count` other lines with ends above and below the middle of a line, or NONE."""
    row = middle_row(lines, line)
    column = lines[line * LINE_WORDS + LINE_X0] + lines[line * LINE_WORDS + LINE_X1] >> 1
    angle = lines[line * LINE_WORDS + LINE_ANGLE]
    best = NONE
    nearest: i32 = 1 << 30
    for other in range(count):
        base = other * LINE_WORDS
        top = min(others[base + LINE_Y0], others[base + LINE_Y1])
        bottom = max(others[base + LINE_Y0], others[base + LINE_Y1])
        turn = abs(turn_between(others[base + LINE_ANGLE], angle))
        if other_slopes[other] != LEVEL and top < row < bottom and turn <= angle_range:
            apart = abs(column_at(others, other, other_slopes, row) - column)
            if apart < nearest:
                best = other
                nearest = apart
    return best


@kernel
def disagreement(lines: i16[:], line: i32, others: i16[:], other: i32) -> i32:
    """Return the share of rows that only one of two lines has, among those that either has: 0..UNLIKE."""
    a = line * LINE_WORDS
    b = other * LINE_WORDS
    top_a = min(lines[a + LINE_Y0], lines[a + LINE_Y1])
    top_b = min(others[b + LINE_Y0], others[b + LINE_Y1])
    bottom_a = max(lines[a + LINE_Y0], lines[a + LINE_Y1])
    bottom_b = max(others[b + LINE_Y0], others[b + LINE_Y1])
    common = min(bottom_a, bottom_b) - max(top_a, top_b)
    if common <= 0:
        return UNLIKE
    either = max(bottom_a, bottom_b) - min(top_a, top_b)
    return (either - common << SHARE_BITS) // either


@kernel
def best_line(
    lines: i16[:],
    line: i32,
    slopes: i32[:],
    others: i16[:],
    other_slopes: i32[:],
    count: i32,
    side: i32,
    angle_range: i32,
    min_disparity: i32,
    max_disparity: i32,
    min_common: i32,
) -> i32:
    """Return the one of `count` other lines that agrees best with a line, or NONE.

    `side` is 1 for a line of the left picture and others of the right one, -1 for the reverse. The disparity counts in
    the middle of the line; among lines that agree equally well, the angle decides.
    """
    row = middle_row(lines, line)
    column = column_at(lines, line, slopes, row)
    angle = lines[line * LINE_WORDS + LINE_ANGLE]
    best = NONE
    least = (UNLIKE - min_common << 8) + angle_range
    for other in range(count):
        if other_slopes[other] != LEVEL:
            turn = abs(turn_between(others[other * LINE_WORDS + LINE_ANGLE], angle))
            disparity = side * (column - column_at(others, other, other_slopes, row))
            if turn <= angle_range and min_disparity <= disparity <= max_disparity:
                off = (disagreement(lines, line, others, other) << 8) + turn
                if off <= least:
                    best = other
                    least = off - 1
    return best
