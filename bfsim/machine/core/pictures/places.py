"""Places of a picture as firmware says them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from operator import index
from typing import Any

import numpy as np

from bfsim.errors import FirmwareError, shown
from bfsim.spans import Place

Pixels = Callable[[], Iterable[tuple[int, int]]]
"""What returns the row and the column of single pixels, and is called only if someone looks."""

Columns = int | range | Callable[[], Iterable[int]]
"""Columns of a picture: one, those of a range, or what returns single ones and is called only if someone looks."""


def place_of(rows: int | range | Pixels, columns: Columns | None) -> Place | None:
    """Return the place that rows and columns mean, None for no pixel. Raises FirmwareError for what is no place."""
    if callable(rows):
        pixels = _pixels(list(rows()))
        return Place(*zip(*pixels, strict=True)) if pixels else None
    if columns is None:
        return Place(_range(rows))
    if callable(columns):
        single = tuple(sorted({_whole(each) for each in columns()}))
        return Place(_range(rows), single or None)
    return Place(_range(rows), _range(columns))


def _pixels(given: list[Any]) -> list[tuple[int, int]]:
    for each in given:
        if not isinstance(each, Sequence | np.ndarray) or len(each) != 2:
            raise FirmwareError(f"a pixel of core.at must be a row and a column, not {shown(each)}")
    return sorted({(_whole(row), _whole(column)) for row, column in given})


def _range(places: int | range) -> range:
    return places if isinstance(places, range) else range(_whole(places), _whole(places) + 1)


def _whole(place: Any) -> int:
    try:
        return index(place)
    except TypeError:
        raise FirmwareError(f"a place of core.at must be in whole pixels, not {shown(place)}") from None
