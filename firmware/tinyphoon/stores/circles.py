"""The circles of a picture, for later stages: a table of t_Circle, one for each blob of a spherical model.

A t_Circle is a struct of 16-bit words, in the order of the blobs. Blobs whose circle fails a test have one, too:
without a centre it has the blob's centre of mass, and its radius and radius share are 0; after a failed radius test,
the radius is still that of the peak. Words beyond the last circle are undefined.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u32
from tinyphoon.stores.blobs import ACROSS, BLOB_WORDS, DOWN
from tinyphoon.stores.lines import SUBPIXELS

CIRCLE_X = 0  # centre, 1/16 px
CIRCLE_Y = 1
CIRCLE_RADIUS = 2  # 1/16 px
CIRCLE_BLOB = 3  # number of its record in `blob_data`
CIRCLE_EDGES = 4  # edges that passed both filters
CIRCLE_CENTRE = 5  # peak of the votes over edges, 255 for the most possible (T Eq. 5.6)
CIRCLE_RADIUS_SHARE = 6  # peak of the radius histogram over edges, likewise (T Eq. 5.7)
CIRCLE_TESTS = 7  # CENTRE_PASSED, RADIUS_PASSED
CIRCLE_ARC = 8  # the part of the circle with outline on it, 256 for all; 0 if it is not fitted
CIRCLE_WORDS = 9

CENTRE_PASSED = 1 << 0  # T_c
RADIUS_PASSED = 1 << 1  # T_r

BLOB_SLACK = 2 * SUBPIXELS  # a blob's colour ends up to two pixels from its outline: pairs share their chroma


@kernel
def reaches_over(span: u32, centre: i32, radius: i32) -> i32:
    """Return 1 if a pair of ends in pixels exceeds the square around a circle, in 1/16 px, along its axis; else 0."""
    reach = radius + BLOB_SLACK
    if SUBPIXELS * i32(span & 0xFFFF) < centre - reach or SUBPIXELS * i32(span >> 16) > centre + reach:
        return 1
    return 0


@kernel
def lies_within(blob_data: u32[:], blob: i32, circles: i16[:], circle: i32) -> i32:
    """Return 1 if a blob lies within the square around the circle whose words begin at `circle`, else 0."""
    radius = i32(circles[circle + CIRCLE_RADIUS])
    across = blob_data[blob * BLOB_WORDS + ACROSS]
    down = blob_data[blob * BLOB_WORDS + DOWN]
    if reaches_over(across, i32(circles[circle + CIRCLE_X]), radius) != 0:
        return 0
    if reaches_over(down, i32(circles[circle + CIRCLE_Y]), radius) != 0:
        return 0
    return 1
