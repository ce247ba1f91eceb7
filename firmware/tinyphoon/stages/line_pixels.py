"""The pixels of lines, for `core.at`: nothing on the chip reads them here."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bfsim.api import Row
from tinyphoon.stages.line_segments import EDGES, END_X, END_Y, SEGMENT_WORDS, START_X, START_Y
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_X1, LINE_Y0, LINE_Y1, SUBPIXELS

Pixels = Callable[[], NDArray[np.int64]]


def segment_pixels(segments: Row, count: int) -> Pixels:
    """Return a function for the (row, column) of pixels between the outer edges of the table's first `count` places."""

    def pixels() -> NDArray[np.int64]:
        table = segments.array[: count * SEGMENT_WORDS].reshape(-1, SEGMENT_WORDS)
        return _between(table[table[:, EDGES] != 0][:, [START_Y, START_X, END_Y, END_X]].astype(float))

    return pixels


def line_pixels(lines: Row, count: int) -> Pixels:
    """Return a function for the pixels (row, column) under the first `count` lines."""

    def pixels() -> NDArray[np.int64]:
        table = lines.array[: count * LINE_WORDS].reshape(-1, LINE_WORDS)
        return _between(table[:, [LINE_Y0, LINE_X0, LINE_Y1, LINE_X1]] / SUBPIXELS)

    return pixels


def _between(ends: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the pixels between the ends of each line, one in each row or column; `ends`: rows and columns of both."""
    starts, stops = ends[:, :2], ends[:, 2:]
    steps = np.abs(stops - starts).max(axis=1, initial=0).round().astype(int)
    line = np.repeat(np.arange(len(ends)), steps + 1)
    step = np.arange(len(line)) - np.repeat((steps + 1).cumsum() - (steps + 1), steps + 1)
    pace = (stops - starts) / np.maximum(steps, 1)[:, None]
    return (step[:, None] * pace[line] + starts[line]).round().astype(int)
