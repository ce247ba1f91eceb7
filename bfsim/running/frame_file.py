"""What a core did in a frame, in a file of recorded work: a line of JSON, then the columns of its tables."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.machine.bus import state as w
from bfsim.machine.retiming.packed_work import (
    ALIGNED_BYTES,
    PACKED,
    PACKED_COLUMNS,
    WIDTHS,
    PackedWork,
)
from bfsim.machine.retiming.work import (
    BYTE,
    COPY_COLUMNS,
    DESTINATION_BYTE,
    KIND,
    OWNER,
    SITE,
    SOURCE_BYTE,
    STAMP,
    FrameWork,
    Place,
    Table,
)

TABLES = PACKED | {"copies": COPY_COLUMNS}
NO_COPIES = np.zeros((0, COPY_COLUMNS), np.int64)
MOST_NUMBERS = 1 << 62
COPY_STEPS = SOURCE_BYTE, DESTINATION_BYTE
"""Columns of copies that are stored as differences between rows, since their values go up in steps.

So are the bytes of accesses and the counters of events.
"""


def written(work: FrameWork) -> bytes:
    """Return a frame as it is stored."""
    tables = _tables(work)
    columns = [(_width(each), each) for table in TABLES for each in tables[table]]
    head = {
        "calls": work.calls, "accounts": work.accounts, "stages": work.stages, "results": dict(work.results),
        "widths": [width for width, _ in columns], "rows": {table: len(tables[table][0]) for table in TABLES},
    }  # fmt: skip
    line = json.dumps(head, default=asdict).encode()
    octets = [each.astype(WIDTHS[width]).tobytes() for width, each in columns]
    return _aligned(line + b"\n", -1, b" ") + b"".join(_aligned(each, len(each), b"\0") for each in octets)


def _tables(work: FrameWork) -> dict[str, list[NDArray[np.int64]]]:
    """Return the columns of all tables as they are stored."""
    accesses, events, copies = (each.T.astype(np.int64) for each in (work.accesses, work.events, work.copies))
    steps, byte_steps = _steps(accesses[STAMP]), _steps(accesses[BYTE])
    counts = work.operations[work.operations[:, 0] == w.ACCESS, 3]
    firsts = (np.cumsum(counts) - counts)[counts > 0]
    steps[firsts] = accesses[STAMP, firsts]  # each call begins anew
    operations = work.operations.copy()
    copies_made = operations[:, 0] == w.COPY
    operations[copies_made, 1] = _steps(operations[copies_made, 1])
    operation_dictionary, of_operations = _dictionary([*operations.T])
    access_dictionary, of_accesses = _dictionary([accesses[KIND], accesses[OWNER], accesses[SITE]])
    return {
        "operations": [of_operations],
        "operation_dictionary": operation_dictionary,
        "accesses": [steps, of_accesses, byte_steps],
        "access_dictionary": access_dictionary,
        "events": [events[0], _steps(events[1]), events[2]],
        "copies": [_steps(each) if number in COPY_STEPS else each for number, each in enumerate(copies)],
    }


def _dictionary(columns: list[NDArray[np.int64]]) -> tuple[list[NDArray[np.int64]], NDArray[np.int64]]:
    """Return the distinct rows of some columns, and which of them each row is."""
    number, numbers = np.zeros(len(columns[0]), np.int64), 1
    for each in columns:  # as one number, which numpy sorts in a tenth of the time
        least = int(each.min(initial=0))
        size = int(each.max(initial=0)) - least + 1
        if numbers * size > MOST_NUMBERS:
            found, number = np.unique(number, return_inverse=True)
            numbers = len(found)
        number = number * size + each - least
        numbers *= size
    _, examples, entry_of = np.unique(number, return_index=True, return_inverse=True)
    return [each[examples] for each in columns], entry_of


def _steps(column: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.diff(column, prepend=0)


def _width(column: NDArray[np.int64]) -> int:
    """Return the index of the narrowest width that can hold a column."""
    least, most = column.min(initial=0), column.max(initial=0)
    fits = (np.iinfo(each).min <= least and most <= np.iinfo(each).max for each in WIDTHS)
    return [*fits].index(True)


def _aligned(octets: bytes, place: int, filling: bytes) -> bytes:
    """Return `octets` with fillers inserted at `place`, so that the length is a multiple of ALIGNED_BYTES."""
    return octets[:place] + filling * (-len(octets) % ALIGNED_BYTES) + octets[place:]


def read(core: str, content: bytes) -> PackedWork:
    """Return the work in a stored frame. Raises ValueError, LookupError or TypeError if it is broken."""
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
        copies=_copies(content, columns[PACKED_COLUMNS:], rows["copies"]) if rows["copies"] else NO_COPIES,
        calls=tuple(
            (name, tuple(_argument(each) for each in arguments)) for name, arguments in head["calls"]
        ),
        accounts=tuple(head["accounts"]),
        stages=tuple(head["stages"]),
        results=head["results"],
    )


def _copies(content: bytes, columns: list[tuple[int, int]], rows: int) -> Table:
    table = np.empty((rows, COPY_COLUMNS), np.int64)
    for number, (begin, width) in enumerate(columns):
        column = np.frombuffer(content, WIDTHS[width], rows, begin)
        table[:, number] = np.cumsum(column) if number in COPY_STEPS else column
    return table


def _argument(each: Any) -> Any:
    return Place(**each) if isinstance(each, dict) and each.keys() == {"owner", "first", "nbytes"} else each
