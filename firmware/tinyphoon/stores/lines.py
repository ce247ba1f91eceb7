"""The lines of a picture, for later stages: a table of t_Line, in the order in which they were found.

A t_Line is a struct of 16-bit words. Its start and end lie on the line through its edges, in sixteenths of a pixel,
with the bright side on the left when going from start to end. Words beyond the last line are undefined.
"""

from __future__ import annotations

LINE_X0 = 0  # start, 1/16 px
LINE_Y0 = 1
LINE_X1 = 2  # end, 1/16 px
LINE_Y1 = 3
LINE_ANGLE = 4  # from start to end, an 8-bit angle
LINE_EDGES = 5  # edges in the line
LINE_PROBABILITY = 6  # edges by length in pixels, 255 for the most possible
LINE_BEHIND = (
    7  # Muff parameters: where it comes from and where it goes to on the picture's border, in pixels
)
LINE_AHEAD = 8  # clockwise from the upper left corner
LINE_WORDS = 9

SUBPIXELS = 16
