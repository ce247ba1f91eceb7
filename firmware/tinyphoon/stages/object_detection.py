"""Object detection (T §5.2.6): what each camera sees by itself, the same from both cameras, and the object history.

The first part runs on both cores, each on its own picture; the rest runs on core A, once core B has left what it sees
in `right_seen`.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Frame, Row, i16, i32, kernel
from tinyphoon.fields import allowed
from tinyphoon.stages.box_places import place_boxes
from tinyphoon.stages.object_history import AREA_WORDS, age_objects, remember_objects
from tinyphoon.stages.object_sight import see_objects
from tinyphoon.stages.object_tests import LIMIT_WORDS
from tinyphoon.stages.object_verification import verify_objects
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.objects import (
    OBJECT_CAPACITY,
    OBJECT_WORDS,
    SEEN_CAPACITY,
    SEEN_LEFT,
    SEEN_RIGHT,
)

LARGEST_ACCURACY = 255


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectThresholds:
    """What makes an object, and how accurate it is.

    `*_weight`: what a passed test adds to the accuracy; together at most 255. `shortest_side`: of a blob in pixels, for the
    dimension test. `size_range`: the factor, in 16ths, by which its height may differ from that of the model at its place.
    `ball_area`: how far the share of its square that a ball fills may be from pi/4, in 256ths. `circle_area`: whether the
    area test is instead that of T Eq. 2.13, which compares with the circle found: then `ball_area` is how far P_a may be
    from 1. `rectangle_area`: the least share of its rectangle that another object fills, in 256ths. `hidden_arc`: the least
    share of its circle that must be seen of a partly hidden ball, in 256ths; 0: its size is never taken from that.

    `row_range`: how many pixels apart in row the two images of an object may be. `disparity_max`: in column.
    `disparity_range`: by how many pixels its disparity may differ from that of its place. `refined`: whether the
    disparity helps to measure, a ball is treated as a sphere, and a goal as a box; without it the distance is that of
    the thesis (T Eq. 4.1, the mean of both cameras).

    `age_max`: for how many frames an unseen object stays in the history. `apart_max`: how far it may have moved in the
    picture since the last frame, in 256ths of a focal length; a goal, the only one of its model, may have moved more.
    """

    colour_weight: int = allowed(0, LARGEST_ACCURACY, total=LARGEST_ACCURACY)
    dimension_weight: int = allowed(0, LARGEST_ACCURACY, total=LARGEST_ACCURACY)
    area_weight: int = allowed(0, LARGEST_ACCURACY, total=LARGEST_ACCURACY)
    centre_weight: int = allowed(0, LARGEST_ACCURACY, total=LARGEST_ACCURACY)
    size_weight: int = allowed(0, LARGEST_ACCURACY, total=LARGEST_ACCURACY)
    camera_weight: int = allowed(0, LARGEST_ACCURACY, total=LARGEST_ACCURACY)
    shortest_side: int = allowed(1, 1023)
    size_range: int = allowed(16, 256)
    ball_area: int = allowed(0, 256)
    rectangle_area: int = allowed(0, 256)
    row_range: int = allowed(0, 255)
    disparity_max: int = allowed(1, 1023)
    disparity_range: int = allowed(0, 255)
    hidden_arc: int = allowed(0, 256)
    refined: bool
    circle_area: bool
    age_max: int = allowed(0, 255)
    apart_max: int = allowed(0, 1024)

    def __post_init__(self) -> None:
        if min(self.weights) < 0 or sum(self.weights) > LARGEST_ACCURACY:
            raise ValueError(
                f"the weights of the tests must be 0 or more, {LARGEST_ACCURACY} together at most, "
                f"not {', '.join(map(str, self.weights))}"
            )

    @property
    def weights(self) -> tuple[int, ...]:
        """The weights in the order of the tests' bits."""
        tests = self.colour_weight, self.dimension_weight, self.area_weight
        return *tests, self.centre_weight, self.size_weight, self.camera_weight

    @property
    def limits(self) -> tuple[int, ...]:
        """The thresholds that kernels read, in the order of `object_limits`."""
        sizes = self.shortest_side, self.size_range, self.ball_area, self.rectangle_area
        return *self.weights, *sizes, int(self.refined), self.hidden_arc, int(self.circle_area)


@dataclass(frozen=True, slots=True, kw_only=True)
class Outlines:
    """How many blobs, including merged ones, circles and rectangles a picture has in their stores."""

    blobs: int
    circles: int
    rectangles: int


def object_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage for each core."""
    return (Buffer("object_limits", i32, LIMIT_WORDS, "data1"),)


def left_object_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage that only core A has."""
    return (
        Buffer("left_seen", i16, SEEN_CAPACITY * OBJECT_WORDS, "data1"),
        Buffer("objects", i16, OBJECT_CAPACITY * OBJECT_WORDS, "data1"),
        Buffer("history_area", i32, AREA_WORDS, "data1"),
    )


def shared_object_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage that both cores reach."""
    return (Buffer("right_seen", i16, SEEN_CAPACITY * OBJECT_WORDS, "l2_shared", handed_over=True),)


@kernel
def store_limit(limits: i32[:], number: i32, value: i32) -> None:
    """Store a threshold."""
    limits[number] = value


def left_sight(
    core: Core, frame: Frame, outlines: Outlines, thresholds: ObjectThresholds
) -> Generator[Any, Any, None]:
    """Leave the objects that the left camera sees in `left_seen`; publish `seen` and `seen_lost`."""
    yield from _sight(core, frame, outlines, thresholds, core.array("left_seen"), SEEN_LEFT)


def right_sight(
    core: Core, frame: Frame, outlines: Outlines, thresholds: ObjectThresholds
) -> Generator[Any, Any, None]:
    """Leave the objects that the right camera sees in `right_seen`; publish `seen` and `seen_lost`."""
    yield from _sight(core, frame, outlines, thresholds, core.array("right_seen"), SEEN_RIGHT)


def _sight(
    core: Core, frame: Frame, outlines: Outlines, thresholds: ObjectThresholds, seen: Row, camera: int
) -> Generator[Any, Any, None]:
    limits = core.array("object_limits")
    for number, value in enumerate(thresholds.limits):
        yield core.run(store_limit, limits, number, value)
    found = yield core.run(
        see_objects,
        *(core.array("blob_data"), core.array("label_parents"), outlines.blobs, core.array("models")),
        *(core.array("circles"), outlines.circles, core.array("rectangles"), outlines.rectangles),
        *(core.array("lines"), core.array("geometry"), limits),
        *(seen, camera, frame.width, frame.height),
    )
    core.publish(seen=min(found, SEEN_CAPACITY), seen_lost=max(found - SEEN_CAPACITY, 0))


def object_detection(
    core: Core, frame: Frame, thresholds: ObjectThresholds, box_lines: int = 0
) -> Generator[Any, Any, None]:
    """Verify `left_seen` by `right_seen` and take both into the history, `objects`.

    `box_lines`: the number of 3-D lines by which boxes are placed; 0 if there are none to place, or none to see.
    Publishes `verified`, how many objects both cameras see, and what `remember` does.
    """
    tables = core.array("left_seen"), core.array("right_seen")
    pixels = thresholds.row_range, thresholds.disparity_max, thresholds.disparity_range
    verified = yield core.run(
        verify_objects,
        *(core.array("geometry"), *tables),
        *(SUBPIXELS * each for each in pixels),
        *(thresholds.camera_weight, thresholds.size_weight, int(thresholds.refined), frame.width),
    )
    core.publish(verified=verified)
    if box_lines:
        yield from place_boxes(core, box_lines)
    yield from remember(core, tables, thresholds)


def remember(core: Core, tables: Sequence[Row], thresholds: ObjectThresholds) -> Generator[Any, Any, None]:
    """Take the objects of some tables into the history; publish `objects_lost`, how many found no room there."""
    objects = core.array("objects")
    yield core.run(age_objects, objects, thresholds.age_max)
    lost = 0
    for seen in tables:
        lost += yield core.run(remember_objects, objects, seen, core.array("models"), thresholds.apart_max)
    core.publish(objects_lost=lost)
