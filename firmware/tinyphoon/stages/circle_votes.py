"""The centre of a circle: a Hough transform in a small patch around a blob's centre of mass (T §2.2.2, §5.2.4).

Each edge adds one to the cells on the line along its gradient, one cell for each column or, for steep lines, for each
row. A peak is the square of cells with the most votes: with a reach of 0 a single cell, as in the thesis; with 1 three
by three, where lines that miss each other by a pixel still meet.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u16, u32
from tinyphoon.stages.circle_edges import FINE, MASS_X, MASS_Y, REACH, edge_x, edge_y
from tinyphoon.stages.line_segments import is_flat
from tinyphoon.tables import TANGENT_BITS

HALF_CELL = 1 << TANGENT_BITS - 1


@kernel
def clear_votes(votes: u16[:], area: i32[:]) -> None:
    """Empty the patch: 2 REACH + 1 rows and columns."""
    side = 2 * area[REACH] + 1
    for cell in range(side * side):
        votes[cell] = 0


@kernel
def gradient_slope(direction: i32, tangents: u16[:]) -> i32:
    """Return the slope of the line along a gradient against the nearer axis: y over x or, if steep, x over y."""
    turn = (direction + 32 & 63) - 32
    if is_flat(direction) != 0:
        turn = -turn
    return tangents[turn] if turn >= 0 else -tangents[-turn]


@kernel
def draw_lines(selected: u32[:], count: i32, votes: u16[:], area: i32[:], tangents: u16[:]) -> None:
    """Add the lines of `count` edges to the patch."""
    side = 2 * area[REACH] + 1
    left = area[MASS_X] - area[REACH]
    top = area[MASS_Y] - area[REACH]
    for number in range(count):
        edge = selected[number]
        direction = i32(edge & 255)
        slope = gradient_slope(direction, tangents)
        x = edge_x(edge) - left
        y = edge_y(edge) - top
        # both ways begin where the line meets the first column or row of the patch
        if is_flat(direction) == 0:
            across = (y << TANGENT_BITS) - slope * x + HALF_CELL
            step = 1
            stride = side
        else:
            across = (x << TANGENT_BITS) - slope * y + HALF_CELL
            step = side
            stride = 1
        at = 0
        for _ in range(side):
            cell = across >> TANGENT_BITS
            if 0 <= cell < side:
                place = at + cell * stride
                votes[place] = votes[place] + 1
            across = across + slope
            at = at + step


@kernel
def votes_round(votes: u16[:], side: i32, at: i32, peak_reach: i32) -> i32:
    """Return the sum of the votes in the square around cell `at`."""
    total = 0
    for row in range(-peak_reach, peak_reach + 1):
        for column in range(-peak_reach, peak_reach + 1):
            total = total + votes[at + row * side + column]
    return total


@kernel
def find_peak(votes: u16[:], reach: i32, peak_reach: i32) -> i32:
    """Return the middle cell of the square with the most votes; of equal ones the first."""
    side = 2 * reach + 1
    best = 0
    peak = reach * side + reach
    for row in range(peak_reach, side - peak_reach):
        for column in range(peak_reach, side - peak_reach):
            total = votes_round(votes, side, row * side + column, peak_reach)
            if total > best:
                best = total
                peak = row * side + column
    return peak


@kernel
def mean_offset(votes: u16[:], at: i32, along: i32, across: i32, peak_reach: i32) -> i32:
    """Return the mean offset of the votes in the square around cell `at`, along one axis, in 1/64 px.

    `along` and `across` are the strides of this axis and of the other.
    """
    total = 0
    moment = 0
    for step in range(-peak_reach, peak_reach + 1):
        for aside in range(-peak_reach, peak_reach + 1):
            each = votes[at + step * along + aside * across]
            total = total + each
            moment = moment + step * each
    return (2 * FINE * moment + total) // (2 * total)
