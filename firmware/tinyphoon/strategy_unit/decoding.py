"""The results as the strategy unit reads them: the payload of a message, decoded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from bfsim.api import FirmwareError
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.rectangles import RECTANGLE_BOTTOM, RECTANGLE_LEFT, RECTANGLE_RIGHT, RECTANGLE_TOP
from tinyphoon.strategy.depth_report import EDGE3D_REPORT_WORDS, LINE3D_REPORT_WORDS
from tinyphoon.strategy.results import COUNTS_WORDS, LINE_REPORT_WORDS, REPORT_WORDS


class Side(IntEnum):
    """The border of a rectangle that a line belongs to."""

    LEFT = RECTANGLE_LEFT
    RIGHT = RECTANGLE_RIGHT
    TOP = RECTANGLE_TOP
    BOTTOM = RECTANGLE_BOTTOM


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedObject:
    """An object as reported to the strategy unit.

    `tests`, `cameras`, `measures`: the bits of `stores/objects.py`. `towards`: its place in mm in the left camera's
    frame or, without `measures`, a vector in its direction. `image_px`: middle, width and height in the picture.
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
        """Whether `towards` is a place rather than just a direction."""
        return self.measures != 0


@dataclass(frozen=True, slots=True, kw_only=True)
class BorderLine:
    """A border line of a rectangle in the left picture: x and y of its start and its end."""

    model: int
    side: Side
    ends_px: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Results:
    """The report after a frame. `refusal`: why an order was refused, or 0.

    `lines_3d` are starts and ends in mm in the left camera's frame, of shape (lines, 2, 3), with the bright side on the
    left; `edges_3d`, of shape (edges, 3), are places. `*_found`: how many there were; only some of them fit.
    """

    frame: int
    refusal: int
    objects: tuple[ReportedObject, ...]
    lines: tuple[BorderLine, ...]
    lines_3d: NDArray[np.int16]
    edges_3d: NDArray[np.int16]
    lines_3d_found: int
    edges_3d_found: int


def decode_results(payload: bytes) -> Results:
    """Decode the payload of a message of results. Raises FirmwareError if it is invalid."""
    words = np.frombuffer(payload[: len(payload) // 2 * 2], "<i2").tolist()
    if len(payload) < 2 * COUNTS_WORDS:
        raise FirmwareError(f"results must have at least {2 * COUNTS_WORDS} bytes, not {len(payload)}")
    low, high, objects, lines, refusal, left, top, lines_3d, edges_3d, *found = words[:COUNTS_WORDS]
    counts = objects, lines, lines_3d, edges_3d
    sizes = REPORT_WORDS, LINE_REPORT_WORDS, LINE3D_REPORT_WORDS, EDGE3D_REPORT_WORDS
    ends = list(
        accumulate((each * size for each, size in zip(counts, sizes, strict=True)), initial=COUNTS_WORDS)
    )
    if min(counts) < 0 or len(payload) != 2 * ends[-1]:
        raise FirmwareError(
            f"results of {objects} objects, {lines} lines, {lines_3d} 3-D lines and {edges_3d} 3-D edges must have "
            f"{2 * ends[-1]} bytes, not {len(payload)}"
        )
    parts = [
        _records(words[first:last], size) for (first, last), size in zip(pairwise(ends), sizes, strict=True)
    ]
    return Results(
        frame=low & 0xFFFF | high << 16,
        refusal=refusal & 0xFFFF,
        objects=tuple(_object(each, left, top) for each in parts[0]),
        lines=tuple(_line(each, left, top) for each in parts[1]),
        lines_3d=np.array(parts[2], np.int16).reshape(-1, 2, 3),
        edges_3d=np.array(parts[3], np.int16).reshape(-1, 3),
        lines_3d_found=found[0],
        edges_3d_found=found[1],
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


def _line(words: Sequence[int], left: int, top: int) -> BorderLine:
    x0, y0, x1, y1 = (each / SUBPIXELS for each in words[1:])
    side = words[0] >> 8 & 0xFF
    if side not in set(Side):
        raise FirmwareError(f"the side of a line must be 0 to 3, not {side}")
    ends = left + x0, top + y0, left + x1, top + y1
    return BorderLine(model=words[0] & 0xFF, side=Side(side), ends_px=ends)
