"""The objects that the robot knows: a table of t_Object, for what a camera sees now and for the object history.

A t_Object is a struct of 16-bit words. Records whose model is NO_MODEL are free. Places are in the frame of the left
camera: x to the right, y down, z forward.

`left_seen` and `right_seen` hold what each camera sees, the latter in its own camera's frame until core A has taken it;
`objects` is the history, which goes to the strategy unit (T §5.2.6).
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel

OBJECT_MODEL = 0  # number of its model
OBJECT_ACCURACY = 1  # 0..255
OBJECT_TESTS = 2  # passed tests: *_TEST, VERIFIED
OBJECT_CAMERAS = 3  # that see it: SEEN_LEFT, SEEN_RIGHT
OBJECT_MEASURES = 4  # of the distance: BY_*, or 0 if only the direction is known
OBJECT_X = 5  # place in mm; if only the direction is known, a vector in that direction, DIRECTION_Z long in z
OBJECT_Y = 6
OBJECT_Z = 7
OBJECT_IMAGE_X = 8  # middle in the left picture, or in the right one if only that shows it, 1/16 px
OBJECT_IMAGE_Y = 9
OBJECT_WIDTH = 10  # in that picture, 1/16 px
OBJECT_HEIGHT = 11
OBJECT_EXTENT = 12  # the extent in the picture from which its distance is measured, 1/16 px
OBJECT_OUTLINE = (
    13  # number of its record in `circles` or `rectangles` of the camera that sees it, or NO_OUTLINE
)
OBJECT_AGE = 14  # frames since it was last seen, 0: in this one
OBJECT_WORDS = 15

NO_MODEL = 0
NO_OUTLINE = -1

COLOUR_TEST = 1 << 0  # in the order of the tests (T Figure 5.7)
DIMENSION_TEST = 1 << 1
AREA_TEST = 1 << 2
CENTRE_TEST = 1 << 3  # T_c of a circle; the bottom line of a rectangle
SIZE_TEST = 1 << 4  # T_r of a circle; the lines left and right of a rectangle
VERIFIED = 1 << 5  # by the second camera

SEEN_LEFT = 1 << 0
SEEN_RIGHT = 1 << 1

BY_SIZE = 1 << 0  # T Eq. 4.1-4.3
BY_FLOOR = 1 << 1  # T Eq. 4.4, 4.5
BY_DISPARITY = 1 << 2  # T Eq. 3.16

DIRECTION_Z = 4096

SEEN_CAPACITY = 16
OBJECT_CAPACITY = 16


@kernel
def free_objects(objects: i16[:], first: i32) -> None:
    """Free the records from number `first` on."""
    for at in range(first * OBJECT_WORDS, len(objects), OBJECT_WORDS):
        objects[at + OBJECT_MODEL] = NO_MODEL


@kernel
def copy_object(source: i16[:], number: i32, objects: i16[:], to: i32) -> None:
    """Copy record `number` of `source` to record `to` of `objects`."""
    for word in range(OBJECT_WORDS):
        objects[to * OBJECT_WORDS + word] = source[number * OBJECT_WORDS + word]
