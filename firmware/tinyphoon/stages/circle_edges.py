"""The edges of a ball's outline: those near its blob that pass the two filters of T §5.2.4.

Filter 1 needs the erosion of the opened image at each edge. It does not exist: the opening erodes the noisy image. So
DMA brings the blob's lines of the opened image back, and the filter erodes it only where there is an edge. That is a
tenth of the pixels at most, and nothing is written.

A selected edge is one word: direction in bits 0..7, y in 8..18, whether it looks away from the ball in 19, x in 20..31.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u16, u32
from tinyphoon.arithmetic import angle8
from tinyphoon.stages.line_segments import turn_between
from tinyphoon.stores.blobs import (
    ACROSS,
    BLOB_WORDS,
    CENTRE,
    COLOURS,
    DOWN,
    extent_of,
    is_cut_before,
    is_cut_behind,
)

NONE = -1

# Parts of a pixel for computing centre and radius: a picture 640 wide, squared, stays below 32 bits.
FINE = 64

# Where to look for the outline: in pixels, both ends included.
LEFT = 0
RIGHT = 1
TOP = 2
BOTTOM = 3
MASS_X = 4  # blob.cc, or the middle of a disc of which the picture shows less than half
MASS_Y = 5
REACH = 6  # the centre is sought this far from there on each side
BORDERING = 7  # edges that pass filter 1, wherever they look
AREA_WORDS = 8

HALF_TURN = 128
AWAY_BIT = 19


@kernel
def edge_x(edge: u32) -> i32:
    """Return the column of a selected edge."""
    return i32(edge >> 20)


@kernel
def edge_y(edge: u32) -> i32:
    """Return the row of a selected edge."""
    return i32(edge >> 8 & 0x7FF)


@kernel
def looks_away(edge: u32) -> i32:
    """Return 1 if the gradient of a selected edge looks away from the ball; else 0."""
    return i32(edge >> AWAY_BIT & 1)


@kernel
def next_blob(blob_data: u32[:], blob: i32, blobs: i32, colours: u32) -> i32:
    """Return the first blob from number `blob` on with some of `colours`, or NONE."""
    while blob < blobs:
        if blob_data[blob * BLOB_WORDS + COLOURS] & colours != 0:
            return blob
        blob = blob + 1
    return NONE


@kernel
def rows_of(area: i32[:]) -> i32:
    """Return the first row and the last, as a pair of shorts."""
    return area[TOP] | area[BOTTOM] << 16


@kernel
def middle_beyond(span: u32, chord: i32, pixels: i32, mass: i32) -> i32:
    """Return the middle of a disc along an axis with `pixels` in the picture, given its centre of mass.

    If the picture's border cuts a disc so that less than half is seen, the part seen and the chord at the border give
    the radius; from less than a seventh they hardly do.
    """
    seen = extent_of(span)
    before = is_cut_before(span)
    if before == is_cut_behind(span, pixels) or 2 * seen >= chord or 7 * seen < chord:
        return mass
    radius = (chord * chord + 4 * seen * seen) // (8 * seen)
    if before != 0:
        return i32(span >> 16) - radius
    return i32(span & 0xFFFF) + radius


@kernel
def open_area(
    blob_data: u32[:], blob: i32, area: i32[:], border: i32, patch_reach: i32, width: i32, height: i32
) -> i32:
    """Describe where to look for the outline of a blob, and return the first row and the last, as a pair of shorts."""
    across = blob_data[blob * BLOB_WORDS + ACROSS]
    down = blob_data[blob * BLOB_WORDS + DOWN]
    left = i32(across & 0xFFFF)
    right = i32(across >> 16)
    top = i32(down & 0xFFFF)
    bottom = i32(down >> 16)
    area[LEFT] = max(left - border, 0)
    area[RIGHT] = min(right + border, width - 1)
    area[TOP] = max(top - border, 0)
    area[BOTTOM] = min(bottom + border, height - 1)
    centre = blob_data[blob * BLOB_WORDS + CENTRE]
    area[MASS_X] = middle_beyond(across, extent_of(down), width, i32(centre & 0xFFFF))
    area[MASS_Y] = middle_beyond(down, extent_of(across), height, i32(centre >> 16))
    area[BORDERING] = 0
    area[REACH] = min(max(right - left, bottom - top) + 1 >> 1, patch_reach)
    return rows_of(area)


@kernel
def is_overlaid(above: u32[:], here: u32[:], below: u32[:], x: i32, colours: u32) -> i32:
    """Return 1 if the pixel at `x` and its eight neighbours all have one of `colours`; else 0 (filter 1).

    The colours count as one, as in the segmentation. No edge lies in the first or the last column.
    """
    for column in range(x - 1, x + 2):
        if above[column] & colours == 0 or here[column] & colours == 0 or below[column] & colours == 0:
            return 0
    return 1


@kernel
def is_near_colour(above: u32[:], here: u32[:], below: u32[:], x: i32, colours: u32) -> i32:
    """Return 1 if a pixel beside `x` has one of `colours`; else 0: the border of a shadow has floor on both sides.

    Up to two columns away, since pairs of pixels share their chroma.
    """
    for column in range(max(x - 2, 0), min(x + 3, len(here))):
        if (above[column] | here[column] | below[column]) & colours != 0:
            return 1
    return 0


@kernel
def looks_along(direction: i32, dx: i32, dy: i32, angle_range: i32, atan: u8[:]) -> i32:
    """Return 1 if a gradient points to (dx, dy), to `angle_range` 1/256 of a turn, -1 if it points away; else 0.

    This is filter 2 for a ball that is brighter than the background, or darker, or partly each.
    """
    turn = abs(turn_between(direction, angle8(dx, dy, atan)))
    if turn <= angle_range:
        return 1
    return -1 if turn >= HALF_TURN - angle_range else 0


@kernel
def select_edges_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    above: u32[:],
    here: u32[:],
    below: u32[:],
    colours: u32,
    area: i32[:],
    angle_range: i32,
    beside_colour: i32,
    atan: u8[:],
    selected: u32[:],
    found: i32,
) -> i32:
    """Append the edges of row `y` that pass both filters to the `found` earlier ones; return the new number.

    `above`, `here` and `below` are lines of the opened image. With `beside_colour`, an edge that looks away from the
    ball passes only near `colours`: a dark thing without its colour is a shadow. Edges beyond the length of `selected`
    are counted but not stored.
    """
    first = i32(edge_index[y])
    for position in range(first, first + edge_counts[y]):
        edge = edge_data[position]
        x = i32(edge >> 16)
        if area[LEFT] <= x <= area[RIGHT] and is_overlaid(above, here, below, x, colours) == 0:
            area[BORDERING] = area[BORDERING] + 1
            direction = edge >> 8 & 255
            dx = area[MASS_X] - x
            dy = area[MASS_Y] - y
            looks = looks_along(i32(direction), dx, dy, angle_range, atan)
            if looks < 0 and beside_colour != 0 and is_near_colour(above, here, below, x, colours) == 0:
                looks = 0
            if looks != 0:
                if found < len(selected):
                    away = 1 if looks < 0 else 0
                    selected[found] = direction | u32(y << 8 | away << AWAY_BIT) | u32(x << 20)
                found = found + 1
    return found
