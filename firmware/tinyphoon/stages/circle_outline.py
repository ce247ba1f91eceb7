"""The outline of a ball finer than a pixel [ours]: where the luma steps, beside the edges near the circle.

The smoothing before the edge detection moves an edge by more than half a pixel where the ball's luma falls off towards
it. So each edge is looked up again in the camera's lines, along the axis that is nearer to its gradient. The greatest step
of luma from pixel to pixel and the two steps beside it say where the outline is; before that, the slope that the luma has
on either side is taken off all three.

The luma of the latest LUMA_LINES lines lies in one array, line y in place y modulo LUMA_LINES. A point is one word, x
in the low half and y in the high one, in 1/64 px.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u32
from tinyphoon.stages.circle_edges import FINE, LEFT, RIGHT, edge_x, edge_y
from tinyphoon.stages.circle_fit import NEXT_EDGE, RADIUS, REFINED, distance
from tinyphoon.stages.line_segments import is_flat

LUMA_LINES = 16
REACH_LINES = 4  # of a profile to each side


@kernel
def clear_points(fit: i32[:]) -> None:
    """Begin with the first edge, and no point yet."""
    fit[NEXT_EDGE] = 0
    fit[REFINED] = 0


@kernel
def luma_row(uyvy: u8[:], luma: u8[:], y: i32, area: i32[:]) -> None:
    """Take the luma of line `y` as far as profiles reach round the area."""
    width = len(luma) // LUMA_LINES
    at = y % LUMA_LINES * width
    for x in range(max(area[LEFT] - REACH_LINES, 0), min(area[RIGHT] + REACH_LINES, width - 1) + 1):
        luma[at + x] = uyvy[2 * x + 1]


@kernel
def profile_pixel(luma: u8[:], x: i32, y: i32, step: i32, flat: i32, height: i32) -> i32:
    """Return the luma `step` pixels from (x, y): downwards if `flat`, else to the right. The border pixels repeat."""
    width = len(luma) // LUMA_LINES
    if flat != 0:
        y = min(max(y + step, 0), height - 1)
    else:
        x = min(max(x + step, 0), width - 1)
    return luma[y % LUMA_LINES * width + x]


@kernel
def step_at(luma: u8[:], x: i32, y: i32, at: i32, way: i32, flat: i32, height: i32) -> i32:
    """Return by how much the luma rises from place `at` of a profile to the next; `way` is 1 or -1."""
    here = profile_pixel(luma, x, y, way * at, flat, height)
    return profile_pixel(luma, x, y, way * (at + 1), flat, height) - here


@kernel
def outline_offset(luma: u8[:], x: i32, y: i32, way: i32, flat: i32, height: i32) -> i32:
    """Return how far towards the bright side of an edge the luma steps, in 1/64 px."""
    best = -2
    middle = step_at(luma, x, y, best, way, flat, height)
    for at in range(-1, 2):
        rise = step_at(luma, x, y, at, way, flat, height)
        if rise > middle:
            middle = rise
            best = at
    dark_slope = max(step_at(luma, x, y, best - 2, way, flat, height), 0)
    bright_slope = max(step_at(luma, x, y, best + 2, way, flat, height), 0)
    before = max(step_at(luma, x, y, best - 1, way, flat, height) - dark_slope, 0)
    after = max(step_at(luma, x, y, best + 1, way, flat, height) - bright_slope, 0)
    whole = before + after + max(middle - (dark_slope + bright_slope >> 1), 0)
    offset = FINE * best + FINE // 2
    if whole > 0:
        offset = offset + (2 * FINE * (after - before) + whole) // (2 * whole)
    return offset


@kernel
def refine_row(
    selected: u32[:], count: i32, y: i32, luma: u8[:], height: i32, fit: i32[:], fit_range: i32
) -> None:
    """Make points of the selected edges of row `y` that are not further than `fit_range` pixels from the circle.

    The points take the place of edges that came before, from the first on.
    """
    number = fit[NEXT_EDGE]
    while number < count and edge_y(selected[number]) == y:
        edge = selected[number]
        direction = i32(edge & 255)
        x = FINE * edge_x(edge)
        if abs(distance(x, FINE * y, fit) - fit[RADIUS]) <= FINE * fit_range:
            flat = is_flat(direction)
            # on a flat line the gradient looks down or up, else to the right or to the left
            way = 1 if direction - 64 * flat + 64 & 128 == 0 else -1
            offset = way * outline_offset(luma, edge_x(edge), y, way, flat, height)
            across = max(offset * (1 - flat) + x, 0)
            down = max(offset * flat + FINE * y, 0)
            selected[fit[REFINED]] = u32(across | down << 16)
            fit[REFINED] = fit[REFINED] + 1
        number = number + 1
    fit[NEXT_EDGE] = number
