"""The tests by which a blob becomes an object of a model (T §5.2.6, Figure 5.7).

They come in order: colour, dimension, area, centre of the shape, size of the shape. The first failure ends the tests.
Each passed test adds its weight to the accuracy. The handling of a partly hidden ball is [ours]: its blob does not have
the form of a ball, but the circle of the remaining outline may still tell its size.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u32
from tinyphoon.geometry import GEOMETRY_FOCAL, GEOMETRY_SHIFT_Y
from tinyphoon.stages.object_places import HALF_PIXEL, depth_by_floor, principal
from tinyphoon.stores.blobs import (
    ACROSS,
    BLOB_WORDS,
    COLOURS,
    DOWN,
    PIXELS,
    extent_of,
    is_cut,
    is_cut_before,
    is_cut_behind,
)
from tinyphoon.stores.circles import (
    CENTRE_PASSED,
    CIRCLE_ARC,
    CIRCLE_RADIUS,
    CIRCLE_TESTS,
    CIRCLE_WORDS,
    CIRCLE_Y,
    RADIUS_PASSED,
    lies_within,
)
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.objects import (
    AREA_TEST,
    CENTRE_TEST,
    COLOUR_TEST,
    DIMENSION_TEST,
    NO_OUTLINE,
    SIZE_TEST,
)
from tinyphoon.stores.rectangles import (
    NO_LINE,
    RECTANGLE_BOTTOM,
    RECTANGLE_LEFT,
    RECTANGLE_RIGHT,
    RECTANGLE_WORDS,
)
from tinyphoon.strategy.models import (
    ASPECT_UNITS,
    MODEL_ASPECT_MAX,
    MODEL_ASPECT_MIN,
    MODEL_COLOURS,
    MODEL_FLOOR,
    MODEL_HEIGHT,
    MODEL_NUMBER,
    MODEL_SHAPE,
    MODEL_WIDTH,
    MODEL_WORDS,
    Shape,
)

BALL = int(Shape.BALL)  # kernels know only integers
GOAL = int(Shape.GOAL)
BOX = int(Shape.BOX)

# `object_limits`: the thresholds of the stage for kernels. The weights are in the order of the tests' bits.
TESTS = 6
SHORTEST_SIDE = 6  # px
SIZE_RANGE = 7  # 1/16
BALL_AREA = 8  # 1/256
RECTANGLE_AREA = 9  # 1/256
REFINED = 10
HIDDEN_ARC = 11  # 1/256
AREA_OF_CIRCLE = 12
LIMIT_WORDS = 13

SIZE_UNITS = 16

AREA_BITS = 8
DISC_AREA = 201  # of its square: pi/4 (T §2.2.2)


@kernel
def shape_of(models: i32[:], number: i32) -> i32:
    """Return the shape of model number `number`, or 0 if there is none."""
    for at in range(0, len(models), MODEL_WORDS):
        if models[at + MODEL_NUMBER] == number:
            return models[at + MODEL_SHAPE]
    return 0


@kernel
def is_goal(models: i32[:], number: i32) -> i32:
    """Return 1 if model number `number` is a goal; else 0."""
    return 1 if shape_of(models, number) == GOAL else 0


@kernel
def has_form(across: u32, down: u32, aspect_min: i32, aspect_max: i32, width: i32, height: i32) -> i32:
    """Return 1 if a blob is neither too narrow nor too flat for a model; else 0.

    A blob that leaves the picture of `width` by `height` is wider, or higher, than it looks.
    """
    wide = extent_of(across)
    high = extent_of(down)
    if ASPECT_UNITS * wide < aspect_min * high and is_cut(across, width) == 0:
        return 0
    if ASPECT_UNITS * wide > aspect_max * high and is_cut(down, height) == 0:
        return 0
    return 1


@kernel
def has_size(extent: i32, row: i32, geometry: i32[:], height_mm: i32, floor_mm: i32, size_range: i32) -> i32:
    """Return 1 if something `extent` high is about as high as a model is there, `floor_mm` above the floor; else 0.

    That border is in `row`, counted from the principal point; both are in 1/16 px. About means within a factor of
    `size_range` sixteenths.
    """
    looks = extent * depth_by_floor(geometry, row, floor_mm) // SUBPIXELS
    model = geometry[GEOMETRY_FOCAL] * height_mm // SUBPIXELS
    if SIZE_UNITS * looks > size_range * model or SIZE_UNITS * model > size_range * looks:
        return 0
    return 1


@kernel
def row_of(pixel: i32, geometry: i32[:], height: i32) -> i32:
    """Return how far below the principal point a pixel's lower border is, in 1/16 px."""
    return SUBPIXELS * pixel + HALF_PIXEL - principal(height) - geometry[GEOMETRY_SHIFT_Y]


@kernel
def cut_size_passes(
    across: u32,
    down: u32,
    models: i32[:],
    model: i32,
    geometry: i32[:],
    size_range: i32,
    width: i32,
    height: i32,
) -> i32:
    """Return 1 if a blob that leaves the picture above or below has a possible size for its model; else 0.

    Its lower border tells how deep it stands, or its upper one if only that is in the picture. The part seen is not
    larger than the model there, and not narrower than one of its height may be. In a corner of the picture, or with
    neither border, too little is known of it.
    """
    above_mm = models[model + MODEL_FLOOR]
    height_mm = models[model + MODEL_HEIGHT]
    row = row_of(i32(down >> 16), geometry, height)
    if is_cut(across, width) != 0:
        return 0
    if is_cut_behind(down, height) != 0:
        if is_cut_before(down) != 0:
            return 0
        above_mm = above_mm + height_mm
        row = row_of(i32(down & 0xFFFF) - 1, geometry, height)
    depth = depth_by_floor(geometry, row, above_mm)
    wide = extent_of(across) * depth
    unit = geometry[GEOMETRY_FOCAL] // SUBPIXELS
    narrowest_mm = min(
        height_mm * models[model + MODEL_ASPECT_MIN] // ASPECT_UNITS, models[model + MODEL_WIDTH]
    )
    least = (
        SIZE_UNITS * unit * narrowest_mm + size_range - 1
    ) // size_range  # so that no product exceeds 32 bits
    if depth == 0 or wide < least:
        return 0
    if SIZE_UNITS * wide > size_range * unit * models[model + MODEL_WIDTH]:
        return 0
    return 1 if SIZE_UNITS * extent_of(down) * depth <= size_range * unit * height_mm else 0


@kernel
def dimension_passes(
    blob_data: u32[:],
    blob: i32,
    models: i32[:],
    model: i32,
    geometry: i32[:],
    limits: i32[:],
    width: i32,
    height: i32,
) -> i32:
    """Return 1 if a blob is not too small, misshapen, or standing where its model would differ in size; else 0."""
    across = blob_data[blob * BLOB_WORDS + ACROSS]
    down = blob_data[blob * BLOB_WORDS + DOWN]
    if min(extent_of(across), extent_of(down)) < limits[SHORTEST_SIDE]:
        return 0
    aspect_min = models[model + MODEL_ASPECT_MIN]
    aspect_max = models[model + MODEL_ASPECT_MAX]
    if has_form(across, down, aspect_min, aspect_max, width, height) == 0:
        return 0
    if is_cut(down, height) != 0:
        return cut_size_passes(across, down, models, model, geometry, limits[SIZE_RANGE], width, height)
    row = row_of(i32(down >> 16), geometry, height)
    height_mm = models[model + MODEL_HEIGHT]
    floor_mm = models[model + MODEL_FLOOR]
    return has_size(SUBPIXELS * extent_of(down), row, geometry, height_mm, floor_mm, limits[SIZE_RANGE])


@kernel
def area_passes(blob_data: u32[:], blob: i32, shape: i32, ball_area: i32, rectangle_area: i32) -> i32:
    """Return 1 if a blob fills its rectangle as its model does; else 0.

    A disc must be within `ball_area` of pi/4; a rectangle must fill `rectangle_area` of it.
    """
    at = blob * BLOB_WORDS
    box = extent_of(blob_data[at + ACROSS]) * extent_of(blob_data[at + DOWN])
    share = (i32(blob_data[at + PIXELS]) << AREA_BITS) // box
    if shape == BALL:
        return 1 if abs(share - DISC_AREA) <= ball_area else 0
    return 1 if share >= rectangle_area else 0


@kernel
def circle_area_passes(blob_data: u32[:], blob: i32, circles: i16[:], circle: i32, ball_area: i32) -> i32:
    """Return 1 if a blob has as many pixels as its circle, P_a of T Eq. 2.13, to `ball_area` 256ths; 0 of no radius."""
    if circle == NO_OUTLINE:
        return 0
    diameter = 2 * circles[circle * CIRCLE_WORDS + CIRCLE_RADIUS]
    square = diameter * diameter >> 8  # of the diameter, px
    area = square * DISC_AREA // i32(blob_data[blob * BLOB_WORDS + PIXELS])
    return 1 if abs(area - (1 << AREA_BITS)) <= ball_area else 0


@kernel
def circle_tests(blob_data: u32[:], blob: i32, circles: i16[:], circle: i32) -> i32:
    """Return which tests of its shape a ball passes. If the blob extends beyond its circle, the size test fails."""
    if circle == NO_OUTLINE:
        return 0
    passed = circles[circle * CIRCLE_WORDS + CIRCLE_TESTS]
    if passed & CENTRE_PASSED == 0:
        return 0
    if passed & RADIUS_PASSED == 0 or lies_within(blob_data, blob, circles, circle * CIRCLE_WORDS) == 0:
        return CENTRE_TEST
    return CENTRE_TEST | SIZE_TEST


@kernel
def hidden_ball_tests(
    blob_data: u32[:],
    blob: i32,
    models: i32[:],
    model: i32,
    circles: i16[:],
    circle: i32,
    geometry: i32[:],
    limits: i32[:],
    height: i32,
) -> i32:
    """Return the tests of its shape if a blob is part of a ball whose circle is seen well enough to be trusted; else 0.

    The circle has passed its own tests, has outline on a good part of it, and stands on the floor where a ball of the
    model looks as large.
    """
    at = circle * CIRCLE_WORDS
    if limits[HIDDEN_ARC] == 0 or circle_tests(blob_data, blob, circles, circle) & SIZE_TEST == 0:
        return 0
    if circles[at + CIRCLE_ARC] < limits[HIDDEN_ARC]:
        return 0
    diameter = 2 * circles[at + CIRCLE_RADIUS]
    if diameter < SUBPIXELS * limits[SHORTEST_SIDE]:
        return 0
    row = (
        circles[at + CIRCLE_Y] + circles[at + CIRCLE_RADIUS] - principal(height) - geometry[GEOMETRY_SHIFT_Y]
    )
    height_mm = models[model + MODEL_HEIGHT]
    floor_mm = models[model + MODEL_FLOOR]
    if has_size(diameter, row, geometry, height_mm, floor_mm, limits[SIZE_RANGE]) == 0:
        return 0
    return CENTRE_TEST | SIZE_TEST


@kernel
def rectangle_tests(rectangles: i16[:], rectangle: i32) -> i32:
    """Return which tests of its shape a rectangle passes: its bottom line, and its left and right lines."""
    if rectangle == NO_OUTLINE:
        return 0
    at = rectangle * RECTANGLE_WORDS
    if rectangles[at + RECTANGLE_BOTTOM] == NO_LINE:
        return 0
    if rectangles[at + RECTANGLE_LEFT] == NO_LINE or rectangles[at + RECTANGLE_RIGHT] == NO_LINE:
        return CENTRE_TEST
    return CENTRE_TEST | SIZE_TEST


@kernel
def tests_passed(
    blob_data: u32[:],
    blob: i32,
    models: i32[:],
    model: i32,
    circles: i16[:],
    rectangles: i16[:],
    outline: i32,
    geometry: i32[:],
    limits: i32[:],
    width: i32,
    height: i32,
) -> i32:
    """Return the tests that a blob passes for the model whose words begin at `model`; 0 if not even its colour fits.

    `outline` is the number of its circle or its rectangle, depending on the model's shape.
    """
    if blob_data[blob * BLOB_WORDS + COLOURS] & u32(models[model + MODEL_COLOURS]) == 0:
        return 0
    shape = models[model + MODEL_SHAPE]
    passed = COLOUR_TEST
    if dimension_passes(blob_data, blob, models, model, geometry, limits, width, height) != 0:
        passed = COLOUR_TEST | DIMENSION_TEST
        if shape == BALL and limits[AREA_OF_CIRCLE] != 0:
            has_area = circle_area_passes(blob_data, blob, circles, outline, limits[BALL_AREA])
        else:
            has_area = area_passes(blob_data, blob, shape, limits[BALL_AREA], limits[RECTANGLE_AREA])
        if has_area != 0:
            passed = COLOUR_TEST | DIMENSION_TEST | AREA_TEST
    if shape == BALL:
        if passed & AREA_TEST != 0:
            return passed | circle_tests(blob_data, blob, circles, outline)
        return passed | hidden_ball_tests(
            blob_data, blob, models, model, circles, outline, geometry, limits, height
        )
    if passed & AREA_TEST != 0:
        return passed | rectangle_tests(rectangles, outline)
    return passed


@kernel
def accuracy_of(tests: i32, limits: i32[:]) -> i32:
    """Return the accuracy of an object: the sum of the weights of its passed tests."""
    accuracy: i32 = 0
    for test in range(TESTS):
        if tests >> test & 1:
            accuracy = accuracy + limits[test]
    return accuracy
