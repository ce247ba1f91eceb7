"""The log of the access trace: the format of its entries, and the places of the words of its state."""

from __future__ import annotations

from enum import IntEnum

WRITE = 256  # `counters` adds it to an access's byte count when it writes

# An entry of the log: `stamp << STAMP_BIT | kind << KIND_BIT | offset in the arena`
KIND_BIT, STAMP_BIT = 28, 31
OFFSET_MASK, KIND_MASK = (1 << KIND_BIT) - 1, 7
LOAD, STORE, FILL, WRITE_BACK, FETCH, FETCH_LINE, TEST_AND_SET, FETCHES = range(8)
"""Kinds of entries. FETCHES, the last entry of a call, stands for all fetches of its code that no cache holds: their
number takes the place of the stamp, and the site is that of the routine that is fetched first (`bus.state`)."""

# Words of the state; the log follows them, and then the site of each of its entries (`call_paths`).
(
    FUNCTION,  # address of `trace_access`; compiled kernels call it
    ARENA, END,  # host addresses of the arena, and of the end of SDRAM and L2 in it
    ENTRIES,  # how many accesses there were
    ROOM,  # how many entries the log can have
    REGIONS,  # how many regions are cached
    LINE_BITS, SETS, WAYS,
    KEPT,  # how many entries of earlier calls are kept before those of the next
) = range(10)  # fmt: skip
MAX_REGIONS = 8
FIRST_REGION = 10  # first offset, end and policy of each
TAGS = (
    FIRST_REGION + 3 * MAX_REGIONS
)  # the lines of each set, the one used last first: number << 1 | whether changed; or EMPTY
MAX_LINES = 2048
LOG = TAGS + MAX_LINES
ENTRY_WORDS = 2
EMPTY = -1


class Policy(IntEnum):
    """How a cached region is written: at once and without allocation, or when a changed line leaves the cache."""

    WRITE_THROUGH = 0
    WRITE_BACK = 1


WRITE_BACK_POLICY = int(Policy.WRITE_BACK)  # as compiled code knows it
