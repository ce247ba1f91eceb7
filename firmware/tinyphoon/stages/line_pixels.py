"""Where lines lie in the picture, for `core.at`: nothing on the chip reads them here."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from bfsim.api import Row
from tinyphoon.stages.line_segments import EDGES, END_X, END_Y, SEGMENT_WORDS, START_X, START_Y
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_X1, LINE_Y0, LINE_Y1, SUBPIXELS

Pixels = Callable[[], Iterator[tuple[int, int]]]


def segment_pixels(segments: Row, count: int) -> Pixels:
    """Return what tells the pixels (row, column) between the outermost edges of the first `count` places of the table."""

    def pixels() -> Iterator[tuple[int, int]]:
        for each in segments.array[: count * SEGMENT_WORDS].reshape(-1, SEGMENT_WORDS):
            if each[EDGES]:
                yield from _between(*(float(each[word]) for word in (START_X, START_Y, END_X, END_Y)))

    return pixels


def line_pixels(lines: Row, count: int) -> Pixels:
    """Return what tells the pixels (row, column) under the first `count` lines."""

    def pixels() -> Iterator[tuple[int, int]]:
        for each in lines.array[: count * LINE_WORDS].reshape(-1, LINE_WORDS):
            yield from _between(*(each[word] / SUBPIXELS for word in (LINE_X0, LINE_Y0, LINE_X1, LINE_Y1)))

    return pixels


def _between(x0: float, y0: float, x1: float, y1: float) -> Iterator[tuple[int, int]]:
    """Yield the pixels from one end of a line to the other, one in each row or in each column."""
    steps = round(max(abs(x1 - x0), abs(y1 - y0))) + 1
    places = np.linspace((y0, x0), (y1, x1), steps).round().astype(int)
    yield from map(tuple, places.tolist())
