"""The rectangles of a picture, for the stages that follow: a table of t_Rectangle, one for each blob of a model that is one.

A t_Rectangle is a struct of 16-bit words, in the order of the blobs: its border lines as indices into `lines`, or
NO_LINE, its blob, and which ends of it something hides. Words beyond the last rectangle are undefined.
"""

from __future__ import annotations

RECTANGLE_LEFT = 0
RECTANGLE_RIGHT = 1
RECTANGLE_TOP = 2
RECTANGLE_BOTTOM = 3
RECTANGLE_BLOB = 4  # number of its record in `blob_data`
RECTANGLE_HIDDEN = 5  # of a goal: bit 0 for the left end, bit 1 for the right one
RECTANGLE_WORDS = 6

NO_LINE = -1
RECTANGLE_CAPACITY = 32
