"""What one camera can tell of objects by itself: the best model for each blob, and its place."""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u8, u32
from tinyphoon.stages.object_places import (
    HALF_PIXEL,
    depth_by_size,
    depth_of_sphere,
    place_object,
    see_sphere,
)
from tinyphoon.stages.object_tests import (
    BALL,
    REFINED,
    accuracy_of,
    extent_of,
    tests_passed,
)
from tinyphoon.stages.rectangle_places import see_rectangle
from tinyphoon.stores.blobs import ACROSS, BLOB_WORDS, DOWN
from tinyphoon.stores.circles import CIRCLE_BLOB, CIRCLE_RADIUS, CIRCLE_WORDS, CIRCLE_X, CIRCLE_Y
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.objects import (
    BY_SIZE,
    NO_MODEL,
    NO_OUTLINE,
    OBJECT_ACCURACY,
    OBJECT_AGE,
    OBJECT_CAMERAS,
    OBJECT_EXTENT,
    OBJECT_HEIGHT,
    OBJECT_IMAGE_X,
    OBJECT_IMAGE_Y,
    OBJECT_MEASURES,
    OBJECT_MODEL,
    OBJECT_OUTLINE,
    OBJECT_TESTS,
    OBJECT_WIDTH,
    OBJECT_WORDS,
    SIZE_TEST,
    free_objects,
)
from tinyphoon.stores.rectangles import RECTANGLE_BLOB, RECTANGLE_WORDS
from tinyphoon.strategy.models import (
    MODEL_NUMBER,
    MODEL_SHAPE,
    MODEL_WIDTH,
    MODEL_WORDS,
)

MODEL_SHIFT = 8
TESTS_MASK = (1 << MODEL_SHIFT) - 1


@kernel
def outline_of(outlines: i16[:], count: i32, words: i32, blob_word: i32, blob: i32) -> i32:
    """Return which of `count` records of `words` words is the outline of a blob, or NO_OUTLINE."""
    for number in range(count):
        if outlines[number * words + blob_word] == blob:
            return number
    return NO_OUTLINE


@kernel
def see_blob(blob_data: u32[:], blob: i32, seen: i16[:], place: i32) -> None:
    """Set the place and the size of a blob in the picture: middle, width and height."""
    source = blob * BLOB_WORDS
    at = place * OBJECT_WORDS
    across = blob_data[source + ACROSS]
    down = blob_data[source + DOWN]
    seen[at + OBJECT_IMAGE_X] = HALF_PIXEL * (i32(across & 0xFFFF) + i32(across >> 16))
    seen[at + OBJECT_IMAGE_Y] = HALF_PIXEL * (i32(down & 0xFFFF) + i32(down >> 16))
    seen[at + OBJECT_WIDTH] = SUBPIXELS * extent_of(across)
    seen[at + OBJECT_HEIGHT] = SUBPIXELS * extent_of(down)


@kernel
def see_ball(
    models: i32[:],
    model: i32,
    circles: i16[:],
    tests: i32,
    geometry: i32[:],
    refined: i32,
    seen: i16[:],
    place: i32,
    width: i32,
    height: i32,
) -> None:
    """Set the place of a ball: by its circle's size if it passed all tests, else the direction of its circle's centre.

    A circle without a found centre has that of its blob's mass.
    """
    at = place * OBJECT_WORDS
    depth: i32 = 0
    if seen[at + OBJECT_OUTLINE] != NO_OUTLINE:
        circle = seen[at + OBJECT_OUTLINE] * CIRCLE_WORDS
        seen[at + OBJECT_IMAGE_X] = circles[circle + CIRCLE_X]
        seen[at + OBJECT_IMAGE_Y] = circles[circle + CIRCLE_Y]
        if tests & SIZE_TEST:
            size = 2 * circles[circle + CIRCLE_RADIUS]
            seen[at + OBJECT_WIDTH] = size
            seen[at + OBJECT_HEIGHT] = size
            if refined != 0:
                size = see_sphere(geometry, seen, place, size, width, height)
            depth = depth_by_size(geometry, models[model + MODEL_WIDTH], size)
            if depth != 0:
                if refined:
                    depth = depth_of_sphere(depth, models[model + MODEL_WIDTH] >> 1)
                seen[at + OBJECT_MEASURES] = BY_SIZE
                seen[at + OBJECT_EXTENT] = size
    place_object(geometry, seen, place, depth, width, height)


@kernel
def best_model(
    blob_data: u32[:],
    blob: i32,
    models: i32[:],
    circles: i16[:],
    circle: i32,
    rectangles: i16[:],
    rectangle: i32,
    geometry: i32[:],
    limits: i32[:],
    width: i32,
    height: i32,
) -> i32:
    """Return the tests that a blob passes for its best model, and above bit 8 where the model's words begin.

    Of equal ones the first is taken: models are in the order of importance.
    """
    best: i32 = 0
    accuracy: i32 = -1
    for model in range(0, len(models), MODEL_WORDS):
        if models[model + MODEL_NUMBER] != NO_MODEL:
            outline = rectangle
            if models[model + MODEL_SHAPE] == BALL:
                outline = circle
            tests = tests_passed(
                blob_data, blob, models, model, circles, rectangles, outline, geometry, limits, width, height
            )
            if tests != 0 and accuracy_of(tests, limits) > accuracy:
                accuracy = accuracy_of(tests, limits)
                best = tests | model << MODEL_SHIFT
    return best


@kernel
def place_for(seen: i16[:], found: i32, accuracy: i32) -> i32:
    """Return the record for one more object when `found` were found before: a free one, or the least accurate one.

    Return the length of `seen` in records if none is less accurate.
    """
    room = len(seen) // OBJECT_WORDS
    if found < room:
        return found
    weakest = room
    for place in range(room):
        if seen[place * OBJECT_WORDS + OBJECT_ACCURACY] < accuracy:
            accuracy = i32(seen[place * OBJECT_WORDS + OBJECT_ACCURACY])
            weakest = place
    return weakest


@kernel
def see_objects(
    blob_data: u32[:],
    parents: u8[:],
    blobs: i32,
    models: i32[:],
    circles: i16[:],
    circle_count: i32,
    rectangles: i16[:],
    rectangle_count: i32,
    lines: i16[:],
    geometry: i32[:],
    limits: i32[:],
    seen: i16[:],
    camera: i32,
    width: i32,
    height: i32,
) -> i32:
    """Make an object of each blob that has a model and is not part of another, for one camera; return their number.

    When `seen` is full the least accurate ones make way.
    """
    found: i32 = 0
    room = len(seen) // OBJECT_WORDS
    free_objects(seen, 0)
    for blob in range(blobs):
        best: i32 = 0
        circle: i32 = NO_OUTLINE
        rectangle: i32 = NO_OUTLINE
        if parents[blob] == blob:
            circle = outline_of(circles, circle_count, CIRCLE_WORDS, CIRCLE_BLOB, blob)
            rectangle = outline_of(rectangles, rectangle_count, RECTANGLE_WORDS, RECTANGLE_BLOB, blob)
            best = best_model(
                blob_data,
                blob,
                models,
                circles,
                circle,
                rectangles,
                rectangle,
                geometry,
                limits,
                width,
                height,
            )
        if best != 0:
            tests = best & TESTS_MASK
            model = best >> MODEL_SHIFT
            accuracy = accuracy_of(tests, limits)
            place = place_for(seen, found, accuracy)
            found = found + 1
            if place < room:
                at = place * OBJECT_WORDS
                seen[at + OBJECT_MODEL] = models[model + MODEL_NUMBER]
                seen[at + OBJECT_ACCURACY] = accuracy
                seen[at + OBJECT_TESTS] = tests
                seen[at + OBJECT_CAMERAS] = camera
                seen[at + OBJECT_MEASURES] = 0
                seen[at + OBJECT_EXTENT] = 0
                seen[at + OBJECT_AGE] = 0
                see_blob(blob_data, blob, seen, place)
                refined = limits[REFINED]
                if models[model + MODEL_SHAPE] == BALL:
                    seen[at + OBJECT_OUTLINE] = circle
                    see_ball(models, model, circles, tests, geometry, refined, seen, place, width, height)
                else:
                    seen[at + OBJECT_OUTLINE] = rectangle
                    see_rectangle(
                        blob_data,
                        blob,
                        models,
                        model,
                        rectangles,
                        lines,
                        tests,
                        geometry,
                        refined,
                        seen,
                        place,
                        width,
                        height,
                    )
    return found
