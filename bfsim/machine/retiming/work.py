"""What a core did between taking two pictures, but not when: cycles and accesses of kernels, copies, waits, calls of its firmware.

Memory is named by its owner (`bus.memory_owners`) and the byte there, never by address: another LDF may place it elsewhere.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.machine.bus import state as w

CALL, STAGE = w.MOMENT + 1, w.MOMENT
"""Operations besides those of a stretch (`bus.state`): the next call of firmware, which Python plays; and the beginning of another
stage, by its number. Both are *marks*: the kernels' counts up to each of them are known."""

STAMP, KIND, OWNER, BYTE, SITE = range(5)
"""Columns of an access: cycle in its call, kind (`kernel.access_trace`), owner of the memory, byte there, and the core's site.

FETCHES have their number instead of the cycle, and no memory: the board that plays them knows where its code lies.
"""

STREAM, SOURCE, SOURCE_BYTE, DESTINATION, DESTINATION_BYTE, NBYTES = range(6)
"""Columns of a copy: the stream of the core, owner and byte of each side's memory, and the number of bytes."""

OPERATION_COLUMNS, ACCESS_COLUMNS, EVENT_COLUMNS, COPY_COLUMNS = 5, 5, 3, 6

Table = NDArray[np.int64]
Accesses = NDArray[np.uint32]


@dataclass(frozen=True, slots=True)
class Place:
    """Some bytes of an owner's memory."""

    owner: int
    first: int
    nbytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameWork:
    """What one core did, from its call of `next_frame` to just before the next one, or to its end.

    `operations` has rows of a kind and four numbers as in `bus.state`, with two differences: the last two of ACCESS are the number of
    its accesses and the number of its prepared call; SET_UP has register writes and reads before its account. `accesses` has rows as
    above, of all calls one after the other; each column is contiguous. `events` has rows of a mark's number here, a counter of the
    core, and its increase up to that mark. `copies` (rows as above), `accounts` and `stages` have those used for the first time.
    `calls` has names and arguments. `results` are the numbers published for the frame.
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
