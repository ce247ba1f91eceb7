"""Whether the bus can play the numbers of `PackedWork`: a file may hold anything. The compiled checks run as each number is written."""

from __future__ import annotations

from bfsim.errors import WorkError, shown
from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.retiming.packed_work import PackedWork
from bfsim.machine.retiming.work import (
    CALL,
    DESTINATION,
    DESTINATION_BYTE,
    NBYTES,
    SOURCE,
    SOURCE_BYTE,
    STREAM,
)

LARGEST = 1 << 40
"""Limit of numbers of operations and events: as cycles, more than twenty minutes."""
STAMPS = 1 << 32
"""Limit of the cycles of a call: a later access would not fit into its log."""


@native
def is_number(number: int) -> bool:
    """Whether this is a valid number of an operation or of events."""
    return 0 <= number <= LARGEST


@native
def is_operation(kind: int, one: int, two: int, three: int, four: int) -> bool:
    """Whether these are valid numbers of an operation."""
    if not (is_number(one) and is_number(two) and is_number(three) and is_number(four)):
        return False
    if kind == w.SET_UP:
        return three < w.MAX_ACCOUNTS
    if kind == w.AWAIT:
        return 0 < one < w.ENDS and w.SETTING_UP <= two <= w.RING_FULL and three < w.MAX_ACCOUNTS
    return 0 <= kind <= CALL


@native
def is_access(stamp: int, byte: int) -> bool:
    """Whether these are valid numbers of an access."""
    return 0 <= stamp < STAMPS and 0 <= byte <= log.OFFSET_MASK


@native
def is_access_entry(kind: int, site: int) -> bool:
    """Whether these are valid numbers of an entry of accesses."""
    return 0 <= kind <= log.FETCHES and 0 <= site < w.MAX_SITES


def not_there(core: str, error: Exception) -> WorkError:
    """Return the error for work of a core in a file that cannot be played."""
    return WorkError(
        f"the work of core {core} must be as it was recorded, but names what is not there: {shown(error)}"
    )


def check(work: PackedWork, owners: int) -> None:
    """Raise ValueError unless all copies can be made. `owners` is the number of owners."""
    copies = work.copies
    if not len(copies):
        return  # most frames have no new ones
    ranges = (
        (copies[:, STREAM], 0, 1),
        (copies[:, [SOURCE, DESTINATION]], 0, owners - 1),
        (copies[:, [SOURCE_BYTE, DESTINATION_BYTE]], 0, log.OFFSET_MASK),
        (copies[:, NBYTES], 1, log.OFFSET_MASK),
    )
    for each, lowest, highest in ranges:
        if not (lowest <= each.min() and each.max() <= highest):
            raise ValueError("a number is out of its range")
