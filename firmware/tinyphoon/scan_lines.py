"""Picture lines on their way through L1: rings keep the latest, and a window moves down them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle, islice

from bfsim.api import Row

Lines = tuple[Row, ...]
"""Rows in L1, by the number of their line; a line is lost when its ring comes round to its row again."""


def line_ring(rows: Sequence[Row], height: int) -> Lines:
    """Return `rows` as a ring for the lines of a picture: line y lies in row y modulo their number."""
    return tuple(islice(cycle(rows), height))


def windows(lines: Sequence[Row], reach: int = 1) -> Sequence[tuple[Row, ...]]:
    """Return for each line of a picture `reach` lines above it, itself and as many below; at the ends lines repeat."""
    padded = (*lines[:1] * reach, *lines, *lines[-1:] * reach)
    return tuple(zip(*(padded[step:] for step in range(2 * reach + 1)), strict=False))
