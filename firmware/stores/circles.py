"""The circles of a picture, for the stages that follow: a table of t_Circle, one for each blob of a spherical model.

A t_Circle is a struct of 16-bit words, in the order of the blobs. Blobs whose circle fails a test have one too: without
a centre it has the blob's centre of mass, and radius and its share are 0; after a failed radius test the radius is that of
the peak all the same. Words beyond the last circle are undefined.
"""

from __future__ import annotations

CIRCLE_X = 0  # centre, 1/16 px
CIRCLE_Y = 1
CIRCLE_RADIUS = 2  # 1/16 px
CIRCLE_BLOB = 3  # number of its record in `blob_data`
CIRCLE_EDGES = 4  # edges that passed both filters
CIRCLE_CENTRE = 5  # peak of the votes by edges, 255 for as many as there can be (T Eq. 5.6)
CIRCLE_RADIUS_SHARE = 6  # peak of the radius histogram by edges, likewise (T Eq. 5.7)
CIRCLE_TESTS = 7  # CENTRE_PASSED, RADIUS_PASSED
CIRCLE_WORDS = 8

CENTRE_PASSED = 1 << 0  # T_c
RADIUS_PASSED = 1 << 1  # T_r
