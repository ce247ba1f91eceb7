"""Picture lines on their way through L1: rings keep the latest, and a window moves down them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle, islice
from typing import Protocol

from bfsim.api import Row


class Lines(Protocol):
    """Rows in L1 by the number of the line that they hold."""

    def __getitem__(self, number: int, /) -> Row:
        """Return the row of line `number`, which is lost when the ring has come round to it again."""


def line_ring(rows: Sequence[Row], height: int) -> Lines:
    """Return `rows` as a ring for the lines of a picture: line y lies in row y modulo their number."""
    return tuple(islice(cycle(rows), height))


def window(lines: Lines, y: int, height: int, reach: int = 1) -> tuple[Row, ...]:
    """Return line `y` and `reach` lines on both sides, from above; the first and the last line of the picture repeat."""
    if reach == 1 and 0 < y < height - 1:  # nearly all
        return lines[y - 1], lines[y], lines[y + 1]
    return tuple(lines[min(max(each, 0), height - 1)] for each in range(y - reach, y + reach + 1))
