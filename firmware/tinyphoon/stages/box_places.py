"""The place of a box, from the upright edges at both ends of its blob, and from one between them for two faces (T §7.2).

The thesis wishes for the detection of boxes but only says that 3-D lines may help (T §5.2.9); this is [ours]. Seen from
above, an upright edge is a point on the floor. With two faces in view, the outer two are opposite corners, and the middle
of the box lies behind the near corner, half a diagonal away, towards the middle between the outer two: the near edge is
measured best, and the far ones only give the direction. If that edge has no contrast, but the others are a diagonal apart,
the middle is between them. With one face in view they are as far apart as the box is wide or deep, and the middle lies
behind that face. If their distance is none of these, or an edge has no depth, the box stays at its place by the floor.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, i16, i32, kernel, u32
from tinyphoon.arithmetic import isqrt32
from tinyphoon.geometry import (
    FARTHEST_MM,
    GEOMETRY_COSINE,
    GEOMETRY_HEIGHT,
    GEOMETRY_SINE,
    HEIGHT_STEPS,
    SINE_BITS,
    disparity_at,
)
from tinyphoon.stages.object_tests import BOX
from tinyphoon.stores.lines3d import (
    LINE3D_LEFT,
    LINE3D_WORDS,
    LINE3D_X0,
    LINE3D_X1,
    LINE3D_Y0,
    LINE3D_Z0,
)
from tinyphoon.stores.objects import (
    BY_DISPARITY,
    NO_MODEL,
    NO_OUTLINE,
    OBJECT_EXTENT,
    OBJECT_MEASURES,
    OBJECT_MODEL,
    OBJECT_OUTLINE,
    OBJECT_WORDS,
    OBJECT_X,
    OBJECT_Y,
    OBJECT_Z,
)
from tinyphoon.stores.rectangles import NO_LINE, RECTANGLE_LEFT, RECTANGLE_RIGHT, RECTANGLE_WORDS
from tinyphoon.strategy.models import (
    LARGEST_MM,
    MODEL_DEPTH,
    MODEL_FLOOR,
    MODEL_HEIGHT,
    MODEL_NUMBER,
    MODEL_SHAPE,
    MODEL_WIDTH,
    MODEL_WORDS,
)

NONE = -1
SIZE_PARTS = 5  # a side may look a fifth longer or shorter
CORNER_PARTS = 2  # the near corner may be half nearer or farther
FAR_APART = 2 * LARGEST_MM  # mm: farther than any box is wide; squares fit in 32 bits


@kernel
def model_of(models: i32[:], number: i32) -> i32:
    """Return where the words of a box's model begin, NONE if the model `number` is no box."""
    for at in range(0, len(models), MODEL_WORDS):
        if models[at + MODEL_NUMBER] == number and models[at + MODEL_SHAPE] == BOX:
            return at
    return NONE


@kernel
def ahead_of(geometry: i32[:], down: i32, depth: i32) -> i32:
    """Return how far ahead over the floor a point of the camera's frame is, in mm."""
    return depth * geometry[GEOMETRY_COSINE] - down * geometry[GEOMETRY_SINE] >> SINE_BITS


@kernel
def below_of(geometry: i32[:], down: i32, depth: i32) -> i32:
    """Return how far below the camera a point of the camera's frame is, in mm."""
    return depth * geometry[GEOMETRY_SINE] + down * geometry[GEOMETRY_COSINE] >> SINE_BITS


@kernel
def edge_ahead(geometry: i32[:], lines_3d: i16[:], number: i32) -> i32:
    """Return how far ahead over the floor the middle of a 3-D line is, in mm."""
    at = number * LINE3D_WORDS
    down = lines_3d[at + LINE3D_Y0] + lines_3d[at + LINE3D_X1 + 1]
    depth = lines_3d[at + LINE3D_Z0] + lines_3d[at + LINE3D_X1 + 2]
    return ahead_of(geometry, down, depth) >> 1


@kernel
def edge_aside(lines_3d: i16[:], number: i32) -> i32:
    """Return how far to the right the middle of a 3-D line is, in mm."""
    at = number * LINE3D_WORDS
    return lines_3d[at + LINE3D_X0] + lines_3d[at + LINE3D_X1] >> 1


@kernel
def is_upright(geometry: i32[:], lines_3d: i16[:], number: i32, height_mm: i32) -> i32:
    """Return 1 if a 3-D line stands on the floor and is at least half of `height_mm` high; else 0.

    It leans aside by at most a quarter of that; ahead it may lean by its height, for depth is less accurate.
    """
    at = number * LINE3D_WORDS
    down = lines_3d[at + LINE3D_X1 + 1] - lines_3d[at + LINE3D_Y0]
    depth = lines_3d[at + LINE3D_X1 + 2] - lines_3d[at + LINE3D_Z0]
    high = abs(below_of(geometry, down, depth))
    if 2 * high < height_mm or abs(ahead_of(geometry, down, depth)) > high:
        return 0
    return 1 if 4 * abs(lines_3d[at + LINE3D_X1] - lines_3d[at + LINE3D_X0]) <= high else 0


@kernel
def edge_of(lines_3d: i16[:], count: i32, line: i32) -> i32:
    """Return which of `count` 3-D lines comes from `line` of the left picture, NONE if none does."""
    if line != NO_LINE:
        for number in range(count):
            if lines_3d[number * LINE3D_WORDS + LINE3D_LEFT] == line:
                return number
    return NONE


@kernel
def length_of(across: i32, ahead: i32) -> i32:
    """Return the length of a way over the floor, FAR_APART if it is longer than that."""
    if abs(across) >= FAR_APART or abs(ahead) >= FAR_APART:
        return FAR_APART
    return i32(isqrt32(u32(across * across) + u32(ahead * ahead)))


@kernel
def is_about(length: i32, wanted: i32, parts: i32) -> i32:
    """Return 1 if a length is about `wanted`, give or take one of its `parts`; else 0."""
    return 1 if parts * abs(length - wanted) <= wanted else 0


@kernel
def near_edge(
    geometry: i32[:],
    lines_3d: i16[:],
    count: i32,
    left: i32,
    right: i32,
    wide: i32,
    corner: i32,
    height_mm: i32,
) -> i32:
    """Return the upright 3-D line of a box's near corner, NONE if it is not seen.

    It stands between the lines `left` and `right`, `wide` mm apart, and about `corner` mm before the way from one to
    the other. If there are several, it is the nearest.
    """
    left_x = edge_aside(lines_3d, left)
    left_z = edge_ahead(geometry, lines_3d, left)
    across = edge_aside(lines_3d, right) - left_x
    ahead = edge_ahead(geometry, lines_3d, right) - left_z
    found: i32 = NONE
    nearest: i32 = FARTHEST_MM
    for number in range(count):
        x = edge_aside(lines_3d, number) - left_x
        z = edge_ahead(geometry, lines_3d, number)
        along = x * across + (z - left_z) * ahead
        if abs(x) < FAR_APART and z < nearest and 0 < along < wide * wide:
            before = (x * ahead - (z - left_z) * across) // wide
            if (
                is_about(before, corner, CORNER_PARTS) & is_upright(geometry, lines_3d, number, height_mm)
                != 0
            ):
                found = number
                nearest = z
    return found


@kernel
def stand_box(
    geometry: i32[:], models: i32[:], model: i32, x: i32, ahead: i32, objects: i16[:], number: i32
) -> None:
    """Place the middle of a box over a point of the floor, `x` mm to the right and `ahead` mm away."""
    at = number * OBJECT_WORDS
    below = (
        geometry[GEOMETRY_HEIGHT] // HEIGHT_STEPS
        - models[model + MODEL_FLOOR]
        - (models[model + MODEL_HEIGHT] >> 1)
    )
    sine = geometry[GEOMETRY_SINE]
    cosine = geometry[GEOMETRY_COSINE]
    depth = ahead * cosine + below * sine >> SINE_BITS
    if 0 < depth <= FARTHEST_MM:
        objects[at + OBJECT_X] = x
        objects[at + OBJECT_Y] = below * cosine - ahead * sine >> SINE_BITS
        objects[at + OBJECT_Z] = depth
        objects[at + OBJECT_MEASURES] = BY_DISPARITY
        objects[at + OBJECT_EXTENT] = disparity_at(geometry, depth)


@kernel
def place_box(
    geometry: i32[:],
    models: i32[:],
    model: i32,
    lines_3d: i16[:],
    count: i32,
    left: i32,
    right: i32,
    objects: i16[:],
    number: i32,
) -> None:
    """Place a box whose blob ends with the 3-D lines `left` and `right`, if these determine its place."""
    width_mm = models[model + MODEL_WIDTH]
    depth_mm = models[model + MODEL_DEPTH]
    left_x = edge_aside(lines_3d, left)
    left_z = edge_ahead(geometry, lines_3d, left)
    across = edge_aside(lines_3d, right) - left_x
    ahead = edge_ahead(geometry, lines_3d, right) - left_z
    wide = length_of(across, ahead)
    middle_x = left_x + (across >> 1)
    middle_z = left_z + (ahead >> 1)
    diagonal = length_of(width_mm, depth_mm)
    if not 0 < wide < FAR_APART:
        return
    near: i32 = NONE
    if is_about(wide, diagonal, SIZE_PARTS) != 0:
        corner = width_mm * depth_mm // diagonal
        near = near_edge(geometry, lines_3d, count, left, right, wide, corner, models[model + MODEL_HEIGHT])
    if near != NONE:
        x = edge_aside(lines_3d, near)
        z = edge_ahead(geometry, lines_3d, near)
        way = max(length_of(middle_x - x, middle_z - z), 1)
        x = x + (middle_x - x) * (diagonal >> 1) // way
        z = z + (middle_z - z) * (diagonal >> 1) // way
        stand_box(geometry, models, model, x, z, objects, number)
    else:
        length = width_mm
        behind = depth_mm
        if abs(wide - depth_mm) < abs(wide - length):
            length = depth_mm
            behind = width_mm
        if abs(wide - diagonal) < abs(wide - length):
            length = diagonal
            behind = 0
        if is_about(wide, length, SIZE_PARTS) != 0:
            x = middle_x - ahead * behind // (2 * wide)
            z = middle_z + across * behind // (2 * wide)
            stand_box(geometry, models, model, x, z, objects, number)


@kernel
def place_all_boxes(
    geometry: i32[:], models: i32[:], rectangles: i16[:], lines_3d: i16[:], count: i32, seen: i16[:]
) -> None:
    """Place the boxes in `seen` by `count` 3-D lines."""
    for number in range(len(seen) // OBJECT_WORDS):
        at = number * OBJECT_WORDS
        model: i32 = NONE
        if seen[at + OBJECT_MODEL] != NO_MODEL and seen[at + OBJECT_OUTLINE] != NO_OUTLINE:
            model = model_of(models, i32(seen[at + OBJECT_MODEL]))
        if model != NONE:
            borders = seen[at + OBJECT_OUTLINE] * RECTANGLE_WORDS
            left = edge_of(lines_3d, count, i32(rectangles[borders + RECTANGLE_LEFT]))
            right = edge_of(lines_3d, count, i32(rectangles[borders + RECTANGLE_RIGHT]))
            if min(left, right) != NONE:
                place_box(geometry, models, model, lines_3d, count, left, right, seen, number)


def place_boxes(core: Core, lines_3d: int) -> Generator[Any, Any, None]:
    """Place the boxes that the left camera sees by the first `lines_3d` 3-D lines."""
    found = core.array("rectangles"), core.array("lines_3d"), lines_3d
    yield core.run(
        place_all_boxes, core.array("geometry"), core.array("models"), *found, core.array("left_seen")
    )
