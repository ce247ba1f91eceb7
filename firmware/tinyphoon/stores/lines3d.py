"""The 3-D lines and 3-D edges of a stereo frame (T §5.2.7, §5.2.8), on core A, for later stages.

Both are tables of structs of 16-bit words. Points are in the left camera's frame, in mm: x to the right, y down,
z forward along its axis. Words beyond the last record are undefined.

`lines_3d` holds a t_Line3D for each line of the left picture that has a corresponding line in the right one, in
the order of `lines`; start and end are those of the left line.
"""

from __future__ import annotations

LINE3D_X0 = 0  # start, mm
LINE3D_Y0 = 1
LINE3D_Z0 = 2
LINE3D_X1 = 3  # end, mm
LINE3D_Y1 = 4
LINE3D_Z1 = 5
LINE3D_LEFT = 6  # number of the line in `lines` of core A
LINE3D_RIGHT = 7  # number of the line in `right_lines`
LINE3D_WORDS = 8

# `edges_3d` holds a t_Edge3D for each edge of the left picture that has a corresponding one, row after row from the
# bottom: when the table is full, the remaining edges are farther away than the floor before the robot.
EDGE3D_X = 0  # mm
EDGE3D_Y = 1
EDGE3D_Z = 2
EDGE3D_LEFT = 3  # number of the edge in `edge_data` of core A
EDGE3D_WORDS = 4

EDGE3D_CAPACITY = 4096
"""32 KB: half of the edges of a full edge store. Cluttered rooms had 1900 to 3100."""
