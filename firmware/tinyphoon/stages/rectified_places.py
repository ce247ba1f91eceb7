"""Where the pixels of a camera lie in its rectified picture: a coarse table, interpolated between its nodes.

Recordings only have the reverse, the nearest source of each rectified pixel. Both ways are smooth, so a polynomial
through all sources gives the way there more finely than whole pixels. It says nothing about places without a rectified
pixel: there the table continues linearly, and what lies there is outside of the rectified picture.

The table has a node in every eighth row and column, 41 x 31 of them for 320x240: 5 KB, where a table of all pixels had
307. For a lens with k1 = -0.25 and k2 = 0.08 at 386 px, its error is 0.08 px (root mean square), and 0.3 px at most, in
a corner; interpolation causes 0.03 of these, and the rest comes from the recording's whole pixels.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.polynomial.chebyshev import chebvander2d
from numpy.typing import NDArray

from bfsim.api import Buffer, Buffers, SourcePixels, i16, i32, kernel
from tinyphoon.stores.lines import SUBPIXELS

NODE_PX = 8
NODE_BITS = 7  # of 1/16 px
HALF_CELL = 1 << 2 * NODE_BITS - 1

# The first words of `places`; then column and row of each node in the rectified picture, in 1/16 px, by row.
COLUMNS = 0  # nodes in a row
ROWS = 1
CORNER_X = 2  # where the area of interest begins, px
CORNER_Y = 3
NODES = 4

ACROSS = 0
DOWN = 1

DEGREE = 7  # for lenses that move the corners of a picture by a quarter of its width
LARGEST = (1 << 15) - 1

Points = NDArray[np.float64]


@kernel
def look_from(places: i16[:], x: i32, y: i32) -> None:
    """Set where the area of interest begins, from where all points count."""
    places[CORNER_X] = x
    places[CORNER_Y] = y


@kernel
def rectified(places: i16[:], x: i32, y: i32, axis: i32) -> i32:
    """Return column (ACROSS) or row (DOWN) of a camera's point in the rectified picture; all in 1/16 px, rounded.

    A point beyond the outermost nodes continues the nearest cell.
    """
    x = x + SUBPIXELS * places[CORNER_X]
    y = y + SUBPIXELS * places[CORNER_Y]
    column = min(max(x >> NODE_BITS, 0), places[COLUMNS] - 2)
    row = min(max(y >> NODE_BITS, 0), places[ROWS] - 2)
    right = x - (column << NODE_BITS)
    below = y - (row << NODE_BITS)
    at = NODES + 2 * (row * places[COLUMNS] + column) + axis
    under = at + 2 * places[COLUMNS]
    upper = (places[at] << NODE_BITS) + (places[at + 2] - places[at]) * right
    lower = (places[under] << NODE_BITS) + (places[under + 2] - places[under]) * right
    place = (upper << NODE_BITS) + (lower - upper) * below + HALF_CELL >> 2 * NODE_BITS
    return place - SUBPIXELS * places[CORNER_X + axis]


def places_buffers(sources: Mapping[str, SourcePixels]) -> Buffers:
    """Return the tables of both cores, made from those of a recording."""
    return {core: (_buffer(each),) for core, each in sources.items()}


def _buffer(sources: SourcePixels) -> Buffer:
    nodes = np.clip(np.rint(SUBPIXELS * node_places(sources)), -LARGEST, LARGEST).astype(np.int16)
    rows, columns, _ = nodes.shape
    words = np.concatenate(([columns, rows, 0, 0], nodes.ravel()))
    return Buffer("places", i16, len(words), "data1", values=words)


def node_places(sources: SourcePixels) -> Points:
    """Return column and row of each node in the rectified picture (rows, columns, 2), in pixels."""
    height, width = sources.rows.shape
    columns, rows = ((pixels - 1) // NODE_PX + 2 for pixels in (width, height))
    nodes = NODE_PX * np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1)
    to_y, to_x = np.nonzero(sources.rows >= 0)
    points = np.stack([sources.columns[to_y, to_x], sources.rows[to_y, to_x]], axis=-1)
    terms = _terms(points, (width, height))
    factors = np.linalg.lstsq(terms.T @ terms, terms.T @ np.stack([to_x, to_y], axis=-1), rcond=None)[0]
    near = np.zeros((rows, columns), bool)
    for dy in (0, 1):
        for dx in (0, 1):  # all four corners of the cell that contains a source
            near[points[:, 1] // NODE_PX + dy, points[:, 0] // NODE_PX + dx] = True
    return _continued(_terms(nodes, (width, height)) @ factors, near)


def _terms(points: NDArray[np.int64], size: tuple[int, int]) -> Points:
    """Return the terms of a polynomial of two variables, of total degree DEGREE, at some points (..., 2)."""
    x, y = np.moveaxis(2 * points / np.maximum(np.array(size) - 1, 1) - 1, -1, 0)
    degrees = np.add.outer(np.arange(DEGREE + 1), np.arange(DEGREE + 1)).ravel()
    terms: Points = chebvander2d(x, y, (DEGREE, DEGREE))[..., degrees <= DEGREE]
    return terms


def _continued(places: Points, known: NDArray[np.bool_]) -> Points:
    """Return the places; unknown ones continue two known ones beside them linearly, ring after ring."""
    places, known = places.copy(), known.copy()
    while not known.all():
        sums, counts = np.zeros_like(places), np.zeros(known.shape, int)
        for axis in (0, 1):
            for step in (1, -1):
                one, two = (_shifted(known, axis, by * step) for by in (1, 2))
                ends = ~known & one & two
                straight = 2 * _shifted(places, axis, step) - _shifted(places, axis, 2 * step)
                sums[ends] += straight[ends]
                counts[ends] += 1
        found = counts > 0
        if not found.any():
            break
        places[found] = sums[found] / counts[found][:, None]
        known |= found
    return places


def _shifted(grid: NDArray[np.generic], axis: int, by: int) -> NDArray[np.generic]:
    """Return for each node the value of the node `by` before it; beyond the border zeros."""
    moved = np.zeros_like(grid)
    span = [slice(None)] * grid.ndim
    source = span.copy()
    span[axis], source[axis] = (
        (slice(by, None), slice(None, -by)) if by > 0 else (slice(None, by), slice(-by, None))
    )
    moved[tuple(span)] = grid[tuple(source)]
    return moved
