"""The outline of a ball finer than a pixel [ours]: the steps of the luma beside the edges near the circle.

The smoothing before the edge detection moves an edge by more than half a pixel where the ball's luma falls off towards
it. So each edge is looked up again in the camera's lines, along the axis that is nearer to its gradient. The greatest
rise of luma from pixel to pixel and its flanks, the rises beside it, tell where the outline is: at their centre, after
subtracting the slope of the luma on either side. A blurred outline has wider flanks, which all count. Its width is
summed up for the fit.

The luma of the latest LUMA_LINES lines lies in one array, line y in place y modulo LUMA_LINES. A point is one word, x
in the low half and y in the high one, in 1/64 px.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u16, u32
from tinyphoon.stages.circle_edges import FINE, LEFT, RIGHT, edge_x, edge_y
from tinyphoon.stages.circle_fit import NEXT_EDGE, RADIUS, REFINED, RISE_SUM, SQUARE_SUM, distance
from tinyphoon.stages.line_segments import is_flat

LUMA_LINES = 16
REACH_LINES = 8  # of a profile, behind its edge; one less before it
BEFORE = REACH_LINES - 1

# The rises of a profile: from pixel BEFORE before the edge to the next one, and so on.
RISES = 2 * REACH_LINES - 1
FIRST_PLACE = BEFORE - 2  # where to look for the greatest: two pixels on each side of the edge
LAST_PLACE = BEFORE + 1
MOST_BESIDE = 4


@kernel
def clear_points(fit: i32[:]) -> None:
    """Begin with the first edge, and no points."""
    fit[NEXT_EDGE] = 0
    fit[REFINED] = 0
    fit[RISE_SUM] = 0
    fit[SQUARE_SUM] = 0


@kernel
def luma_row(uyvy: u8[:], luma: u8[:], y: i32, area: i32[:]) -> None:
    """Take the luma of line `y` as far as profiles reach around the area."""
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
def fill_rises(luma: u8[:], x: i32, y: i32, way: i32, flat: i32, height: i32, rises: i32[:]) -> None:
    """Take the rises of luma from pixel to pixel along the profile through (x, y); `way` is 1 or -1."""
    here = profile_pixel(luma, x, y, -way * BEFORE, flat, height)
    for place in range(RISES):
        ahead = profile_pixel(luma, x, y, way * (place + 1 - BEFORE), flat, height)
        rises[place] = ahead - here
        here = ahead


@kernel
def steepest(rises: i32[:]) -> i32:
    """Return the place of the greatest rise near the edge, counting half of each neighbour; of equal ones the first."""
    best = FIRST_PLACE
    most = rises[best - 1] + 2 * rises[best] + rises[best + 1]
    for place in range(FIRST_PLACE + 1, LAST_PLACE + 1):
        rise = rises[place - 1] + 2 * rises[place] + rises[place + 1]
        if rise > most:
            most = rise
            best = place
    return best


@kernel
def flank(rises: i32[:], at: i32, way: i32) -> i32:
    """Return how many rises beside the one at a place belong to its outline: those above half of it, and the next one.

    `way` is 1 or -1; MOST_BESIDE at most.
    """
    beside = 1
    while beside < MOST_BESIDE and 2 * rises[at + way * beside] > rises[at]:
        beside = beside + 1
    return beside


@kernel
def outline_offset(rises: i32[:], at: i32, before: i32, after: i32, fit: i32[:]) -> i32:
    """Return how far towards the bright side of an edge the luma steps, in 1/64 px, and sum up the width of the step.

    This is the centre of the rise at place `at`, `before` rises before it and `after` behind. A curved outline has a rise
    that is larger on one side and smaller on the other, the more the further off, slopes included: each adds this to the sum.
    """
    dark_slope = max(rises[at - before - 1], 0)
    bright_slope = max(rises[at + after + 1], 0)
    whole = max(rises[at] - (dark_slope + bright_slope >> 1), 0)
    moment = 0
    square = 0
    dark_end = (before + 1) * dark_slope
    bright_end = (after + 1) * bright_slope
    for step in range(1, before + 1):
        rise = max(rises[at - step] - dark_slope, 0)
        whole = whole + rise
        moment = moment - step * rise
        square = square + step * (step * rises[at - step] - dark_end)
    for step in range(1, after + 1):
        rise = max(rises[at + step] - bright_slope, 0)
        whole = whole + rise
        moment = moment + step * rise
        square = square + step * (step * rises[at + step] - bright_end)
    steep = max(rises[at], 0)
    fit[RISE_SUM] = fit[RISE_SUM] + steep * whole
    fit[SQUARE_SUM] = fit[SQUARE_SUM] + steep * max(square, 0)
    offset = FINE * (at - BEFORE) + FINE // 2
    if whole > 0:
        offset = offset + (2 * FINE * moment + whole) // (2 * whole)
    return offset


@kernel
def refine_row(
    selected: u32[:],
    count: i32,
    y: i32,
    luma: u8[:],
    height: i32,
    fit: i32[:],
    fit_range: i32,
    rises: i32[:],
    steepness: u16[:],
) -> None:
    """Make points of the selected edges of row `y` that are within `fit_range` pixels of the circle.

    The points replace earlier edges, from the first on; `steepness` gets how steep the outline is there.
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
            fill_rises(luma, edge_x(edge), y, way, flat, height, rises)
            at = steepest(rises)
            before = flank(rises, at, -1)
            after = flank(rises, at, 1)
            offset = way * outline_offset(rises, at, before, after, fit)
            across = max(offset * (1 - flat) + x, 0)
            down = max(offset * flat + FINE * y, 0)
            point = fit[REFINED]
            selected[point] = u32(across | down << 16)
            steepness[point] = max(rises[at], 0)
            fit[REFINED] = point + 1
        number = number + 1
    fit[NEXT_EDGE] = number
