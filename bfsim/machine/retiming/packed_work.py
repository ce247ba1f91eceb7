"""`FrameWork` as in a file, in columns of narrow numbers, and its compiled reading: making tables of it would take longer than playing it."""

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
"""Columns begin at multiples of this number of bytes."""

BEGIN, WIDTH = range(2)
"""Words of a column: its first byte, and the number of its width."""
COLUMN_WORDS = 2
PACKED = {
    "operations": 1, "operation_dictionary": OPERATION_COLUMNS, "accesses": 3, "access_dictionary": 3, "events": EVENT_COLUMNS,
}  # fmt: skip
"""The tables, and the number of columns of each."""
OPERATIONS, OPERATION_DICTIONARY, ACCESSES, ACCESS_DICTIONARY, EVENTS, PACKED_COLUMNS = accumulate(
    PACKED.values(), initial=0
)
"""The first column of each table, and the number of all columns."""
STEP, ENTRY, BYTE_STEP = range(3)
"""Columns of an access. Its entry in the dictionary has kind, owner and site."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PackedWork:
    """What one core did, as `FrameWork`, with the numbers of the tables above in `octets`, as they were written.

    `columns` has the words above for each column; `rows` is the number of rows of each table. Each access has the difference of its
    stamp to the previous one in its call, and of its byte to the previous one; events have the difference of their counter.
    Repeated values are entries of a *dictionary*, as in column stores: the numbers of an operation, with the number of a copy as the
    difference to the previous copy; and the kind, owner and site of an access.
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
        """Return the numbers of a column as they were written. Raises ValueError if some are missing."""
        begin, width = self.columns[number].tolist()
        return np.frombuffer(self.octets, WIDTHS[width], rows, begin)


Views = tuple[Sequence[int], Sequence[int], Sequence[int], Sequence[int]]
"""The octets of a work as numbers of each width."""


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
