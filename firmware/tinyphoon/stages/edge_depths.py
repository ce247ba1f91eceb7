"""3-D edges from a row of disparities: the depths of the edges, to fractions of a pixel of disparity.

Edges lie in whole pixels, so the disparity of a pair is whole, and up to a pixel off. The rows around show the same contour
at other fractions of a pixel: where it continues, the mean of their disparities is more accurate than a single one.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u32
from tinyphoon.geometry import store_point
from tinyphoon.stages.edge_following import like_beside
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.lines3d import EDGE3D_LEFT, EDGE3D_WORDS, EDGE3D_X


@kernel
def mean_disparities(
    left_row: u32[:],
    left_count: i32,
    above2: i16[:],
    above: i16[:],
    here: i16[:],
    below: i16[:],
    below2: i16[:],
    means: i16[:],
) -> None:
    """Set for each left edge the mean of its disparity and of similar ones in the rows around, in 1/16 px, or 0."""
    for left in range(left_count):
        x = i32(left_row[left] >> 16)
        disparity = i32(here[x])
        means[left] = 0
        if disparity > 0:
            near_below = like_beside(below, x, 1, disparity)
            near_above = like_beside(above, x, 1, disparity)
            far_below = like_beside(below2, x, 2, disparity)
            far_above = like_beside(above2, x, 2, disparity)
            total = disparity + near_below + near_above + far_below + far_above
            count = 1 + min(near_below, 1) + min(near_above, 1) + min(far_below, 1) + min(far_above, 1)
            means[left] = (SUBPIXELS * total + count // 2) // count - SUBPIXELS


@kernel
def store_edges3d_row(
    edge_data: u32[:],
    edge_index: u32[:],
    y: i32,
    left_row: u32[:],
    left_count: i32,
    disparities: i16[:],
    farthest: i32,
    geometry: i32[:],
    width: i32,
    height: i32,
    edges_3d: i16[:],
    found: i32,
) -> i32:
    """Store the 3-D edges of row `y`: left edges whose disparity, in 1/16 px, is above `farthest`.

    `found` is how many the rows before gave; returns the number with this row. Those beyond the length of `edges_3d`
    are counted but not stored.
    """
    place = i32(edge_index[y])
    for left in range(left_count):
        edge = left_row[left]
        x = i32(edge >> 16)
        disparity = i32(disparities[left])
        if disparity > farthest:
            base = EDGE3D_WORDS * found
            stored = 1
            if base < len(edges_3d):
                stored = store_point(
                    geometry,
                    SUBPIXELS * x,
                    SUBPIXELS * y,
                    disparity,
                    width,
                    height,
                    edges_3d,
                    base + EDGE3D_X,
                )
            if stored != 0 and base < len(edges_3d):
                while edge_data[place] != edge:
                    place = place + 1
                edges_3d[base + EDGE3D_LEFT] = place
            found = found + stored
    return found
