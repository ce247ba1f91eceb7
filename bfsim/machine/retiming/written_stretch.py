"""What was recorded of a frame, written for a board, compiled: operations as a stretch, and the log of their accesses, where the bus has them."""

from __future__ import annotations

from collections.abc import MutableSequence
from typing import Any

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import site_at
from bfsim.machine.retiming.packed_work import (
    ACCESSES,
    BEGIN,
    COLUMN_WORDS,
    EVENTS,
    OPERATIONS,
    WIDTH,
    Views,
    number_at,
)
from bfsim.machine.retiming.work import BYTE, CALL, KIND, OWNER, SITE, STAMP
from bfsim.machine.retiming.work_check import is_access, is_number, is_operation

IN_L1 = -1
"""Where an owner begins whose memory is in L1: what accesses it is not in the log."""
NOT_THERE, NO_CODE, NO_ROOM, ODD = -1, -2, -3, -4
"""Returned in place of a number of operations: what one refers to is not there, or no code, no room for the log, or a number is none."""

# What is written: words of one array. Behind them are those of the columns (`packed_work`).
(
    ROWS, NEXT,        # operations of the frame, and the next one to be written
    ACCESS_ROWS, ACCESS, PLACE,    # the same of accesses, and the byte of the last one,
    EVENT_ROWS, EVENT, COUNTER,    # and of rows of events, and the counter of the last one,
    PASSED,            # which are counted up to this call of firmware
    COPIES, ACCOUNTS, OWNERS,  # how many there are of each so far
    MMR_WRITE, MMR_READ,  # cycles of a core for a register
) = range(14)  # fmt: skip
FRAME_WORDS = 14

Words = MutableSequence[int]


@native
def at_column(frame: Words, number: int) -> tuple[int, int]:
    """Return where a column begins, and the number of its width."""
    at = FRAME_WORDS + number * COLUMN_WORDS
    return frame[at + BEGIN], frame[at + WIDTH]


@native
def is_there(frame: Words, kind: int, one: int, three: int, four: int, calls: int) -> bool:
    """Whether what the numbers of an operation refer to is there, of so many `calls`."""
    if kind == w.ACCESS:
        return four < calls
    if kind == w.COPY:
        return one < frame[COPIES]
    return kind not in (w.SET_UP, w.AWAIT) or three < frame[ACCOUNTS]


@native
def write_accesses(
    state: w.State, core: int, frame: Words, views: Views, firsts: Words, count: int, logged: int
) -> int:
    """Write the next `count` accesses of a frame behind those that are `logged`, without those to L1; return how many are logged then."""
    entries = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG
    (stamps, stamp_width), (kinds, kind_width) = (
        at_column(frame, ACCESSES + STAMP), at_column(frame, ACCESSES + KIND),
    )  # fmt: skip
    (owners, owner_width), (steps, step_width) = (
        at_column(frame, ACCESSES + OWNER), at_column(frame, ACCESSES + BYTE),
    )  # fmt: skip
    sites, site_width = at_column(frame, ACCESSES + SITE)
    access, stamp, byte, known = frame[ACCESS], 0, frame[PLACE], frame[OWNERS]
    if access + count > frame[ACCESS_ROWS]:
        return NOT_THERE
    if logged + count > w.LOG_ENTRIES:
        return NO_ROOM
    for number in range(access, access + count):
        stamp += number_at(views, stamps, stamp_width, number)
        byte += number_at(views, steps, step_width, number)
        kind, owner = (
            number_at(views, kinds, kind_width, number), number_at(views, owners, owner_width, number),
        )  # fmt: skip
        site = number_at(views, sites, site_width, number)
        if not is_access(stamp, kind, byte, site) or not 0 <= owner < known:
            return ODD
        first = firsts[owner]
        if first != IN_L1:
            if kind == log.FETCHES and state[site_at(core, site) + w.CODE_WORDS] == 0:
                return NO_CODE
            if first + byte > log.OFFSET_MASK:
                return NOT_THERE
            state[entries + logged] = stamp << log.STAMP_BIT | kind << log.KIND_BIT | first + byte
            state[entries + w.LOG_ENTRIES + logged] = site
            logged += 1
    frame[ACCESS], frame[PLACE] = access + count, byte
    return logged


@native
def pass_call(frame: Words, views: Views, counters: Words, count: int) -> int:
    """Count the events up to the next call of firmware, and go on behind it; return 0, or NOT_THERE for a counter not among `count`."""
    (calls, call_width), (steps, step_width) = at_column(frame, EVENTS), at_column(frame, EVENTS + 1)
    amounts, amount_width = at_column(frame, EVENTS + 2)
    event, counter = frame[EVENT], frame[COUNTER]
    while event < frame[EVENT_ROWS] and number_at(views, calls, call_width, event) == frame[PASSED]:
        counter += number_at(views, steps, step_width, event)
        amount = number_at(views, amounts, amount_width, event)
        if not 0 <= counter < count:
            return NOT_THERE
        if not is_number(amount):
            return ODD
        counters[counter] += amount
        event += 1
    frame[EVENT], frame[COUNTER] = event, counter
    frame[PASSED] += 1
    frame[NEXT] += 1
    return 0


@native
def operation_at(frame: Words, views: Views, row: int) -> tuple[int, int, int, int, int]:
    """Return the numbers of an operation."""
    (at, width), (one_at, one_width) = at_column(frame, OPERATIONS), at_column(frame, OPERATIONS + 1)
    (two_at, two_width), (three_at, three_width) = (
        at_column(frame, OPERATIONS + 2), at_column(frame, OPERATIONS + 3),
    )  # fmt: skip
    four_at, four_width = at_column(frame, OPERATIONS + 4)
    return (
        number_at(views, at, width, row),
        number_at(views, one_at, one_width, row),
        number_at(views, two_at, two_width, row),
        number_at(views, three_at, three_width, row),
        number_at(views, four_at, four_width, row),
    )


@native_entry(
    "int64", "int64*", "int64", "int64*", "int8*", "int16*", "int32*", "int64*", "int64*", "int64*",
    "int64*", "int64", "int64*", "int64",
)  # fmt: skip
def write_stretch(
    state_at: Any, core: int, frame_at: Any, octets_at: Any, halves_at: Any, words_in_at: Any, longs_at: Any, firsts_at: Any,
    copies_at: Any, kinds_at: Any, calls: int, counters_at: Any, counters: int,
) -> int:  # fmt: skip
    """Write the next operations of a frame up to a call of its firmware or its end, or as many as a stretch can have; return how many.

    Where they are fewer than that it goes on behind the call, up to which the core's kernels have counted their events.

    The arrays: the words above; the octets of a `PackedWork` in each of its widths; where the memory of each owner begins or IN_L1; rows of
    what is behind COPY for each copy; what running each of so many `calls` is to the bus; and the core's counters.
    """
    state, frame, firsts = words_at(state_at), words_at(frame_at), words_at(firsts_at)
    views = words_at(octets_at), words_at(halves_at), words_at(words_in_at), words_at(longs_at)
    copies, kinds = words_at(copies_at), words_at(kinds_at)
    at, rows = w.OPERATIONS_AT + core * w.MAX_OPERATIONS * w.OPERATION_WORDS, frame[ROWS]
    written = logged = 0
    while frame[NEXT] < rows and written < w.MAX_OPERATIONS:
        kind, one, two, three, four = operation_at(frame, views, frame[NEXT])
        if not is_operation(kind, one, two, three, four):
            return ODD
        if kind == CALL:
            passed = pass_call(frame, views, words_at(counters_at), counters)
            return passed if passed < 0 else written
        if not is_there(frame, kind, one, three, four, calls):
            return NOT_THERE
        if kind == w.ACCESS:
            kind, begin = kinds[four], logged
            logged = write_accesses(state, core, frame, views, firsts, three, logged)
            if logged < 0:
                return logged
            three, four = begin, logged
        elif kind == w.SET_UP:
            one, two = one * frame[MMR_WRITE] + two * frame[MMR_READ], three
        elif kind == w.COPY:
            copy = 3 * one
            one, two, three = copies[copy], copies[copy + 1], copies[copy + 2]
        state[at], state[at + 1], state[at + 2], state[at + 3], state[at + 4] = kind, one, two, three, four
        at += w.OPERATION_WORDS
        written += 1
        frame[NEXT] += 1
    return written
