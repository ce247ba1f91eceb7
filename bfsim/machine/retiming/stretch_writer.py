"""What was recorded of a frame, written for a board, compiled: operations as a stretch, and the log of their accesses, where the bus has them."""

from __future__ import annotations

from collections.abc import MutableSequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.block_spec import EventSpec
from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import site_at
from bfsim.machine.retiming.work import BYTE, CALL, KIND, OWNER, SITE, STAMP, FrameWork, Table
from bfsim.machine_code.built_in import built_in

IN_L1 = -1
"""Where an owner begins whose memory is in L1: what accesses it is not in the log."""
NOT_THERE, NO_CODE, NO_ROOM = -1, -2, -3
"""Returned in place of a number of operations: what one refers to is not there, or no code, or no room for the log."""
PROBLEMS = {
    NOT_THERE: "a call, a copy, an account, a counter or memory that is not there",
    NO_CODE: "code is fetched from where none lies",
    NO_ROOM: "more accesses than a core has room for",
}

# What is written: words of one array.
(
    ROWS, NEXT,        # operations of the frame, and the next one to be written
    ACCESSES, ACCESS,  # the same of accesses,
    EVENTS, EVENT,     # and of rows of events,
    PASSED,            # which are counted up to this call of firmware
    COPIES, ACCOUNTS,  # how many there are of each so far
    MMR_WRITE, MMR_READ,  # cycles of a core for a register
) = range(11)  # fmt: skip
FRAME_WORDS = 11

Words = MutableSequence[int]


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
    state: w.State, core: int, frame: Words, accesses: Words, firsts: Words, count: int, logged: int
) -> int:
    """Write the next `count` accesses of a frame behind those that are `logged`, without those to L1; return how many are logged then."""
    entries = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG
    rows, access = frame[ACCESSES], frame[ACCESS]
    if access + count > rows:
        return NOT_THERE
    if logged + count > w.LOG_ENTRIES:
        return NO_ROOM
    frame[ACCESS] = access + count
    for number in range(access, access + count):
        first = firsts[accesses[OWNER * rows + number]]
        if first != IN_L1:
            stamp, kind = accesses[STAMP * rows + number], accesses[KIND * rows + number]
            site = accesses[SITE * rows + number]
            if kind == log.FETCHES and state[site_at(core, site) + w.CODE_WORDS] == 0:
                return NO_CODE
            place = first + accesses[BYTE * rows + number]
            if place > log.OFFSET_MASK:
                return NOT_THERE
            state[entries + logged] = stamp << log.STAMP_BIT | kind << log.KIND_BIT | place
            state[entries + w.LOG_ENTRIES + logged] = site
            logged += 1
    return logged


@native
def pass_call(frame: Words, events: Words, counters: Words, count: int) -> int:
    """Count the events up to the next call of firmware, and go on behind it; return 0, or NOT_THERE for a counter not among `count`.

    The arrays: the words above, columns of events one after the other, and the core's counters.
    """
    rows = frame[EVENTS]
    while frame[EVENT] < rows and events[frame[EVENT]] == frame[PASSED]:
        counter = events[rows + frame[EVENT]]
        if counter >= count:
            return NOT_THERE
        counters[counter] += events[2 * rows + frame[EVENT]]
        frame[EVENT] += 1
    frame[PASSED] += 1
    frame[NEXT] += 1
    return 0


@native_entry(
    "int64", "int64*", "int64", "int64*", "int64*", "uint32*", "int64*", "int64*", "int64*",
    "int64*", "int64", "int64*", "int64",
)  # fmt: skip
def write_stretch(
    state_at: Any, core: int, frame_at: Any, operations_at: Any, accesses_at: Any, events_at: Any, firsts_at: Any, copies_at: Any,
    kinds_at: Any, calls: int, counters_at: Any, counters: int,
) -> int:  # fmt: skip
    """Write the next operations of a frame up to a call of its firmware or its end, or as many as a stretch can have; return how many.

    Where they are fewer than that it goes on behind the call, up to which the core's kernels have counted their events.

    The arrays: the words above; columns of operations, of accesses and of events one after the other; where the memory of each owner
    begins or IN_L1; rows of what is behind COPY for each copy; what running each of so many `calls` is to the bus; and the core's counters.
    """
    state, frame, operations, accesses = (
        words_at(state_at),
        words_at(frame_at),
        words_at(operations_at),
        words_at(accesses_at),
    )
    firsts, copies, kinds = words_at(firsts_at), words_at(copies_at), words_at(kinds_at)
    at, rows = w.OPERATIONS_AT + core * w.MAX_OPERATIONS * w.OPERATION_WORDS, frame[ROWS]
    written = logged = 0
    while frame[NEXT] < rows and written < w.MAX_OPERATIONS:
        number = frame[NEXT]
        kind, one, two = operations[number], operations[rows + number], operations[2 * rows + number]
        three, four = operations[3 * rows + number], operations[4 * rows + number]
        if kind == CALL:
            passed = pass_call(frame, words_at(events_at), words_at(counters_at), counters)
            return passed if passed < 0 else written
        if not is_there(frame, kind, one, three, four, calls):
            return NOT_THERE
        if kind == w.ACCESS:
            kind, begin = kinds[four], logged
            logged = write_accesses(state, core, frame, accesses, firsts, three, logged)
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
        frame[NEXT] = number + 1
    return written


class StretchWriter:
    """Writes the stretches of one frame's `work` into the `state` of a bus, its words, for a core.

    `firsts`: where in the arena the memory of each owner begins, IN_L1 for what lies there; `copies`: rows of what is behind COPY for
    each copy; `accounts`: how many there are; `events`: what the core takes for registers.
    """

    def __init__(
        self, state: Any, core: int, work: FrameWork, firsts: NDArray[np.int64], copies: Table, accounts: int, events: EventSpec
    ) -> None:  # fmt: skip
        words = np.zeros(FRAME_WORDS, np.int64)
        words[[ROWS, ACCESSES, EVENTS]] = len(work.operations), len(work.accesses), len(work.events)
        words[[COPIES, ACCOUNTS]] = len(copies), accounts
        words[[MMR_WRITE, MMR_READ]] = events.mmr_write_cclk, events.mmr_read_cclk
        tables = (np.ascontiguousarray(each.T) for each in (work.operations, work.accesses, work.events))
        self._kept = words, *tables, firsts, copies
        self._write = built_in(
            write_stretch.address(), 4, np.asarray(state).ctypes.data, core, *(each.ctypes.data for each in self._kept)
        )  # fmt: skip

    def write(self, kinds_at: int, calls: int, counters_at: int, counters: int) -> int:
        """Write the next stretch and return how many operations it has: if fewer than it can have, all up to the next call of firmware.

        The addresses of arrays, and how many they have: of each call that is prepared by now, what running it is to the bus; and the
        core's counters, which count what its kernels have until that call. Raises ValueError for what is not there.
        """
        written = self._write(kinds_at, calls, counters_at, counters)
        if written < 0:
            raise ValueError(PROBLEMS[written])
        return written
