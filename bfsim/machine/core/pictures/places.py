"""Places of a picture as firmware says them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from operator import index

from bfsim.spans import Place

Pixels = Callable[[], Iterable[tuple[int, int]]]
"""What returns the row and the column of single pixels, and is called only if someone looks."""

Columns = int | range | Callable[[], Iterable[int]]
"""Columns of a picture: one, those of a range, or what returns single ones and is called only if someone looks."""


def place_of(rows: int | range | Pixels, columns: Columns | None) -> Place | None:
    """Return the place that rows and columns mean, None for no pixel."""
    if callable(rows):
        pixels = sorted(set(rows()))
        return Place(*zip(*pixels, strict=True)) if pixels else None
    if columns is None:
        return Place(_range(rows))
    if callable(columns):
        return Place(_range(rows), tuple(sorted(set(columns()))) or None)
    return Place(_range(rows), _range(columns))


def _range(places: int | range) -> range:
    return places if isinstance(places, range) else range(index(places), index(places) + 1)
