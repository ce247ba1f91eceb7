"""The second camera: an object that both see is more certain, and better placed (T §5.2.6).

The thesis takes the mean of both cameras' measurements. [ours] is `refined`: if both have found the circle, the
disparity of its two images measures the depth once more. Of two depths, the one measured by more pixels counts more: an
error of a pixel is then a smaller part of it, so each has the weight of its pixels squared. If they disagree, the thing
does not have the size of its model; then the disparity, which needs no model, places it, and it is less certain.

That is for balls, whose circles have a middle even if they are partly hidden. The middle of a rectangle's image is that
of its visible part, which the border of one picture may cut and that of the other not: it has no disparity. The floor
places it in each picture. If the cameras disagree by more than an eighth, the one counts that passed more tests, unless
the border cuts the image in both: then the tests only tell of what is left, and the nearer place counts, since cutting
or hiding the lower end of a thing only ever moves it up, and the place away.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel
from tinyphoon.geometry import GEOMETRY_BASELINE, MICROMETRES, depth_mm, disparity_at
from tinyphoon.stages.object_places import HALF_PIXEL
from tinyphoon.stores.blobs import BORDER_PX
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.objects import (
    BY_DISPARITY,
    BY_FLOOR,
    BY_SIZE,
    NO_MODEL,
    OBJECT_ACCURACY,
    OBJECT_CAMERAS,
    OBJECT_EXTENT,
    OBJECT_HEIGHT,
    OBJECT_IMAGE_X,
    OBJECT_IMAGE_Y,
    OBJECT_MEASURES,
    OBJECT_MODEL,
    OBJECT_TESTS,
    OBJECT_WIDTH,
    OBJECT_WORDS,
    OBJECT_X,
    OBJECT_Y,
    OBJECT_Z,
    SEEN_LEFT,
    SEEN_RIGHT,
    SIZE_TEST,
    VERIFIED,
)

NOBODY = -1
LARGEST_ACCURACY = 255
MOST_PIXELS = 128  # squared, times a depth of 16 bits and the two weights of a sum, it fits in 32 bits


@kernel
def baseline_mm(geometry: i32[:]) -> i32:
    """Return how far the right camera is from the left one, in mm, rounded."""
    return (geometry[GEOMETRY_BASELINE] + MICROMETRES // 2) // MICROMETRES


@kernel
def mismatch(left: i16[:], one: i32, right: i16[:], other: i32, row_range: i32, disparity_max: i32) -> i32:
    """Return how different an object is in both pictures, in 1/16 px of row and width; NOBODY if it cannot be the same.

    It must have the same model, be at most `row_range` from its epipolar row, and at most `disparity_max` farther left
    in the right picture, give or take `row_range`. If one picture lacks a part above or below, its middle moves by half
    as much: its upper ends count, or its lower ones.
    """
    at = one * OBJECT_WORDS
    to = other * OBJECT_WORDS
    if left[at + OBJECT_MODEL] != right[to + OBJECT_MODEL]:
        return NOBODY
    lacks = abs(left[at + OBJECT_HEIGHT] - right[to + OBJECT_HEIGHT]) >> 1
    rows = max(abs(left[at + OBJECT_IMAGE_Y] - right[to + OBJECT_IMAGE_Y]) - lacks, 0)
    disparity = left[at + OBJECT_IMAGE_X] - right[to + OBJECT_IMAGE_X]
    if rows > row_range or disparity < -row_range or disparity > disparity_max:
        return NOBODY
    return rows + abs(left[at + OBJECT_WIDTH] - right[to + OBJECT_WIDTH])


@kernel
def partner_of(left: i16[:], one: i32, right: i16[:], row_range: i32, disparity_max: i32) -> i32:
    """Return the right camera's object most like one of the left camera, or NOBODY; of equal ones the first."""
    best: i32 = NOBODY
    least: i32 = 0
    for other in range(len(right) // OBJECT_WORDS):
        if right[other * OBJECT_WORDS + OBJECT_MODEL] != NO_MODEL:
            unlike = mismatch(left, one, right, other, row_range, disparity_max)
            if unlike != NOBODY and (best == NOBODY or unlike < least):
                best = other
                least = unlike
    return best


@kernel
def shift_right_object(geometry: i32[:], right: i16[:], other: i32) -> None:
    """Move an object's place from the frame of the right camera to that of the left one. A direction stays."""
    at = other * OBJECT_WORDS
    if right[at + OBJECT_MEASURES] != 0:
        right[at + OBJECT_X] = right[at + OBJECT_X] + baseline_mm(geometry)


@kernel
def average_places(left: i16[:], one: i32, right: i16[:], other: i32) -> None:
    """Place an object where the camera that measures it has it, or in the middle if both do."""
    at = one * OBJECT_WORDS
    to = other * OBJECT_WORDS
    if right[to + OBJECT_MEASURES] == 0:
        return
    for word in range(OBJECT_X, OBJECT_Z + 1):
        if left[at + OBJECT_MEASURES] != 0:
            left[at + word] = left[at + word] + right[to + word] + 1 >> 1
        else:
            left[at + word] = right[to + word]
    extent = i32(right[to + OBJECT_EXTENT])
    if left[at + OBJECT_MEASURES] != 0:
        extent = left[at + OBJECT_EXTENT] + extent + 1 >> 1
    left[at + OBJECT_EXTENT] = extent
    left[at + OBJECT_MEASURES] = left[at + OBJECT_MEASURES] | right[to + OBJECT_MEASURES]


@kernel
def agree_on_floor(left: i16[:], one: i32, right: i16[:], other: i32) -> i32:
    """Return 0 if both cameras measure an object by the floor with depths more than an eighth apart, else 1."""
    at = one * OBJECT_WORDS
    to = other * OBJECT_WORDS
    if left[at + OBJECT_MEASURES] != BY_FLOOR or right[to + OBJECT_MEASURES] != BY_FLOOR:
        return 1
    nearer = min(left[at + OBJECT_Z], right[to + OBJECT_Z])
    return 1 if 8 * abs(left[at + OBJECT_Z] - right[to + OBJECT_Z]) <= nearer else 0


@kernel
def is_cut_aside(objects: i16[:], number: i32, width: i32) -> i32:
    """Return 1 if the left or the right border of a picture `width` pixels wide cuts an object's image; else 0."""
    at = number * OBJECT_WORDS
    half = objects[at + OBJECT_WIDTH] >> 1
    if objects[at + OBJECT_IMAGE_X] - half < SUBPIXELS * BORDER_PX:
        return 1
    return 1 if objects[at + OBJECT_IMAGE_X] + half > SUBPIXELS * (width - 1 - BORDER_PX) else 0


@kernel
def take_better(left: i16[:], one: i32, right: i16[:], other: i32, width: i32) -> None:
    """Place an object where the more reliable camera has it, of two that disagree."""
    at = one * OBJECT_WORDS
    to = other * OBJECT_WORDS
    better = right[to + OBJECT_ACCURACY] - left[at + OBJECT_ACCURACY]
    if better == 0 or is_cut_aside(left, one, width) & is_cut_aside(right, other, width) != 0:
        better = left[at + OBJECT_Z] - right[to + OBJECT_Z]
    if better > 0:
        for word in range(OBJECT_X, OBJECT_Z + 1):
            left[at + word] = right[to + word]
        left[at + OBJECT_EXTENT] = right[to + OBJECT_EXTENT]


@kernel
def weight_of(extent: i32) -> i32:
    """Return the weight of a depth that is measured by `extent` 1/16 px; at least 1."""
    pixels = max(min((extent + HALF_PIXEL) // SUBPIXELS, MOST_PIXELS), 1)
    return pixels * pixels


@kernel
def weighted(one: i32, weight: i32, other: i32, other_weight: i32) -> i32:
    """Return the weighted mean of two depths, rounded."""
    total = weight + other_weight
    return (one * weight + other * other_weight + (total >> 1)) // total


@kernel
def move_to(left: i16[:], one: i32, depth: i32) -> None:
    """Move an object along its direction to a depth; it must have one."""
    at = one * OBJECT_WORDS
    before = i32(left[at + OBJECT_Z])
    left[at + OBJECT_X] = (left[at + OBJECT_X] * depth + (before >> 1)) // before
    left[at + OBJECT_Y] = (left[at + OBJECT_Y] * depth + (before >> 1)) // before
    left[at + OBJECT_Z] = depth


@kernel
def refine_place(geometry: i32[:], left: i16[:], one: i32, disparity: i32, disparity_range: i32) -> i32:
    """Move a measured object to its place by disparity and its own measure together; return 1, or 0 if they disagree.

    They do if the disparity is more than `disparity_range` away from that of its depth. Then the disparity alone places
    it, if it corresponds to a depth. Both are in 1/16 px.
    """
    at = one * OBJECT_WORDS
    depth = i32(left[at + OBJECT_Z])
    by_disparity = depth_mm(geometry, disparity)
    if depth <= 0:
        return 0
    if abs(disparity_at(geometry, depth) - disparity) > disparity_range:
        if by_disparity != 0:
            move_to(left, one, by_disparity)
            left[at + OBJECT_MEASURES] = BY_DISPARITY
            left[at + OBJECT_EXTENT] = disparity
        return 0
    if by_disparity != 0:
        own = weight_of(i32(left[at + OBJECT_EXTENT]))
        move_to(left, one, weighted(depth, own, by_disparity, weight_of(disparity)))
        left[at + OBJECT_MEASURES] = left[at + OBJECT_MEASURES] | BY_DISPARITY
    return 1


@kernel
def has_disparity(left: i16[:], one: i32, right: i16[:], other: i32) -> i32:
    """Return 1 if both cameras have found a ball's circle, so that the middles of its images are one point; else 0."""
    shape_in_both = left[one * OBJECT_WORDS + OBJECT_TESTS] & right[other * OBJECT_WORDS + OBJECT_TESTS]
    if shape_in_both & SIZE_TEST == 0:
        return 0
    return left[one * OBJECT_WORDS + OBJECT_MEASURES] & BY_SIZE


@kernel
def unite(
    geometry: i32[:],
    left: i16[:],
    one: i32,
    right: i16[:],
    other: i32,
    disparity_range: i32,
    weight: i32,
    size_weight: i32,
    refined: i32,
    width: i32,
) -> None:
    """Unite an object of the left camera and its partner of the right one, in `left`."""
    at = one * OBJECT_WORDS
    to = other * OBJECT_WORDS
    agree: i32 = 1
    if refined != 0:
        agree = agree_on_floor(left, one, right, other)
    if agree != 0:
        average_places(left, one, right, other)
    else:
        take_better(left, one, right, other, width)
    tests = left[at + OBJECT_TESTS] | right[to + OBJECT_TESTS]
    accuracy = max(left[at + OBJECT_ACCURACY], right[to + OBJECT_ACCURACY])
    if refined != 0 and has_disparity(left, one, right, other) != 0:
        disparity = left[at + OBJECT_IMAGE_X] - right[to + OBJECT_IMAGE_X]
        agree = refine_place(geometry, left, one, disparity, disparity_range)
    if agree != 0:
        left[at + OBJECT_ACCURACY] = min(accuracy + weight, LARGEST_ACCURACY)
        left[at + OBJECT_TESTS] = tests | VERIFIED
    else:
        left[at + OBJECT_ACCURACY] = max(accuracy - size_weight, 0)
        left[at + OBJECT_TESTS] = tests & ~SIZE_TEST
    left[at + OBJECT_CAMERAS] = SEEN_LEFT | SEEN_RIGHT
    right[to + OBJECT_MODEL] = NO_MODEL


@kernel
def verify_objects(
    geometry: i32[:],
    left: i16[:],
    right: i16[:],
    row_range: i32,
    disparity_max: i32,
    disparity_range: i32,
    weight: i32,
    size_weight: i32,
    refined: i32,
    width: i32,
) -> i32:
    """Unite each pair of objects that both cameras see, in `left`; return how many pairs there are.

    The other objects of the right camera stay in `right`. All are in the frame of the left camera then. A verified
    object is as accurate as the better of the two, plus `weight`; one whose disparity or places disagree loses
    `size_weight`. Lengths are in 1/16 px, except the `width` of the pictures in pixels.
    """
    pairs: i32 = 0
    for other in range(len(right) // OBJECT_WORDS):
        shift_right_object(geometry, right, other)
    for one in range(len(left) // OBJECT_WORDS):
        if left[one * OBJECT_WORDS + OBJECT_MODEL] != NO_MODEL:
            partner = partner_of(left, one, right, row_range, disparity_max)
            if partner != NOBODY:
                pairs = pairs + 1
                unite(
                    geometry,
                    left,
                    one,
                    right,
                    partner,
                    disparity_range,
                    weight,
                    size_weight,
                    refined,
                    width,
                )
    return pairs
