"""The results as the strategy unit reads them: the payload of a message taken apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from bfsim.api import FirmwareError
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.rectangles import RECTANGLE_BOTTOM, RECTANGLE_LEFT, RECTANGLE_RIGHT
from tinyphoon.strategy.results import COUNTS_WORDS, LINE_REPORT_WORDS, REPORT_WORDS


class Side(IntEnum):
    """Which border of a goal a line is."""

    LEFT = RECTANGLE_LEFT
    RIGHT = RECTANGLE_RIGHT
    BOTTOM = RECTANGLE_BOTTOM


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedObject:
    """An object as the strategy unit is told of it.

    `tests`, `cameras`, `measures`: the bits of `stores/objects.py`. `towards`: its place in mm in the left camera's frame, or
    without `measures` a vector that points there. `image_px`: middle, width and height in the picture.
    """

    model: int
    accuracy: int
    tests: int
    cameras: int
    measures: int
    age: int
    towards: tuple[int, int, int]
    image_px: tuple[float, float, float, float]

    @property
    def has_place(self) -> bool:
        """Whether `towards` is a place, and not only a direction."""
        return self.measures != 0


@dataclass(frozen=True, slots=True, kw_only=True)
class GoalLine:
    """A border line of a goal in the left picture: x and y of its start and of its end."""

    model: int
    side: Side
    ends_px: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Results:
    """What the strategy unit is told after a frame. `refusal`: why it refused an order, or 0."""

    frame: int
    refusal: int
    objects: tuple[ReportedObject, ...]
    lines: tuple[GoalLine, ...]


def decode_results(payload: bytes) -> Results:
    """Read the payload of a message of results. Raises FirmwareError if it is none."""
    words = np.frombuffer(payload[: len(payload) // 2 * 2], "<i2").tolist()
    if len(payload) < 2 * COUNTS_WORDS:
        raise FirmwareError(f"results must have at least {2 * COUNTS_WORDS} bytes, not {len(payload)}")
    low, high, objects, lines, refusal, *corner = words[:COUNTS_WORDS]
    expected = 2 * (COUNTS_WORDS + objects * REPORT_WORDS + lines * LINE_REPORT_WORDS)
    if min(objects, lines) < 0 or len(payload) != expected:
        raise FirmwareError(
            f"results of {objects} objects and {lines} lines must have {expected} bytes, not {len(payload)}"
        )
    first_line = COUNTS_WORDS + objects * REPORT_WORDS
    return Results(
        frame=low & 0xFFFF | high << 16,
        refusal=refusal & 0xFFFF,
        objects=tuple(
            _object(each, *corner) for each in _records(words[COUNTS_WORDS:first_line], REPORT_WORDS)
        ),
        lines=tuple(_line(each, *corner) for each in _records(words[first_line:], LINE_REPORT_WORDS)),
    )


def _records(words: Sequence[int], size: int) -> list[Sequence[int]]:
    return [words[at : at + size] for at in range(0, len(words), size)]


def _object(words: Sequence[int], left: int, top: int) -> ReportedObject:
    (model, accuracy), (tests, cameras), (measures, age) = (
        divmod(each & 0xFFFF, 256)[::-1] for each in words[:3]
    )
    x, y, z, *image = words[3:]
    image_x, image_y, width, height = (each / SUBPIXELS for each in image)
    return ReportedObject(
        model=model,
        accuracy=accuracy,
        tests=tests,
        cameras=cameras,
        measures=measures,
        age=age,
        towards=(x, y, z),
        image_px=(left + image_x, top + image_y, width, height),
    )


def _line(words: Sequence[int], left: int, top: int) -> GoalLine:
    x0, y0, x1, y1 = (each / SUBPIXELS for each in words[1:])
    side = words[0] >> 8 & 0xFF
    if side not in set(Side):
        raise FirmwareError(f"the side of a line must be 0, 1 or 3, not {side}")
    ends = left + x0, top + y0, left + x1, top + y1
    return GoalLine(model=words[0] & 0xFF, side=Side(side), ends_px=ends)
