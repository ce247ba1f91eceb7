"""The second camera: an object that both see is more certain, and better placed (T §5.2.6).

The thesis takes the mean of what the cameras measure. [ours] is `refined`: where both have found the shape, the disparity
of its two images measures the depth once more. Of two depths the one counts more that is measured by more pixels: an error
of a pixel is then a smaller part of it, so each has the weight of its pixels squared.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel
from firmware.geometry import GEOMETRY_BASELINE, MICROMETRES, depth_mm
from firmware.stages.object_places import HALF_PIXEL
from firmware.stores.lines import SUBPIXELS
from firmware.stores.objects import (
    BY_DISPARITY,
    NO_MODEL,
    OBJECT_ACCURACY,
    OBJECT_CAMERAS,
    OBJECT_EXTENT,
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
MOST_PIXELS = 128  # squared, times a depth of 16 bits and the two weights of a sum, it stays in 32 bits


@kernel
def baseline_mm(geometry: i32[:]) -> i32:
    """Return how far the right camera is from the left one, in mm, rounded."""
    return (geometry[GEOMETRY_BASELINE] + MICROMETRES // 2) // MICROMETRES


@kernel
def mismatch(left: i16[:], one: i32, right: i16[:], other: i32, row_range: i32, disparity_max: i32) -> i32:
    """Return how unlike an object in both pictures is, in 1/16 px of row and width; NOBODY if it cannot be the same.

    It must be of one model, at most `row_range` from its epipolar row, and farther left in the right picture by at most
    `disparity_max`; but `row_range` more or less is no reason.
    """
    at = one * OBJECT_WORDS
    to = other * OBJECT_WORDS
    if left[at + OBJECT_MODEL] != right[to + OBJECT_MODEL]:
        return NOBODY
    rows = abs(left[at + OBJECT_IMAGE_Y] - right[to + OBJECT_IMAGE_Y])
    disparity = left[at + OBJECT_IMAGE_X] - right[to + OBJECT_IMAGE_X]
    if rows > row_range or disparity < -row_range or disparity > disparity_max:
        return NOBODY
    return rows + abs(left[at + OBJECT_WIDTH] - right[to + OBJECT_WIDTH])


@kernel
def partner_of(left: i16[:], one: i32, right: i16[:], row_range: i32, disparity_max: i32) -> i32:
    """Return the object of the right camera that is most like one of the left camera, or NOBODY; of equal ones the first."""
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
    """Move the place of an object from the frame of the right camera to that of the left one. A direction stays."""
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
def refine_place(geometry: i32[:], left: i16[:], one: i32, disparity: i32) -> None:
    """Move an object along the way to it, to where its disparity in 1/16 px and its own measure together have it.

    Not if one of them says twice what the other does: then something else is wrong.
    """
    at = one * OBJECT_WORDS
    depth = i32(left[at + OBJECT_Z])
    by_disparity = depth_mm(geometry, disparity)
    if left[at + OBJECT_MEASURES] == 0 or by_disparity == 0:
        return
    if depth > 2 * by_disparity or by_disparity > 2 * depth:
        return
    own = weight_of(i32(left[at + OBJECT_EXTENT]))
    better = weighted(depth, own, by_disparity, weight_of(disparity))
    left[at + OBJECT_X] = (left[at + OBJECT_X] * better + (depth >> 1)) // depth
    left[at + OBJECT_Y] = (left[at + OBJECT_Y] * better + (depth >> 1)) // depth
    left[at + OBJECT_Z] = better
    left[at + OBJECT_MEASURES] = left[at + OBJECT_MEASURES] | BY_DISPARITY


@kernel
def verify_objects(
    geometry: i32[:],
    left: i16[:],
    right: i16[:],
    row_range: i32,
    disparity_max: i32,
    weight: i32,
    refined: i32,
) -> i32:
    """Make one object of each pair that both cameras see, in `left`; returns how many pairs there are.

    The other ones of the right camera stay in `right`. All are in the frame of the left camera then. A verified object
    is as accurate as the better of the two, and `weight` more. Lengths in 1/16 px.
    """
    pairs: i32 = 0
    for other in range(len(right) // OBJECT_WORDS):
        shift_right_object(geometry, right, other)
    for one in range(len(left) // OBJECT_WORDS):
        at = one * OBJECT_WORDS
        if left[at + OBJECT_MODEL] != NO_MODEL:
            other = partner_of(left, one, right, row_range, disparity_max)
            if other != NOBODY:
                to = other * OBJECT_WORDS
                pairs = pairs + 1
                average_places(left, one, right, other)
                shape_in_both = left[at + OBJECT_TESTS] & right[to + OBJECT_TESTS] & SIZE_TEST
                if refined != 0 and shape_in_both != 0:
                    disparity = left[at + OBJECT_IMAGE_X] - right[to + OBJECT_IMAGE_X]
                    refine_place(geometry, left, one, disparity)
                accuracy = max(left[at + OBJECT_ACCURACY], right[to + OBJECT_ACCURACY])
                left[at + OBJECT_ACCURACY] = min(accuracy + weight, LARGEST_ACCURACY)
                left[at + OBJECT_TESTS] = left[at + OBJECT_TESTS] | right[to + OBJECT_TESTS] | VERIFIED
                left[at + OBJECT_CAMERAS] = SEEN_LEFT | SEEN_RIGHT
                right[to + OBJECT_MODEL] = NO_MODEL
    return pairs
