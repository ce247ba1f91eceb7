"""Whether numbers of `FrameWork` are such as the bus can play: a file may hold anything. Compiled, for a frame has some 400,000 of them."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.retiming.work import (
    BYTE,
    CALL,
    DESTINATION,
    DESTINATION_BYTE,
    KIND,
    NBYTES,
    OWNER,
    SITE,
    SOURCE,
    SOURCE_BYTE,
    STREAM,
    FrameWork,
)

LARGEST = 1 << 40
"""Of numbers of operations and events: cycles of more than twenty minutes."""
ODD = -1
"""Returned where a number is out of its range."""


@native
def is_operation(kind: int, one: int, two: int, three: int, four: int) -> bool:
    """Whether these are numbers of an operation."""
    if kind < 0 or kind > CALL or min(one, two, three, four) < 0 or max(one, two, three, four) > LARGEST:
        return False
    if kind == w.SET_UP:
        return three < w.MAX_ACCOUNTS
    if kind == w.AWAIT:
        return 0 < one < w.ENDS and w.SETTING_UP <= two <= w.RING_FULL and three < w.MAX_ACCOUNTS
    return True


@native_entry("int64", "int64*", "int64", "int64")
def calls_in(operations_at: Any, count: int, accesses: int) -> int:
    """Return how many of `count` operations are calls of firmware, ODD where one is none or they do not have so many `accesses`.

    The array: columns of operations, one after the other.
    """
    operations, calls = words_at(operations_at), 0
    for number in range(count):
        kind, three = operations[number], operations[3 * count + number]
        if not is_operation(
            kind,
            operations[count + number],
            operations[2 * count + number],
            three,
            operations[4 * count + number],
        ):
            return ODD
        if kind == w.ACCESS:
            accesses -= three
        elif kind == CALL:
            calls += 1
    return calls if accesses == 0 else ODD


@native_entry("int64", "uint32*", "int64", "int64")
def are_accesses(accesses_at: Any, count: int, owners: int) -> int:
    """Whether the columns of `count` accesses, one after the other, are such to memory of so many owners."""
    accesses = words_at(accesses_at)
    for number in range(count):
        if (
            accesses[KIND * count + number] > log.FETCHES
            or accesses[OWNER * count + number] >= owners
            or accesses[BYTE * count + number] > log.OFFSET_MASK
            or accesses[SITE * count + number] >= w.MAX_SITES
        ):
            return 0
    return 1


CHECK = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64)


def check(work: FrameWork, owners: int) -> None:
    """Raise ValueError unless all numbers are such as the bus can play. `owners`: how many there are."""
    operations, accesses = (np.ascontiguousarray(each.T) for each in (work.operations, work.accesses))
    count = operations.shape[1], accesses.shape[1]
    calls = CHECK(calls_in.address())(operations.ctypes.data, *count)
    if not CHECK(are_accesses.address())(accesses.ctypes.data, count[1], owners) or calls == ODD:
        raise ValueError(
            "a number is out of its range, or there are not as many accesses as the operations have"
        )
    if calls != len(work.calls):
        raise ValueError("there must be as many calls as the operations have")
    copies = work.copies
    ranges = (
        (copies[:, STREAM], 0, 1),
        (copies[:, [SOURCE, DESTINATION]], 0, owners - 1),
        (copies[:, [SOURCE_BYTE, DESTINATION_BYTE]], 0, log.OFFSET_MASK),
        (copies[:, NBYTES], 1, log.OFFSET_MASK),
        (work.events, 0, LARGEST),
    )
    for each, lowest, highest in ranges:
        if len(each) and not (lowest <= each.min() and each.max() <= highest):
            raise ValueError("a number is out of its range")
