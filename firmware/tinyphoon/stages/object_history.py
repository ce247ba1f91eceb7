"""The object history: everything seen in the last frames, each object once (T §5.2.6).

An object seen now replaces the nearest earlier one of its model. Objects are compared by their bearing, which is always
known. There is only one goal of a model, so a goal seen now replaces the earlier one however far apart they are. If a
frame has several, the most accurate one stays [ours]: the cameras may see different parts of the goal, and other things
of its colour may look like one. An object that is no longer seen stays with its age until it is too old, and its image
moves when the area of interest does.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, i16, i32, kernel
from tinyphoon.areas import Area
from tinyphoon.stages.object_tests import is_goal
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.objects import (
    NO_MODEL,
    OBJECT_ACCURACY,
    OBJECT_AGE,
    OBJECT_EXTENT,
    OBJECT_IMAGE_X,
    OBJECT_IMAGE_Y,
    OBJECT_MODEL,
    OBJECT_WIDTH,
    OBJECT_WORDS,
    OBJECT_X,
    OBJECT_Y,
    OBJECT_Z,
    copy_object,
)

BEARING_BITS = 8
NOWHERE = -1

# `history_area`: the origin of the images in the history.
AREA_X = 0  # px
AREA_Y = 1
AREA_HALVINGS = 2  # of the pictures' size
AREA_WORDS = 3


@kernel
def bearing(aside: i32, depth: i32) -> i32:
    """Return the tangent of a place's angle from the axis of the camera, in 1/256."""
    return (aside << BEARING_BITS) // max(depth, 1)


@kernel
def apart(one: i16[:], number: i32, other: i16[:], to: i32) -> i32:
    """Return how far apart two objects are seen, in 1/256 of the focal length, across and down together."""
    at = number * OBJECT_WORDS
    there = to * OBJECT_WORDS
    across = bearing(i32(one[at + OBJECT_X]), i32(one[at + OBJECT_Z]))
    down = bearing(i32(one[at + OBJECT_Y]), i32(one[at + OBJECT_Z]))
    across = across - bearing(i32(other[there + OBJECT_X]), i32(other[there + OBJECT_Z]))
    down = down - bearing(i32(other[there + OBJECT_Y]), i32(other[there + OBJECT_Z]))
    return abs(across) + abs(down)


@kernel
def age_objects(objects: i16[:], age_max: i32) -> None:
    """Begin a frame: all objects become a frame older, and those older than `age_max` are forgotten."""
    for at in range(0, len(objects), OBJECT_WORDS):
        if objects[at + OBJECT_MODEL] != NO_MODEL:
            objects[at + OBJECT_AGE] = objects[at + OBJECT_AGE] + 1
            if objects[at + OBJECT_AGE] > age_max:
                objects[at + OBJECT_MODEL] = NO_MODEL


@kernel
def record_for(objects: i16[:], seen: i16[:], number: i32, apart_max: i32) -> i32:
    """Return the record for an object that is seen: its earlier one, a free one, or the oldest one's.

    NOWHERE if all records are of this frame.
    """
    before: i32 = NOWHERE
    free: i32 = NOWHERE
    oldest: i32 = NOWHERE
    nearest = apart_max + 1
    age: i32 = 0
    for record in range(len(objects) // OBJECT_WORDS):
        at = record * OBJECT_WORDS
        if objects[at + OBJECT_MODEL] == NO_MODEL:
            if free == NOWHERE:
                free = record
        elif objects[at + OBJECT_AGE] > 0:
            if objects[at + OBJECT_AGE] > age:
                age = i32(objects[at + OBJECT_AGE])
                oldest = record
            if objects[at + OBJECT_MODEL] == seen[number * OBJECT_WORDS + OBJECT_MODEL]:
                gap = apart(seen, number, objects, record)
                if gap < nearest:
                    nearest = gap
                    before = record
    if before != NOWHERE:
        return before
    if free != NOWHERE:
        return free
    return oldest


@kernel
def only_record(objects: i16[:], model: i32) -> i32:
    """Return the record of model number `model`, of which there is only one thing, or NOWHERE."""
    for record in range(len(objects) // OBJECT_WORDS):
        if objects[record * OBJECT_WORDS + OBJECT_MODEL] == model:
            return record
    return NOWHERE


@kernel
def remember_objects(objects: i16[:], seen: i16[:], models: i32[:], apart_max: i32) -> i32:
    """Take the objects that are seen into the history; return how many found no record.

    Of a model's goals in this frame the most accurate stays, of equal ones the first; the others are not lost.
    """
    lost: i32 = 0
    for number in range(len(seen) // OBJECT_WORDS):
        at = number * OBJECT_WORDS
        model = i32(seen[at + OBJECT_MODEL])
        if model != NO_MODEL:
            only: i32 = NOWHERE
            if is_goal(models, model) != 0:
                only = only_record(objects, model)
            to = only * OBJECT_WORDS
            if only == NOWHERE:
                record = record_for(objects, seen, number, apart_max)
                if record == NOWHERE:
                    lost = lost + 1
                else:
                    copy_object(seen, number, objects, record)
            elif objects[to + OBJECT_AGE] > 0 or objects[to + OBJECT_ACCURACY] < seen[at + OBJECT_ACCURACY]:
                copy_object(seen, number, objects, only)
    return lost


@kernel
def rescaled(length: i32, before: i32, now: i32) -> i32:
    """Convert a length in pictures that were halved `before` times to those halved `now` times."""
    return length << before >> now


@kernel
def move_images(objects: i16[:], area: i32[:], x: i32, y: i32, halvings: i32) -> None:
    """Move the images of all objects to another area, whose corner is (x, y), and store that in `area`.

    Do nothing if the area is the same.
    """
    before = area[AREA_HALVINGS]
    if area[AREA_X] == x and area[AREA_Y] == y and before == halvings:
        return
    for at in range(0, len(objects), OBJECT_WORDS):
        column = rescaled(objects[at + OBJECT_IMAGE_X] + SUBPIXELS * area[AREA_X], before, halvings)
        row = rescaled(objects[at + OBJECT_IMAGE_Y] + SUBPIXELS * area[AREA_Y], before, halvings)
        objects[at + OBJECT_IMAGE_X] = column - SUBPIXELS * x
        objects[at + OBJECT_IMAGE_Y] = row - SUBPIXELS * y
        for word in range(OBJECT_WIDTH, OBJECT_EXTENT + 1):
            objects[at + word] = rescaled(i32(objects[at + word]), before, halvings)
    area[AREA_X] = x
    area[AREA_Y] = y
    area[AREA_HALVINGS] = halvings


def follow_area(core: Core, area: Area, halvings: int) -> Generator[Any, Any, None]:
    """Move the images of the history to the area seen now, in pictures that were halved `halvings` times."""
    corner = area.x, area.y, halvings
    yield core.run(move_images, core.array("objects"), core.array("history_area"), *corner)
