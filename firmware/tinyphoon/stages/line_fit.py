"""The line through the edges of a segment, in sixteenths of a pixel: least squares from the segment's sums."""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u8
from tinyphoon.arithmetic import angle8
from tinyphoon.stages.line_segments import (
    EDGES,
    END_X,
    END_Y,
    SEGMENT_WORDS,
    START_X,
    START_Y,
    SUM_X,
    SUM_XX,
    SUM_XY,
    SUM_Y,
    SUM_YY,
)
from tinyphoon.stores.lines import (
    LINE_AHEAD,
    LINE_ANGLE,
    LINE_BEHIND,
    LINE_EDGES,
    LINE_PROBABILITY,
    LINE_WORDS,
    LINE_X0,
    LINE_X1,
    LINE_Y0,
    LINE_Y1,
    SUBPIXELS,
)

HALF_PIXEL = SUBPIXELS // 2
SLOPE_BITS = 12
WIDEST = 1 << 30 - SLOPE_BITS
"""Smaller spreads can be shifted up by SLOPE_BITS."""


@kernel
def spread(products: i32, sum_a: i32, sum_b: i32, edges: i32) -> i32:
    """Return the sum of (a - mean a)(b - mean b) from the sums of ab, a and b, without leaving 32 bits."""
    mean_a = sum_a // edges
    mean_b = sum_b // edges
    rest_a = sum_a - edges * mean_a
    rest_b = sum_b - edges * mean_b
    return products - mean_a * sum_b - mean_b * rest_a - rest_a * rest_b // edges


@kernel
def slope(along: i32, across: i32) -> i32:
    """Return across / along as a fraction of 1 << SLOPE_BITS; 0 for a single point."""
    while along >= WIDEST or abs(across) >= WIDEST:
        along = along >> 1
        across = across >> 1
    if along == 0:
        return 0
    return (across << SLOPE_BITS) // along


@kernel
def foot(along: i32, across: i32, rise: i32) -> i32:
    """Return how far along an axis, from the middle of a line of slope `rise`, the point nearest to another lies."""
    length = (1 << SLOPE_BITS) + (rise * rise >> SLOPE_BITS)
    return ((along << SLOPE_BITS) + rise * across + (length >> 1)) // length


@kernel
def border_position(x: i32, y: i32, dx: i32, dy: i32, right: i32, bottom: i32) -> i32:
    """Return where on the border a line through (x, y) leaves the picture in the direction (dx, dy), in pixels.

    All are in sixteenths of a pixel; the border goes clockwise from the upper left corner around the rectangle with the
    lower right corner (`right`, `bottom`). (T §2.2.1, Figure 2.4.)
    """
    to_side = max(right - x if dx > 0 else x, 0)
    to_level = max(bottom - y if dy > 0 else y, 0)
    if to_side * abs(dy) <= to_level * abs(dx):
        level = y
        if dx != 0:
            level = y + to_side * dy // abs(dx)
        position = right + level if dx > 0 else 2 * right + 2 * bottom - level
    else:
        side = x + to_level * dx // abs(dy)
        position = 2 * right + bottom - side if dy > 0 else side
    return position // SUBPIXELS


@kernel
def store_ends(
    lines: i16[:], line: i32, x0: i32, y0: i32, x1: i32, y1: i32, atan: u8[:], width: i32, height: i32
) -> None:
    """Store start and end of line number `line`, and what follows from them: its angle and its Muff parameters."""
    base = line * LINE_WORDS
    dx = x1 - x0
    dy = y1 - y0
    right = SUBPIXELS * (width - 1)
    bottom = SUBPIXELS * (height - 1)
    lines[base + LINE_X0] = x0
    lines[base + LINE_Y0] = y0
    lines[base + LINE_X1] = x1
    lines[base + LINE_Y1] = y1
    lines[base + LINE_ANGLE] = angle8(dx, dy, atan)
    lines[base + LINE_BEHIND] = border_position(x0, y0, -dx, -dy, right, bottom)
    lines[base + LINE_AHEAD] = border_position(x1, y1, dx, dy, right, bottom)


@kernel
def fit_line(
    segments: i32[:], place: i32, lines: i16[:], line: i32, atan: u8[:], width: i32, height: i32
) -> None:
    """Make line number `line` from the segment at `place`.

    Its ends are the feet of the segment's outermost edges, extended by half a pixel: n edges are n pixels long.
    """
    base = place * SEGMENT_WORDS
    edges = segments[base + EDGES]
    sum_x = segments[base + SUM_X]
    sum_y = segments[base + SUM_Y]
    xx = spread(segments[base + SUM_XX], sum_x, sum_x, edges)
    yy = spread(segments[base + SUM_YY], sum_y, sum_y, edges)
    xy = spread(segments[base + SUM_XY], sum_x, sum_y, edges)
    middle_x = (SUBPIXELS * sum_x + (edges >> 1)) // edges
    middle_y = (SUBPIXELS * sum_y + (edges >> 1)) // edges
    start_x = SUBPIXELS * segments[base + START_X] - middle_x
    start_y = SUBPIXELS * segments[base + START_Y] - middle_y
    end_x = SUBPIXELS * segments[base + END_X] - middle_x
    end_y = SUBPIXELS * segments[base + END_Y] - middle_y
    if xx >= yy:
        rise = slope(xx, xy)
        start_x = foot(start_x, start_y, rise)
        end_x = foot(end_x, end_y, rise)
        reach = HALF_PIXEL if start_x <= end_x else -HALF_PIXEL
        start_x = start_x - reach
        start_y = start_x * rise >> SLOPE_BITS
        end_x = end_x + reach
        end_y = end_x * rise >> SLOPE_BITS
    else:
        rise = slope(yy, xy)
        start_y = foot(start_y, start_x, rise)
        end_y = foot(end_y, end_x, rise)
        reach = HALF_PIXEL if start_y <= end_y else -HALF_PIXEL
        start_y = start_y - reach
        start_x = start_y * rise >> SLOPE_BITS
        end_y = end_y + reach
        end_x = end_y * rise >> SLOPE_BITS
    pixels = (max(abs(end_x - start_x), abs(end_y - start_y)) + HALF_PIXEL) // SUBPIXELS
    store_ends(
        lines, line, middle_x + start_x, middle_y + start_y, middle_x + end_x, middle_y + end_y, atan, width, height
    )  # fmt: skip
    lines[line * LINE_WORDS + LINE_EDGES] = edges
    lines[line * LINE_WORDS + LINE_PROBABILITY] = min((edges << 8) // pixels, 255)
