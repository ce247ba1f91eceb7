"""The recorded work of a frame, written for a board, compiled: operations as a stretch, and their accesses in the log, where the bus finds them."""

from __future__ import annotations

from typing import Any

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import site_at
from bfsim.machine.retiming.frame_words import (
    ACCESS,
    ACCESS_DICTIONARY_ROWS,
    ACCESS_ROWS,
    ACCOUNTS,
    COPIES,
    COPY,
    DICTIONARIES_AT,
    IS_AT_CALL,
    MMR_READ,
    MMR_WRITE,
    NEXT,
    NO_CODE,
    NO_ROOM,
    NOT_THERE,
    ODD,
    OPERATION_DICTIONARY_ROWS,
    PLACE,
    ROWS,
    STAGES,
    Words,
    at_column,
)
from bfsim.machine.retiming.laid_dictionaries import (
    ACCESS_ENTRY_WORDS,
    IN_L1,
    LOGGED,
    SITE,
    operation_entry_at,
)
from bfsim.machine.retiming.packed_work import (
    ACCESSES,
    BYTE_STEP,
    ENTRY,
    OPERATIONS,
    STEP,
    Views,
    number_at,
)
from bfsim.machine.retiming.work import CALL, STAGE
from bfsim.machine.retiming.work_check import is_access

FROM_KIND = log.KIND_MASK << log.KIND_BIT


@native
def is_there(frame: Words, kind: int, one: int, three: int, four: int, calls: int) -> bool:
    """Whether everything exists that the numbers of an operation refer to. There are so many `calls`."""
    if kind == w.ACCESS:
        return four < calls
    if kind == w.COPY:
        return 0 <= one < frame[COPIES]
    if kind == STAGE:
        return one < frame[STAGES]
    return kind not in (w.SET_UP, w.AWAIT) or three < frame[ACCOUNTS]


@native
def write_accesses(state: w.State, core: int, frame: Words, views: Views, count: int, logged: int) -> int:
    """Append the next `count` accesses of a frame to the log of `logged` ones, without those to L1. Return how many are logged then."""
    into = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG
    (stamps, stamp_width), (entries, entry_width) = (
        at_column(frame, ACCESSES + STEP),
        at_column(frame, ACCESSES + ENTRY),
    )
    steps, step_width = at_column(frame, ACCESSES + BYTE_STEP)
    access, stamp, byte = frame[ACCESS], 0, frame[PLACE]
    if access + count > frame[ACCESS_ROWS]:
        return NOT_THERE
    if logged + count > w.LOG_ENTRIES:
        return NO_ROOM
    for number in range(access, access + count):
        stamp += number_at(views, stamps, stamp_width, number)
        byte += number_at(views, steps, step_width, number)
        entry = number_at(views, entries, entry_width, number)
        if not is_access(stamp, byte) or not 0 <= entry < frame[ACCESS_DICTIONARY_ROWS]:
            return ODD
        at = DICTIONARIES_AT + entry * ACCESS_ENTRY_WORDS
        word, site = frame[at + LOGGED], frame[at + SITE]
        if word != IN_L1:
            if (
                word & FROM_KIND == log.FETCHES << log.KIND_BIT
                and state[site_at(core, site) + w.CODE_WORDS] == 0
            ):
                return NO_CODE
            if (word & log.OFFSET_MASK) + byte > log.OFFSET_MASK:
                return NOT_THERE
            state[into + logged] = (stamp << log.STAMP_BIT) + word + byte
            state[into + w.LOG_ENTRIES + logged] = site
            logged += 1
    frame[ACCESS], frame[PLACE] = access + count, byte
    return logged


@native
def on_board(frame: Words, copies: Words, kind: int, one: int, two: int, three: int) -> tuple[int, int, int]:
    """Return the first three numbers, for the bus, of an operation other than a call with accesses."""
    if kind == w.SET_UP:
        return one * frame[MMR_WRITE] + two * frame[MMR_READ], three, 0
    if kind == w.COPY:
        return copies[3 * one], copies[3 * one + 1], copies[3 * one + 2]
    return one, two, three


@native_entry(
    "int64", "int64*", "int64", "int64*", "int8*", "int16*", "int32*", "int64*", "int64*", "int64*", "int64", "int64",
)  # fmt: skip
def write_stretch(
    state_at: Any, core: int, frame_at: Any, octets_at: Any, halves_at: Any, words_in_at: Any, longs_at: Any, copies_at: Any, kinds_at: Any,
    calls: int, must_look: int,
) -> int:  # fmt: skip
    """Write the next operations of a frame up to a call of its firmware or its end, or as many as fit a stretch. Return how many.

    The next time it goes on after the call. It also stops before the beginning of a stage if Python must look at the one that ends.

    The arrays: the words above; the octets of a `PackedWork` in each width; the numbers after COPY, a row for each copy; and the kind of
    operation of each of the `calls`.
    """
    state, frame = words_at(state_at), words_at(frame_at)
    views = words_at(octets_at), words_at(halves_at), words_at(words_in_at), words_at(longs_at)
    copies, kinds = words_at(copies_at), words_at(kinds_at)
    at, rows = w.OPERATIONS_AT + core * w.MAX_OPERATIONS * w.OPERATION_WORDS, frame[ROWS]
    entries, entry_width = at_column(frame, OPERATIONS)
    written = logged = 0
    frame[IS_AT_CALL] = 0
    while frame[NEXT] < rows and written < w.MAX_OPERATIONS:
        entry = number_at(views, entries, entry_width, frame[NEXT])
        if not 0 <= entry < frame[OPERATION_DICTIONARY_ROWS]:
            return ODD
        numbers = operation_entry_at(frame, entry)
        kind, one, two, three, four = (
            frame[numbers], frame[numbers + 1], frame[numbers + 2], frame[numbers + 3], frame[numbers + 4],
        )  # fmt: skip
        if kind == CALL:
            frame[IS_AT_CALL] = 1
            frame[NEXT] += 1
            break
        if kind == STAGE and must_look:
            break
        if kind == w.COPY:
            one = frame[COPY] = frame[COPY] + one
        if not is_there(frame, kind, one, three, four, calls):
            return NOT_THERE
        if kind == w.ACCESS:
            kind, begin = kinds[four], logged
            logged = write_accesses(state, core, frame, views, three, logged)
            if logged < 0:
                return logged
            three, four = begin, logged
        else:
            one, two, three = on_board(frame, copies, kind, one, two, three)
        state[at], state[at + 1], state[at + 2], state[at + 3], state[at + 4] = kind, one, two, three, four
        at += w.OPERATION_WORDS
        written += 1
        frame[NEXT] += 1
    return written
