"""The rectangles of a picture, for later stages: a table of t_Rectangle, one for each blob of a rectangular model.

A t_Rectangle is a struct of 16-bit words, in the order of the blobs: its border lines as indices into `lines`, or
NO_LINE; its blob; which of its ends is hidden; the first and the last row of its blob at each end; and where the posts
of a goal end there, in 1/16 px. Words beyond the last rectangle are undefined.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u32
from tinyphoon.stores.blobs import pair

RECTANGLE_LEFT = 0
RECTANGLE_RIGHT = 1
RECTANGLE_TOP = 2
RECTANGLE_BOTTOM = 3
RECTANGLE_BLOB = 4  # number of its record in `blob_data`
RECTANGLE_HIDDEN = 5  # of a goal: bit 0 for the left end, bit 1 for the right one
RECTANGLE_LEFT_ROWS = 6  # the first one, followed by the last one
RECTANGLE_RIGHT_ROWS = 8
RECTANGLE_LEFT_FOOT = 10
RECTANGLE_RIGHT_FOOT = 11
RECTANGLE_WORDS = 12

NO_LINE = -1
RECTANGLE_CAPACITY = 32


@kernel
def rows_at(rectangles: i16[:], rectangle: i32, end: i32) -> u32:
    """Return the rows of a rectangle's blob at an end, RECTANGLE_LEFT_ROWS or RECTANGLE_RIGHT_ROWS, as two shorts."""
    at = rectangle * RECTANGLE_WORDS + end
    return pair(i32(rectangles[at]), i32(rectangles[at + 1]))


@kernel
def store_rows(rectangles: i16[:], rectangle: i32, end: i32, first: i32, last: i32) -> None:
    """Store the rows of a rectangle's blob at an end."""
    at = rectangle * RECTANGLE_WORDS + end
    rectangles[at] = first
    rectangles[at + 1] = last
