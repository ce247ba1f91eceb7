"""`FrameWork` as a file has it, in columns of narrow numbers, and read from there, compiled: tables of it would take longer to make than to play."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.native.entries import native
from bfsim.machine.retiming.work import EVENT_COLUMNS, OPERATION_COLUMNS, Table

WIDTHS = tuple(np.dtype(each) for each in ("<i1", "<i2", "<i4", "<i8"))
ALIGNED_BYTES = 8
"""A column begins at a multiple of so many bytes."""

BEGIN, WIDTH = range(2)
"""Words of a column: its first byte, and the number of its width."""
COLUMN_WORDS = 2
PACKED = {
    "operations": 1, "operation_dictionary": OPERATION_COLUMNS, "accesses": 3, "access_dictionary": 3, "events": EVENT_COLUMNS,
}  # fmt: skip
"""The tables, and how many columns each has."""
OPERATIONS, OPERATION_DICTIONARY, ACCESSES, ACCESS_DICTIONARY, EVENTS, PACKED_COLUMNS = accumulate(
    PACKED.values(), initial=0
)
"""The first column of each, and the one behind all."""
STEP, ENTRY, BYTE_STEP = range(3)
"""Columns of an access, whose kind, owner and site are those of its entry in the dictionary."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PackedWork:
    """What one core did, as `FrameWork`, with the numbers of the tables above in `octets`, as they were written.

    `columns`: words as above of each of their columns; `rows` says how many there are of each table. Of accesses
    each stamp is the difference to the one before it in its call, and each byte that to the one before it; so is each counter of events.
    What many have in common is an entry of a *dictionary*, as column stores have it: the numbers of an operation, with the number of a
    copy as the difference to that of the copy before; and kind, owner and site of an access.
    """

    core: str
    octets: bytes
    columns: NDArray[np.int64]
    rows: Mapping[str, int]
    copies: Table
    calls: tuple[tuple[str, tuple[Any, ...]], ...]
    accounts: tuple[str, ...]
    stages: tuple[str, ...]
    results: Mapping[str, int]

    def column(self, number: int, rows: int) -> NDArray[Any]:
        """Return the numbers of a column as they are written. Raises ValueError where they are not all there."""
        begin, width = self.columns[number].tolist()
        return np.frombuffer(self.octets, WIDTHS[width], rows, begin)


Views = tuple[Sequence[int], Sequence[int], Sequence[int], Sequence[int]]
"""The octets of a work, as numbers of each of the widths."""


@native
def number_at(views: Views, begin: int, width: int, row: int) -> int:
    """Return a number of a column."""
    octets, halves, words, longs = views
    if width == 0:
        return octets[begin + row]
    if width == 1:
        return halves[(begin >> 1) + row]
    if width == 2:
        return words[(begin >> 2) + row]
    return longs[(begin >> 3) + row]
