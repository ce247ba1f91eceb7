"""Object models: what is known of the things that the robot looks for (T §4.1, §5.2.6), also as words for kernels.

    typedef struct {
        long iNumber;              // 0: no model
        long eShape;
        long iColours;             // bits of the 32-colour image
        long iWidth, iHeight, iDepth;  // mm
        long iFloor;               // mm from the floor up to its lower border
        long iAspectMin, iAspectMax;
    } t_Model;

`models` is an array of them, `MODEL_WORDS` words of 32 bits each. Those in use come first.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import reduce
from itertools import combinations
from operator import or_

import numpy as np
from numpy.typing import NDArray

from bfsim.api import Buffer, FirmwareError, i32
from tinyphoon.fields import allowed
from tinyphoon.stages.blob_detection import COLOUR_GROUPS, hues
from tinyphoon.stages.colour_reduction import COLOURS

MODEL_NUMBER = 0
MODEL_SHAPE = 1
MODEL_COLOURS = 2
MODEL_WIDTH = 3
MODEL_HEIGHT = 4
MODEL_DEPTH = 5
MODEL_FLOOR = 6
MODEL_ASPECT_MIN = 7
MODEL_ASPECT_MAX = 8
MODEL_WORDS = 9

MODEL_CAPACITY = COLOUR_GROUPS
LARGEST_NUMBER = 255
LARGEST_MM = 4000  # no field is longer, and products with it fit in 32 bits
ASPECT_UNITS = 16  # an aspect is width by height in sixteenths
LARGEST_ASPECT = 32 * ASPECT_UNITS
ALL_COLOURS = (1 << COLOURS) - 2  # bit 0 is no colour


class Shape(IntEnum):
    """What to look for near a blob: a circle, the border lines of a rectangle, or the upright edges of a box."""

    BALL = 1
    GOAL = 2
    """The field has one of each model: the rules give each goal a colour of its own (T §2.3). Its bottom line and its
    posts are also sent separately (T §6.4)."""
    MARKER = 3
    BOX = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectModel:
    """A kind of objects: its colours, its shape and its size (T §4.1).

    `number` is its name on the SPI. `colours` are bits of the 32-colour image. `width_mm`, `height_mm` and `depth_mm`
    are its size from the front; only a box may be seen from all sides. `floor_mm` is the height of its lower border
    above the floor. `aspect_min` and `aspect_max`, of the dimension test, limit width by height of its blob, in
    sixteenths. Raises FirmwareError if the model contradicts itself.
    """

    name: str
    number: int = allowed(1, LARGEST_NUMBER)
    shape: Shape
    colours: int = allowed(2, ALL_COLOURS, step=2)
    width_mm: int = allowed(1, LARGEST_MM)
    height_mm: int = allowed(1, LARGEST_MM)
    depth_mm: int = allowed(1, LARGEST_MM)
    floor_mm: int = allowed(0, LARGEST_MM)
    aspect_min: int = allowed(1, LARGEST_ASPECT, at_most="aspect_max")
    aspect_max: int = allowed(1, LARGEST_ASPECT)

    def __post_init__(self) -> None:
        self._check(1 <= self.number <= LARGEST_NUMBER, f"number must be 1 to {LARGEST_NUMBER}", self.number)
        shapes = ", ".join(f"{each.value} ({each.name})" for each in Shape)
        self._check(self.shape in set(Shape), f"shape must be one of {shapes}", self.shape)
        colours = 0 < self.colours <= ALL_COLOURS and not self.colours & ~ALL_COLOURS
        self._check(colours, f"colours must be bits of 0x{ALL_COLOURS:08X}", f"0x{self.colours:08X}")
        for name in ("width_mm", "height_mm", "depth_mm"):
            size = getattr(self, name)
            self._check(1 <= size <= LARGEST_MM, f"{name} must be 1 to {LARGEST_MM}", size)
        self._check(0 <= self.floor_mm <= LARGEST_MM, f"floor_mm must be 0 to {LARGEST_MM}", self.floor_mm)
        aspects = 1 <= self.aspect_min <= self.aspect_max <= LARGEST_ASPECT
        limits = f"{self.aspect_min} to {self.aspect_max}"
        self._check(aspects, f"aspects must be a range within 1 to {LARGEST_ASPECT}", limits)
        if self.shape == Shape.BALL:
            is_round = self.width_mm == self.height_mm == self.depth_mm
            self._check(is_round, "a ball must be as high and as deep as wide", self._size)

    @property
    def _size(self) -> str:
        return f"{self.width_mm} x {self.height_mm} x {self.depth_mm} mm"

    def _check(self, sound: bool, demand: str, value: object) -> None:
        if not sound:
            raise FirmwareError(f"model {self.name}: {demand}, not {value}")

    @property
    def words(self) -> tuple[int, ...]:
        """The t_Model."""
        size = self.width_mm, self.height_mm, self.depth_mm
        aspects = self.aspect_min, self.aspect_max
        return self.number, self.shape, self.colours, *size, self.floor_mm, *aspects


def check_models(models: Sequence[ObjectModel]) -> None:
    """Raise FirmwareError if models contradict one another.

    The colours of two models must be the same or disjoint: a pixel belongs to only one blob.
    """
    if not 1 <= len(models) <= MODEL_CAPACITY:
        raise FirmwareError(f"there must be 1 to {MODEL_CAPACITY} models, not {len(models)}")
    for one, other in combinations(models, 2):
        both = f"models {one.name} and {other.name}"
        if one.number == other.number:
            raise FirmwareError(f"{both} must have different numbers, not both {one.number}")
        if one.colours & other.colours and one.colours != other.colours:
            shared = f"0x{one.colours & other.colours:08X} of 0x{one.colours:08X} and 0x{other.colours:08X}"
            raise FirmwareError(f"{both} must have all colours in common or none, not {shared}")
        if (one.colours, one.shape) == (other.colours, other.shape):
            raise FirmwareError(f"{both} must differ in colour or shape, or nothing tells them apart")


def colour_groups(models: Iterable[ObjectModel]) -> tuple[int, ...]:
    """Return the colours of interest, each group once, for the segmentation."""
    return tuple(sorted({each.colours for each in models}))


def colours_of(models: Iterable[ObjectModel], *shapes: Shape) -> int:
    """Return the colours of the models of the given shapes."""
    return reduce(or_, (each.colours for each in models if each.shape in shapes), 0)


def model_words(models: Sequence[ObjectModel]) -> NDArray[np.int32]:
    """Return the contents of `models` for these models. Raises FirmwareError as `check_models`."""
    check_models(models)
    words = np.zeros((MODEL_CAPACITY, MODEL_WORDS), np.int32)
    words[: len(models)] = [each.words for each in models]
    return words.ravel()


def model_buffers() -> Sequence[Buffer]:
    """Return a core's buffer of the models; it starts with those of the indoor field."""
    return (Buffer("models", i32, MODEL_CAPACITY * MODEL_WORDS, "data1", values=model_words(MODELS)),)


# The hues of the recording's blue goal, yellow ball and red mark, each with the hue on either side: noise and shade
# shift a colour by one.
BLUE = hues(9, 11)
YELLOW = hues(21, 23)
RED = hues(25, 27)
GREEN = hues(15, 19)
# The hue of the cyan mark in the scene of T Figure 6.10, with the hue on either side, between blue and green.
CYAN = hues(12, 14)

# Goals 400 mm wide and 150 mm deep [MiroSot] and 100 mm high [assumed, as in scenes/soccer.py]: 4 to 1 from the front,
# but less than 1 to 1 at a sharp angle (T Figure 6.14) or half in view.
_GOAL_MM = {
    "width_mm": 400,
    "height_mm": 100,
    "depth_mm": 150,
    "floor_mm": 0,
    "aspect_min": 12,
    "aspect_max": 96,
}

MODELS = (
    # Round: 1 to 1, with a quarter more for shade and reflections. A ball of 6 cm [T §6.3.1].
    ObjectModel(
        name="ball",
        number=1,
        shape=Shape.BALL,
        colours=YELLOW,
        width_mm=60,
        height_mm=60,
        depth_mm=60,
        floor_mm=0,
        aspect_min=12,
        aspect_max=21,
    ),
    ObjectModel(name="blue goal", number=2, shape=Shape.GOAL, colours=BLUE, **_GOAL_MM),
    ObjectModel(name="yellow goal", number=3, shape=Shape.GOAL, colours=YELLOW, **_GOAL_MM),
    # On a cube of 75 mm [MiroSot], from 7 to 12 cm above the ground [T §6.4]: 3 to 2, and 2 to 1 across the corner.
    ObjectModel(
        name="robot marker",
        number=4,
        shape=Shape.MARKER,
        colours=RED,
        width_mm=75,
        height_mm=50,
        depth_mm=75,
        floor_mm=70,
        aspect_min=16,
        aspect_max=40,
    ),
)
"""The objects of the indoor field."""

THESIS_MODELS = (*MODELS, replace(MODELS[-1], name="other team's marker", number=6, colours=CYAN))
"""Also with the marks of the other team: the rules give each team a colour of its own (T §2.3), and the players of both
are to be detected (T §1.3.1, §6.3.2)."""

# Its aspects fit every side, 100 mm by 100 mm, and the diagonal, and a quarter more for shade and reflections.
BOX = ObjectModel(
    name="box",
    number=5,
    shape=Shape.BOX,
    colours=GREEN,
    width_mm=100,
    height_mm=100,
    depth_mm=100,
    floor_mm=0,
    aspect_min=12,
    aspect_max=29,
)
"""The template for other boxes; the field has none."""
