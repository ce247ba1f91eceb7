"""Places in a picture, as firmware gives them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from operator import index
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError, shown
from bfsim.spans import Place

Pixels = Callable[[], Iterable[tuple[int, int]]]
"""Returns the rows and columns of single pixels. Called only if someone looks."""

Columns = int | range | Callable[..., Iterable[int]]
"""Columns of a picture: one, a range, or a function that returns single ones. It is called only if someone looks."""


def place_of(rows: int | range | Pixels, columns: Columns | None, *taken: Any) -> Place | None:
    """Return the place that rows and columns mean, None for no pixel. A function of columns is called with `taken`.

    Raises FirmwareError for anything that is no place.
    """
    if callable(rows):
        given = rows()
        return _pixels(given if isinstance(given, np.ndarray) else list(given))
    if columns is None:
        return _row(rows) if type(rows) is int else Place(_range(rows))
    if callable(columns):
        single: list[int] = list(columns(*taken))
        whole = single if {*map(type, single)} == {int} else [*map(_whole, single)]
        return Place(_range(rows), tuple(sorted(set(whole))) or None)
    return Place(_range(rows), _range(columns))


def _pixels(given: Sequence[Any] | NDArray[Any]) -> Place | None:
    """Return single pixels in order, each once."""
    for each in given if _kind_of(given) != "i" else ():
        if not isinstance(each, Sequence | np.ndarray) or len(each) != 2:
            raise FirmwareError(f"a pixel of core.at must be a row and a column, not {shown(each)}")
        _whole(each[0]), _whole(each[1])
    if not len(given):
        return None
    rows, columns = np.array(given, np.int64).T
    order = np.lexsort((columns, rows))
    rows, columns = rows[order], columns[order]
    is_new = (np.diff(rows, prepend=rows[0] - 1) != 0) | (np.diff(columns, prepend=0) != 0)
    return Place(tuple(rows[is_new].tolist()), tuple(columns[is_new].tolist()))


def _kind_of(given: Sequence[Any] | NDArray[Any]) -> str:
    """Return numpy's kind of the numbers in pairs, empty if these are no pairs of numbers."""
    try:
        pairs = np.array(given)
    except ValueError:  # not all of them have the same length
        return ""
    return pairs.dtype.kind if pairs.shape == (len(given), 2) else ""


@cache
def _row(row: int) -> Place:
    return Place(range(row, row + 1))


def _range(places: int | range) -> range:
    return places if isinstance(places, range) else range(_whole(places), _whole(places) + 1)


def _whole(place: Any) -> int:
    try:
        return index(place)
    except TypeError:
        raise FirmwareError(f"a place of core.at must be in whole pixels, not {shown(place)}") from None
