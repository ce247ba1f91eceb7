"""The access trace of the bound phase: what each access of a kernel outside L1 asks of the memories.

It runs inside the compiled kernel and writes a log; the machine plays the log against the rest of the chip and adds the
waits. For cached regions it keeps the tags of the core's data cache, and logs only line fills, write-backs, and stores
that are written through. The stamp of an access is the cycle at which its block began, waits not included.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import KernelError
from bfsim.kernel.calls.access_log import (
    ARENA,
    EMPTY,
    END,
    ENTRIES,
    ENTRY_WORDS,
    FIRST_REGION,
    FUNCTION,
    KEPT,
    LINE_BITS,
    LOG,
    REGIONS,
    ROOM,
    SETS,
    TAGS,
    WAYS,
    Policy,
)
from bfsim.kernel.calls.traced_access import trace_access


@dataclass(frozen=True, slots=True)
class CachedRegion:
    """Part of the arena that a data cache holds lines of."""

    first: int
    end: int
    policy: Policy


@dataclass(frozen=True, slots=True)
class CacheSize:
    """A data cache: `nbytes` in all, in lines of `line_bytes`, `ways` of them in a set."""

    nbytes: int
    line_bytes: int
    ways: int

    @property
    def sets(self) -> int:
        """Number of sets."""
        return self.nbytes // (self.line_bytes * self.ways)


class AccessTrace:
    """The access trace of one core; its compiled part, `traced_access.py`, is made when a kernel first leaves L1."""

    def __init__(
        self,
        arena: NDArray[np.uint8],
        traced_nbytes: int,
        room: NDArray[np.int64],
        cached: Sequence[CachedRegion] = (),
        size: CacheSize | None = None,
    ) -> None:
        """`arena`: the host array of all memories; the first `traced_nbytes` of it are outside L1.

        `room`: where the state and the log go, LOG words and ENTRY_WORDS for each entry that the log can have.
        """
        self._arena = arena  # kept alive, since the state has only its address
        self._state = room
        self._words: Any = room.data
        self._at: int = room.ctypes.data  # numpy takes as long to find it as a short call takes
        self._state[TAGS:LOG] = EMPTY
        self._state[ARENA], self._state[END] = arena.ctypes.data, arena.ctypes.data + traced_nbytes
        self._room = self._state[ROOM] = (len(room) - LOG) // ENTRY_WORDS
        if size and cached:
            self._state[LINE_BITS], self._state[SETS], self._state[WAYS] = (
                size.line_bytes.bit_length() - 1,
                size.sets,
                size.ways,
            )
            self._state[REGIONS] = len(cached)
            for number, each in enumerate(cached):
                at = FIRST_REGION + 3 * number
                self._state[at : at + 3] = each.first, each.end, each.policy

    def address(self) -> int:
        """Return the host address of the state, ready to be traced."""
        if not self._state[FUNCTION]:
            self._state[FUNCTION] = trace_access.address()
        return self._at

    def address_of(self, word: int) -> int:
        """Return the host address of a word of the state."""
        return self._at + self._state.itemsize * word

    def logs(self, address: int) -> bool:
        """Whether accesses at a host address are logged, because it is outside L1."""
        return bool(self._state[ARENA] <= address < self._state[END])

    def drop(self) -> None:
        """Drop all entries, those of earlier calls too."""
        self._words[ENTRIES] = self._words[KEPT] = 0

    def entries(self, count: int) -> NDArray[np.int64]:
        """Return the first `count` entries after those that are kept: those of the last call."""
        first = LOG + self._words[KEPT]
        return self._state[first : first + count]

    def sites(self, count: int) -> NDArray[np.int64]:
        """Return the sites of those entries."""
        first = LOG + self._room + self._words[KEPT]
        return self._state[first : first + count]

    def check_room(self, count: int) -> None:
        """Raise KernelError if the log has no room for `count` accesses of a call."""
        room = self._room - self._words[KEPT]
        if count > room:
            raise KernelError(
                f"a kernel call must access memory outside L1 at most {room} times, not {count} times: split it"
            )

    def caches(self, offset: int) -> bool:
        """Whether the data cache holds lines of the memory at `offset`."""
        count = self._words[REGIONS]
        if not count:  # most boards have none, and each ring asks
            return False
        regions = self._state[FIRST_REGION : FIRST_REGION + 3 * count].reshape(-1, 3)
        return any(first <= offset < end for first, end, _ in regions.tolist())

    def forget(self, first: int, nbytes: int) -> int:
        """Invalidate the cached lines of `nbytes` from `first` without writing them back; return how many there can be."""
        if not self._state[SETS]:
            return 0
        bits = int(self._state[LINE_BITS])
        low, high = first >> bits, (first + nbytes - 1) >> bits
        tags = self._state[TAGS:LOG]
        tags[(tags != EMPTY) & (tags >> 1 >= low) & (tags >> 1 <= high)] = EMPTY
        return high - low + 1
