"""The place of a rectangle, by the floor below its bottom (T §4.1.2): a mark above the floor, or a goal.

A goal is a box open to the front, so its back fills most of its blob, and seen at an angle it is no rectangle (T §6.4).
At its mouth its posts stand on the floor: the feet at both ends of its blob are a goal's width apart, and the middle of
the mouth is between them [ours].
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u32
from tinyphoon.arithmetic import isqrt32
from tinyphoon.geometry import (
    GEOMETRY_COSINE,
    GEOMETRY_SHIFT_X,
    GEOMETRY_SHIFT_Y,
    GEOMETRY_SINE,
    SINE_BITS,
    beside_mm,
)
from tinyphoon.stages.object_places import HALF_PIXEL, depth_by_floor, floor_extent, place_object, principal
from tinyphoon.stages.object_tests import BOX, GOAL
from tinyphoon.stages.rectangle_detection import crossing, lower
from tinyphoon.stages.rectangle_ends import LEFT_HIDDEN, RIGHT_HIDDEN
from tinyphoon.stores.blobs import (
    ACROSS,
    BLOB_WORDS,
    DOWN,
    is_cut,
    is_cut_before,
    is_cut_behind,
)
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_X1, LINE_Y0, LINE_Y1, SUBPIXELS
from tinyphoon.stores.objects import (
    BY_FLOOR,
    DIMENSION_TEST,
    NO_OUTLINE,
    OBJECT_EXTENT,
    OBJECT_IMAGE_X,
    OBJECT_MEASURES,
    OBJECT_OUTLINE,
    OBJECT_WORDS,
    OBJECT_X,
    OBJECT_Y,
    OBJECT_Z,
)
from tinyphoon.stores.rectangles import (
    NO_LINE,
    RECTANGLE_BOTTOM,
    RECTANGLE_HIDDEN,
    RECTANGLE_LEFT_FOOT,
    RECTANGLE_LEFT_ROWS,
    RECTANGLE_RIGHT_FOOT,
    RECTANGLE_RIGHT_ROWS,
    RECTANGLE_WORDS,
    rows_at,
)
from tinyphoon.strategy.models import (
    LARGEST_MM,
    MODEL_DEPTH,
    MODEL_FLOOR,
    MODEL_HEIGHT,
    MODEL_SHAPE,
    MODEL_WIDTH,
)

OPENING_LOSS = SUBPIXELS  # how far above its bottom line the opening may end a blob [ours]
FLOOR_LINE = 4 * SUBPIXELS  # how far below the feet a line painted along the goal may be [ours]
FAR_APART = 4 * LARGEST_MM  # mm: farther than any goal is wide; three squares of it fit in 32 bits


@kernel
def bottom_row(down: u32, rectangles: i16[:], rectangle: i32, lines: i16[:], column: i32) -> i32:
    """Return where a rectangle ends below at `column`, in 1/16 px: at its bottom line, or else at the end of its blob.

    `down` are the rows of its blob, or of the part that is there.
    """
    if rectangle != NO_OUTLINE:
        line = i32(rectangles[rectangle * RECTANGLE_WORDS + RECTANGLE_BOTTOM])
        if line != NO_LINE:
            at = line * LINE_WORDS
            x = i32(lines[at + LINE_X0])
            y = i32(lines[at + LINE_Y0])
            return crossing(x, y, i32(lines[at + LINE_X1]), i32(lines[at + LINE_Y1]), column)
    return lower(down)


@kernel
def foot_row(
    down: u32, rectangles: i16[:], rectangle: i32, foot: i32, lines: i16[:], column: i32, cut: i32
) -> i32:
    """Return where a goal stands on the floor at an end of its blob, in 1/16 px; `down` are the rows of the part there.

    That is the goal's bottom line, with two exceptions. If the part ends a little above that line, the part's end is the
    foot of a post, and the line is one that is painted on the floor: its front edge is nearer to the camera, and the blur
    moves it further down the thinner it looks. Where the picture has `cut` the part off, or where the goal's border lines at
    that end go on below it, down to its `foot`, its end is no foot. And if the part ends below that line, the line is that of the goal's back,
    farther away, and what stands before it is the post.
    """
    end = bottom_row(down, rectangles, NO_OUTLINE, lines, column)
    line = bottom_row(down, rectangles, rectangle, lines, column)
    if line + OPENING_LOSS < end:
        return end
    if rectangle == NO_OUTLINE or cut != 0:
        return line
    if rectangles[rectangle * RECTANGLE_WORDS + foot] > end + OPENING_LOSS:
        return line
    return end if end + OPENING_LOSS < line <= end + FLOOR_LINE else line


@kernel
def scaled(height_mm: i32, fraction: i32) -> i32:
    """Return a fraction, with SINE_BITS, of half a height, rounded."""
    return (height_mm * fraction >> SINE_BITS) + 1 >> 1


@kernel
def on_the_way(from_mm: i32, to_mm: i32, part: i32, whole: i32) -> i32:
    """Return the place `part` of `whole` on the way from one place to another along an axis, rounded."""
    return from_mm + (2 * (to_mm - from_mm) * part + whole) // (2 * whole)


@kernel
def lift(geometry: i32[:], models: i32[:], model: i32, row: i32, objects: i16[:], number: i32) -> None:
    """Move an object from its lower border, seen in `row`, up to its middle; its place was measured by the floor."""
    at = number * OBJECT_WORDS
    up = models[model + MODEL_HEIGHT]
    objects[at + OBJECT_Y] = objects[at + OBJECT_Y] - scaled(up, geometry[GEOMETRY_COSINE])
    objects[at + OBJECT_Z] = objects[at + OBJECT_Z] - scaled(up, geometry[GEOMETRY_SINE])
    objects[at + OBJECT_MEASURES] = BY_FLOOR
    objects[at + OBJECT_EXTENT] = abs(floor_extent(geometry, row))


@kernel
def stand_at(geometry: i32[:], depth: i32, column: i32, row: i32, objects: i16[:], number: i32) -> None:
    """Place an object's lower border where it is seen at a depth; `column` and `row` count from the principal point."""
    at = number * OBJECT_WORDS
    objects[at + OBJECT_X] = beside_mm(geometry, depth, column)
    objects[at + OBJECT_Y] = beside_mm(geometry, depth, row)
    objects[at + OBJECT_Z] = depth


@kernel
def distance_of(across: i32, down: i32, deep: i32) -> i32:
    """Return how far apart two points are, FAR_APART if more than that along an axis."""
    if abs(across) >= FAR_APART or abs(down) >= FAR_APART or abs(deep) >= FAR_APART:
        return FAR_APART
    return i32(isqrt32(u32(across * across) + u32(down * down) + u32(deep * deep)))


@kernel
def stand_between_feet(
    geometry: i32[:],
    wide: i32,
    left: i32,
    left_row: i32,
    right: i32,
    right_row: i32,
    cut_left: i32,
    cut_right: i32,
    hidden: i32,
    objects: i16[:],
    number: i32,
) -> None:
    """Place the lower border of a goal `wide` mm wide, whose lower corners are seen at left and right, on the floor.

    If the feet are `wide` apart, give or take a quarter, the middle of the border is between them. If the picture cuts the
    goal off at one side, and at least a quarter of the width is seen, the middle is half of `wide` away from the foot that
    is seen. Otherwise something hides a part of it, and only the nearer foot tells how deep it stands; of two ends of which
    one is known to be `hidden`, the other, and half of `wide` beside it is the middle, as from the front: a turn by 25 degrees
    moves that by a tenth. Columns and rows are in 1/16 px from the principal point.
    """
    at = number * OBJECT_WORDS
    left_z = depth_by_floor(geometry, left_row, 0)
    right_z = depth_by_floor(geometry, right_row, 0)
    if left_z == 0 or right_z == 0:
        return
    left_x = beside_mm(geometry, left_z, left)
    left_y = beside_mm(geometry, left_z, left_row)
    right_x = beside_mm(geometry, right_z, right)
    right_y = beside_mm(geometry, right_z, right_row)
    apart = distance_of(right_x - left_x, right_y - left_y, right_z - left_z)
    off = 4 * apart > 5 * wide or 4 * apart < wide or (cut_left == cut_right and 4 * apart < 3 * wide)
    if off or hidden != 0:
        if hidden == RIGHT_HIDDEN or (hidden != LEFT_HIDDEN and left_z <= right_z):
            stand_at(geometry, left_z, left + right >> 1, left_row, objects, number)
        else:
            stand_at(geometry, right_z, left + right >> 1, right_row, objects, number)
        if hidden == RIGHT_HIDDEN:
            objects[at + OBJECT_X] = left_x + (wide >> 1)
        elif hidden == LEFT_HIDDEN:
            objects[at + OBJECT_X] = right_x - (wide >> 1)
        return
    # position of the middle from the left corner, as a part of the way to the right one
    part = apart
    if cut_left < cut_right:
        part = wide
    elif cut_left > cut_right:
        part = 2 * apart - wide
    objects[at + OBJECT_X] = on_the_way(left_x, right_x, part, 2 * apart)
    objects[at + OBJECT_Y] = on_the_way(left_y, right_y, part, 2 * apart)
    objects[at + OBJECT_Z] = on_the_way(left_z, right_z, part, 2 * apart)


@kernel
def go_inside(geometry: i32[:], further: i32, objects: i16[:], number: i32) -> None:
    """Move an object on the floor `further` mm away over it: from the nearest point of a box towards its middle."""
    at = number * OBJECT_WORDS
    depth = i32(objects[at + OBJECT_Z])
    objects[at + OBJECT_X] = objects[at + OBJECT_X] * (depth + further) // max(depth, 1)
    objects[at + OBJECT_Y] = objects[at + OBJECT_Y] - (further * geometry[GEOMETRY_SINE] >> SINE_BITS)
    objects[at + OBJECT_Z] = depth + (further * geometry[GEOMETRY_COSINE] >> SINE_BITS)


@kernel
def see_rectangle(
    blob_data: u32[:],
    blob: i32,
    models: i32[:],
    model: i32,
    rectangles: i16[:],
    lines: i16[:],
    tests: i32,
    geometry: i32[:],
    refined: i32,
    seen: i16[:],
    place: i32,
    width: i32,
    height: i32,
) -> None:
    """Set the place of a rectangle's centre: by the floor below its bottom, or else the direction of its blob's middle.

    For a box, it is a quarter of width and depth together behind what is seen there, until its upright edges tell (`box_places.py`).

    The floor tells only if the blob has the dimension of the model and is seen down to its bottom. The centre of a goal is
    that of its mouth if `refined`.
    """
    at = place * OBJECT_WORDS
    across = blob_data[blob * BLOB_WORDS + ACROSS]
    down = blob_data[blob * BLOB_WORDS + DOWN]
    column = i32(seen[at + OBJECT_IMAGE_X])
    rectangle = i32(seen[at + OBJECT_OUTLINE])
    middle_x = principal(width) + geometry[GEOMETRY_SHIFT_X]
    middle_y = principal(height) + geometry[GEOMETRY_SHIFT_Y]
    row = bottom_row(down, rectangles, rectangle, lines, column) - middle_y
    depth = depth_by_floor(geometry, row, models[model + MODEL_FLOOR])
    if depth == 0 or tests & DIMENSION_TEST == 0 or is_cut(down, height) != 0:
        place_object(geometry, seen, place, 0, width, height)
        return
    stand_at(geometry, depth, column - middle_x, row, seen, place)
    if refined != 0 and models[model + MODEL_SHAPE] == GOAL:
        left = SUBPIXELS * i32(across & 0xFFFF) - HALF_PIXEL
        right = SUBPIXELS * i32(across >> 16) + HALF_PIXEL
        left_down = down
        right_down = down
        hidden: i32 = 0
        if rectangle != NO_OUTLINE:
            left_down = rows_at(rectangles, rectangle, RECTANGLE_LEFT_ROWS)
            right_down = rows_at(rectangles, rectangle, RECTANGLE_RIGHT_ROWS)
            hidden = rectangles[rectangle * RECTANGLE_WORDS + RECTANGLE_HIDDEN]
        cut_left = is_cut_before(across)
        cut_right = is_cut_behind(across, width)
        left_row = (
            foot_row(left_down, rectangles, rectangle, RECTANGLE_LEFT_FOOT, lines, left, cut_left) - middle_y
        )
        right_row = (
            foot_row(right_down, rectangles, rectangle, RECTANGLE_RIGHT_FOOT, lines, right, cut_right)
            - middle_y
        )
        wide = models[model + MODEL_WIDTH]
        left = left - middle_x
        right = right - middle_x
        stand_between_feet(
            geometry, wide, left, left_row, right, right_row, cut_left, cut_right, hidden, seen, place
        )
    if models[model + MODEL_SHAPE] == BOX:
        go_inside(geometry, models[model + MODEL_WIDTH] + models[model + MODEL_DEPTH] >> 2, seen, place)
    lift(geometry, models, model, row, seen, place)
