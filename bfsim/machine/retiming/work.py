"""What a core did between two pictures that it took, without when: kernels' cycles and accesses, copies, waits, calls of its firmware.

Memory is named by its owner (`bus.memory_owners`) and the byte there, never by an address: another LDF may place it elsewhere.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.machine.bus import state as w

CALL, STAGE = w.MOMENT + 1, w.MOMENT
"""Operations besides those of a stretch (`bus.state`): the next call of its firmware, which is played in Python; and another stage from
now on, by its number. Both are *marks*, up to which is known what the kernels have counted."""

STAMP, KIND, OWNER, BYTE, SITE = range(5)
"""Columns of an access: cycle in its call, kind (`kernel.access_trace`), owner of the memory, byte there, and the core's site.

FETCHES have their number in place of the cycle, and no memory: the board that plays them knows where its code lies.
"""

STREAM, SOURCE, SOURCE_BYTE, DESTINATION, DESTINATION_BYTE, NBYTES = range(6)
"""Columns of a copy: the stream of the core, owner of the memory and byte there of each side, and how many bytes."""

OPERATION_COLUMNS, ACCESS_COLUMNS, EVENT_COLUMNS, COPY_COLUMNS = 5, 5, 3, 6

Table = NDArray[np.int64]
Accesses = NDArray[np.uint32]


@dataclass(frozen=True, slots=True)
class Place:
    """Some bytes of the memory of an owner."""

    owner: int
    first: int
    nbytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameWork:
    """What one core did, from its call of `next_frame` to before the next one, or to its end.

    `operations`: rows of a kind and four numbers as in `bus.state`, with differences: of ACCESS the last two are how many accesses it
    has, and the number of its call among those prepared; SET_UP has register writes and reads before its account.
    `accesses`: rows as above, of all calls one after the other; each column in one piece. `events`: rows of a mark's number here, a counter of the
    core and what that has counted since it was written down last, up to that mark. `copies`: rows as above, and `accounts` and `stages`,
    of those used for the first time. `calls`: name and arguments. `results`: what was published of the frame.
    """

    core: str
    operations: Table
    accesses: Accesses
    events: Table
    copies: Table
    calls: tuple[tuple[str, tuple[Any, ...]], ...]
    accounts: tuple[str, ...]
    stages: tuple[str, ...]
    results: Mapping[str, int]
