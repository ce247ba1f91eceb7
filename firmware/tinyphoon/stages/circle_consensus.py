"""The circle that most of a ball's edges agree on [ours]: a fixed number of circles through three, and the votes' own.

The votes rely on gradients, which shade bends: where light falls off along a ball, its edges look past its centre, and
the border between light and shade has edges of its own. The places of the edges are reliable. So circles are drawn
through three edges at a time, far apart in row order, and the one with most edges near it is taken (Fischler and
Bolles' random sample consensus, with samples that are the same every time).

If some edges look at the ball and others away from it, the circle through all tells whether they belong to one ball,
partly brighter and partly darker than the floor: then both kinds lie on it.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u32
from tinyphoon.arithmetic import isqrt32
from tinyphoon.stages.circle_edges import FINE, MASS_X, MASS_Y, REACH, edge_x, edge_y, looks_away
from tinyphoon.stages.circle_fit import CENTRE_X, CENTRE_Y, RADIUS, near_of

# If 4 of 10 edges lie on the outline, one of 16 triples does: 48 miss it once in twenty times, or in 600 if half do.
TRIPLES = 48
MOST_JUDGES = 64  # the most edges, evenly chosen, that say how many agree


@kernel
def is_near(edge: u32, x: i32, y: i32, radius: i32) -> i32:
    """Return 1 if an edge is near a circle in 1/64 px; else 0."""
    near = near_of(radius)
    inner = u32(max(radius - near, 0))
    outer = u32(radius + near)
    dx = FINE * edge_x(edge) - x
    dy = FINE * edge_y(edge) - y
    square = u32(dx * dx) + u32(dy * dy)
    return 1 if inner * inner <= square <= outer * outer else 0


@kernel
def agreeing(selected: u32[:], count: i32, x: i32, y: i32, radius: i32) -> i32:
    """Return how many of the judges, in 256ths, are near a circle in 1/64 px."""
    stride = (count + MOST_JUDGES - 1) // MOST_JUDGES
    found = 0
    judges = 0
    number = 0
    while number < count:
        found = found + is_near(selected[number], x, y, radius)
        judges = judges + 1
        number = number + stride
    return (found << 8) // judges


@kernel
def in_fine(number: i32, divisor: i32) -> i32:
    """Return a quotient in 1/64; the divisor is positive."""
    whole = number // divisor
    return FINE * whole + FINE * (number - whole * divisor) // divisor


@kernel
def try_triple(
    selected: u32[:], count: i32, first: i32, second: i32, third: i32, area: i32[:], fit: i32[:], best: i32
) -> i32:
    """Take the circle through three edges if more than `best` agree and its centre is in the patch; return the most."""
    x = edge_x(selected[first])
    y = edge_y(selected[first])
    x2 = edge_x(selected[second]) - x
    y2 = edge_y(selected[second]) - y
    x3 = edge_x(selected[third]) - x
    y3 = edge_y(selected[third]) - y
    twice = 2 * (x2 * y3 - y2 * x3)
    if twice == 0:
        return best
    square2 = x2 * x2 + y2 * y2
    square3 = x3 * x3 + y3 * y3
    right = y3 * square2 - y2 * square3
    down = x2 * square3 - x3 * square2
    if twice < 0:
        twice = -twice
        right = -right
        down = -down
    # first in whole pixels: distant centres do not fit in 1/64
    if (
        abs(x + right // twice - area[MASS_X]) > area[REACH]
        or abs(y + down // twice - area[MASS_Y]) > area[REACH]
    ):
        return best
    dx = in_fine(right, twice)
    dy = in_fine(down, twice)
    radius = i32(isqrt32(u32(dx * dx) + u32(dy * dy)))
    agree = agreeing(selected, count, FINE * x + dx, FINE * y + dy, radius)
    if agree <= best:
        return best
    fit[CENTRE_X] = FINE * x + dx
    fit[CENTRE_Y] = FINE * y + dy
    fit[RADIUS] = radius
    return agree


@kernel
def find_consensus(selected: u32[:], count: i32, area: i32[:], fit: i32[:]) -> i32:
    """Move centre and radius to the circle that most edges agree on, if it has more than the present one.

    Returns how many agree, in 256ths. A radius of 0 is no circle.
    """
    best: i32 = 0
    if fit[RADIUS] > 0:
        best = agreeing(selected, count, fit[CENTRE_X], fit[CENTRE_Y], fit[RADIUS])
    for number in range(TRIPLES):
        first = number * count // TRIPLES
        second = (first + count // 3 + number) % count
        third = (first + 2 * count // 3 + 3 * number) % count
        best = try_triple(selected, count, first, second, third, area, fit, best)
    return best


@kernel
def agree_on_side(selected: u32[:], count: i32, area: i32[:], fit: i32[:]) -> i32:
    """Leave out edges that do not look the way most do, at the ball or away from it; return how many are left.

    They belong to something beside it; but if three quarters of them are near the circle of all, they stay.
    """
    away = 0
    for number in range(count):
        away = away + looks_away(selected[number])
    side = 1 if 2 * away > count else 0
    fewer = min(away, count - away)
    if fewer == 0:
        return count
    fit[RADIUS] = 0
    find_consensus(selected, count, area, fit)
    agree = 0
    for number in range(count):
        edge = selected[number]
        if looks_away(edge) != side:
            agree = agree + is_near(edge, fit[CENTRE_X], fit[CENTRE_Y], fit[RADIUS])
    if fit[RADIUS] > 0 and 4 * agree >= 3 * fewer:
        return count
    left = 0
    for number in range(count):
        edge = selected[number]
        if looks_away(edge) == side:
            selected[left] = edge
            left = left + 1
    return left
