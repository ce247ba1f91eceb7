"""What a core did between two pictures that it took, without when: kernels' cycles and accesses, copies, waits, calls of its firmware.

Memory is named by its owner (`bus.memory_owners`) and the byte there, never by an address: another LDF may place it elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel import access_trace as log
from bfsim.machine.bus import state as w

CALL = w.AWAIT + 1
"""An operation besides those of a stretch (`bus.state`): the next call of its firmware, which is played in Python."""

STREAM, SOURCE, SOURCE_BYTE, DESTINATION, DESTINATION_BYTE, NBYTES = range(6)
"""Columns of a copy: the stream of the core, owner of the memory and byte there of each side, and how many bytes."""

OPERATION_COLUMNS, EVENT_COLUMNS, COPY_COLUMNS = w.OPERATION_WORDS, 3, 6

Table = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Place:
    """Some bytes of the memory of an owner."""

    owner: int
    first: int
    nbytes: int


class Accesses(NamedTuple):
    """Accesses, column by column: there may be millions in a frame, of which compiled code makes a log.

    `stamps`: cycle in its call; `places`: kind, and from KIND_BIT down the byte in the memory of its owner (`kernel.access_trace`).
    Both are steps from the access before, modulo 2^32. `owners`: of the memory; `sites`: of the core.
    """

    stamps: NDArray[np.uint32]
    places: NDArray[np.uint32]
    owners: NDArray[np.uint16]
    sites: NDArray[np.uint32]


ACCESS_COLUMNS = tuple(np.dtype(each) for each in ("<u4", "<u4", "<u2", "<u4"))


def accesses_of(entries: Table, sites: Table, owners: Table, firsts: Table) -> Accesses:
    """Return the columns of a log, the memory of whose entries belongs to `owners`, which begins at `firsts` in the arena."""
    places = (entries & ((1 << log.STAMP_BIT) - 1)) - firsts
    return Accesses(
        _steps(entries >> log.STAMP_BIT), _steps(places), owners.astype(np.uint16), sites.astype(np.uint32)
    )


def _steps(numbers: Table) -> NDArray[np.uint32]:
    return (np.diff(numbers, prepend=0) & 0xFFFF_FFFF).astype(np.uint32)


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameWork:
    """What one core did, from its call of `next_frame` to before the next one, or to its end.

    `operations`: rows of a kind and four numbers as in `bus.state`, with differences: of ACCESS the last two are how many accesses it
    has, and the number of its call among those prepared; SET_UP has register writes and reads before its account.
    `accesses`: of all calls one after the other. `events`: rows of a call's number here, a counter of the
    core and what that has counted since it was written down last, up to that call. `copies`: rows as above, and `accounts`,
    of those used for the first time. `calls`: name and arguments.
    """

    core: str
    operations: Table
    accesses: Accesses
    events: Table
    copies: Table
    calls: tuple[tuple[str, tuple[Any, ...]], ...]
    accounts: tuple[str, ...]


def check(work: FrameWork, owners: int) -> None:
    """Raise ValueError unless all numbers but those of accesses are such as the bus can play: a file may hold anything.

    `owners`: how many there are. Accesses are checked where they are translated.
    """
    operations, accesses = work.operations, len(work.accesses.stamps)
    kinds = operations[:, 0]
    counts, accounts = operations[kinds == w.ACCESS, 3], operations[kinds == w.SET_UP, 3]
    awaits = operations[kinds == w.AWAIT]
    ranges = (
        (kinds, 0, CALL),
        (operations[:, 1:], 0, 1 << 40),
        (accounts, 0, w.MAX_ACCOUNTS - 1),
        (awaits[:, 1], 1, w.ENDS - 1),
        (awaits[:, 2], w.SETTING_UP, w.RING_FULL),
        (awaits[:, 3], 0, w.MAX_ACCOUNTS - 1),
        (counts, 0, accesses),
        (work.copies[:, STREAM], 0, 1),
        (work.copies[:, [SOURCE, DESTINATION]], 0, owners - 1),
        (work.copies[:, [SOURCE_BYTE, DESTINATION_BYTE]], 0, log.OFFSET_MASK),
        (work.copies[:, NBYTES], 1, log.OFFSET_MASK),
        (work.events, 0, 1 << 40),
    )
    if any(
        len(each) and not (lowest <= each.min() and each.max() <= highest) for each, lowest, highest in ranges
    ):
        raise ValueError("a number is out of its range")
    if counts.sum() != accesses or (kinds == CALL).sum() != len(work.calls):
        raise ValueError("there must be as many accesses and calls as the operations have")
