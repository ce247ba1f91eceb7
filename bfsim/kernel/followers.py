"""The memory follower of the bound phase: what each access of a kernel outside L1 meets, access by access.

It runs inside the compiled kernel and only classifies and counts (L2, or SDRAM page hit, miss or conflict);
what a class costs is data of the chip, applied by the core. The open pages are the SDRAM device's own
table, so DMA bursts between two calls are seen; those during a call are not: they are weaved in later.
"""

from __future__ import annotations

import importlib
from enum import IntEnum
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

WRITE = 256  # `counters` adds it to an access's byte count when it writes
MAX_BANKS = 8


class Access(IntEnum):
    """Classes of accesses outside L1."""

    L2_READ = 0
    L2_WRITE = 1
    PAGE_HIT_READ = 2
    PAGE_MISS_READ = 3
    PAGE_CONFLICT_READ = 4
    PAGE_HIT_WRITE = 5
    PAGE_MISS_WRITE = 6
    PAGE_CONFLICT_WRITE = 7


# Words of the state.
FUNCTION, L2_FIRST, L2_END, SDRAM_FIRST, SDRAM_END, PAGE_BITS, BANK_BITS = range(7)
PAGES = 7
COUNTS = PAGES + MAX_BANKS
WORDS = COUNTS + len(Access)


class Follower:
    """State of the follower of one board. Compiling it waits until a kernel touches memory outside L1."""

    def __init__(
        self, l2: NDArray[np.uint8], sdram: NDArray[np.uint8], page_bits: int, bank_bits: int
    ) -> None:
        """`l2` and `sdram` are the host arrays that stand for the memories.

        A page is `2**page_bits` bytes and an SDRAM bank `2**bank_bits`.
        """
        self._state = np.zeros(WORDS, np.int64)
        self._state[L2_FIRST], self._state[L2_END] = l2.ctypes.data, l2.ctypes.data + l2.nbytes
        self._state[SDRAM_FIRST], self._state[SDRAM_END] = sdram.ctypes.data, sdram.ctypes.data + sdram.nbytes
        self._state[PAGE_BITS], self._state[BANK_BITS] = page_bits, bank_bits
        self.open_pages = self._state[PAGES:COUNTS]
        """Open page of each SDRAM bank, or -1; shared with the SDRAM device."""
        self.open_pages[:] = -1

    def address(self) -> int:
        """Return the host address of the state, ready to be followed."""
        if not self._state[FUNCTION]:
            self._state[FUNCTION] = _function_address()
        return int(self._state.ctypes.data)

    def take_counts(self) -> list[int]:
        """Return how many accesses of each class there were since the last call, in the order of `Access`."""
        counts = self._state[COUNTS:]
        taken: list[int] = counts.tolist()
        counts[:] = 0
        return taken


@cache
def _function_address() -> int:
    """Compile the follower, in half a second. numba is imported here: a run with every buffer in L1 needs none."""
    numba: Any = importlib.import_module("numba")
    carray, cfunc, types = numba.carray, numba.cfunc, numba.types

    word = types.int64

    @cfunc(types.void(types.CPointer(word), word, word))  # type: ignore[untyped-decorator]
    def follow(at: Any, address: int, access: int) -> None:
        state = carray(at, WORDS)
        write = access >= WRITE
        if state[SDRAM_FIRST] <= address < state[SDRAM_END]:
            offset = address - state[SDRAM_FIRST]
            page = offset >> state[PAGE_BITS]
            bank = PAGES + (offset >> state[BANK_BITS])
            kind = 0 if state[bank] == page else (1 if state[bank] < 0 else 2)
            state[bank] = page
            state[COUNTS + (5 if write else 2) + kind] += 1
        elif state[L2_FIRST] <= address < state[L2_END]:
            state[COUNTS + (1 if write else 0)] += 1

    return int(follow.address)
