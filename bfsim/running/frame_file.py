"""What a core did in a frame, in a file of recorded work: a line of JSON, and then the columns of its tables."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.machine.bus import state as w
from bfsim.machine.retiming.packed_work import (
    ALIGNED_BYTES,
    PACKED_COLUMNS,
    WIDTHS,
    PackedWork,
)
from bfsim.machine.retiming.work import (
    ACCESS_COLUMNS,
    BYTE,
    COPY_COLUMNS,
    DESTINATION_BYTE,
    EVENT_COLUMNS,
    OPERATION_COLUMNS,
    SOURCE_BYTE,
    STAMP,
    FrameWork,
    Place,
    Table,
)

TABLES = {
    "operations": OPERATION_COLUMNS, "accesses": ACCESS_COLUMNS, "events": EVENT_COLUMNS, "copies": COPY_COLUMNS,
}  # fmt: skip
IN_STEPS = {"accesses": (STAMP, BYTE), "events": (1,), "copies": (SOURCE_BYTE, DESTINATION_BYTE)}
"""Columns that are written as differences from row to row: stamps, bytes and counters, which go up in steps."""


def written(work: FrameWork) -> bytes:
    """Return the content of a frame."""
    columns = [(_width(each), each) for each in _columns(work)]
    head = {
        "calls": work.calls, "accounts": work.accounts, "widths": [width for width, _ in columns],
        "rows": {table: len(getattr(work, table)) for table in TABLES},
    }  # fmt: skip
    line = json.dumps(head, default=asdict).encode()
    octets = [each.astype(WIDTHS[width]).tobytes() for width, each in columns]
    return _aligned(line + b"\n", -1, b" ") + b"".join(_aligned(each, len(each), b"\0") for each in octets)


def _columns(work: FrameWork) -> Iterator[NDArray[np.int64]]:
    """Yield the columns of all tables as they are written."""
    for table in TABLES:
        for number, column in enumerate(getattr(work, table).T.astype(np.int64)):
            if number not in IN_STEPS.get(table, ()):
                yield column
                continue
            steps = np.diff(column, prepend=0)
            if (table, number) == ("accesses", STAMP):  # a call begins anew
                counts = work.operations[work.operations[:, 0] == w.ACCESS, 3]
                firsts = (np.cumsum(counts) - counts)[counts > 0]
                steps[firsts] = column[firsts]
            yield steps


def _width(column: NDArray[np.int64]) -> int:
    """Return the number of the narrowest width that holds a column."""
    least, most = column.min(initial=0), column.max(initial=0)
    fits = (np.iinfo(each).min <= least and most <= np.iinfo(each).max for each in WIDTHS)
    return [*fits].index(True)


def _aligned(octets: bytes, place: int, filling: bytes) -> bytes:
    """Return octets with others at a place, so that they are a multiple of ALIGNED_BYTES."""
    return octets[:place] + filling * (-len(octets) % ALIGNED_BYTES) + octets[place:]


def read(core: str, content: bytes) -> PackedWork:
    """Return what a content says. Raises ValueError, LookupError or TypeError where that is none."""
    at = content.index(b"\n") + 1
    head = json.loads(content[:at])
    rows = {name: int(head["rows"][name]) for name in TABLES}
    tables, columns = (name for name, count in TABLES.items() for _ in range(count)), []
    for table, width in zip(tables, head["widths"], strict=True):
        columns.append((at, range(len(WIDTHS)).index(width)))
        at += -(-rows[table] * WIDTHS[width].itemsize // ALIGNED_BYTES) * ALIGNED_BYTES
    if min(rows.values()) < 0 or at != len(content):
        raise ValueError("the columns must be as long as the tables")
    return PackedWork(
        core=core,
        octets=content,
        columns=np.array(columns[:PACKED_COLUMNS], np.int64),
        rows=rows,
        copies=_copies(content, columns[PACKED_COLUMNS:], rows["copies"]),
        calls=tuple(
            (name, tuple(_argument(each) for each in arguments)) for name, arguments in head["calls"]
        ),
        accounts=tuple(head["accounts"]),
    )


def _copies(content: bytes, columns: list[tuple[int, int]], rows: int) -> Table:
    table = np.empty((rows, COPY_COLUMNS), np.int64)
    for number, (begin, width) in enumerate(columns):
        column = np.frombuffer(content, WIDTHS[width], rows, begin)
        table[:, number] = np.cumsum(column) if number in IN_STEPS["copies"] else column
    return table


def _argument(each: Any) -> Any:
    return Place(**each) if isinstance(each, dict) and each.keys() == {"owner", "first", "nbytes"} else each
