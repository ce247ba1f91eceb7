"""What a core did, compiled: written into the state of the bus as this board plays it, stretch by stretch.

Memory is where this board's LDF has it, accesses to what is in L1 here are left out, and registers take the cycles of this chip.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from ctypes import CFUNCTYPE, c_int64, c_void_p
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import EventSpec
from bfsim.kernel import access_trace as log
from bfsim.kernel.native import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.state import State
from bfsim.machine.retiming.work import FrameWork

(
    CORE,
    BEGIN, END,  # operations: the next one, and the one behind the last of the stretch
    ACCESS,  # number of the next access
    STAMP, PLACE,  # of the access before it
    OWNERS, CALLS, COPIES,  # how many of each there are
    WRITE_CCLK, READ_CCLK,  # what it takes to write or read a register
) = range(11)  # fmt: skip
"""Words of a translation on its way, in one array."""

BROKEN = -1
WORD = 0xFFFF_FFFF


@native
def log_call(
    state: State,
    words: State,
    stamps: State,
    places: State,
    owners: State,
    sites: State,
    firsts: State,
    outside: State,
    count: int,
    logged: int,
) -> int:
    """Log the next `count` accesses, those of a call, behind so many that are `logged`; return how many are then, or BROKEN."""
    room = w.LOGS_AT + words[CORE] * w.ACCESS_TRACE_WORDS + log.LOG
    stamp, place = words[STAMP], words[PLACE]
    for access in range(words[ACCESS], words[ACCESS] + count):
        stamp, place = (stamp + stamps[access]) & WORD, (place + places[access]) & WORD
        owner = owners[access]
        if (
            owner >= words[OWNERS]
            or place >> log.KIND_BIT > log.FETCH_LINE
            or sites[access] >= w.MAX_SITES
            or firsts[owner] + (place & log.OFFSET_MASK) > log.OFFSET_MASK
        ):
            return BROKEN
        if outside[owner]:
            state[room + logged] = stamp << log.STAMP_BIT | firsts[owner] + place
            state[room + w.LOG_ENTRIES + logged] = sites[access]
            logged += 1
    words[ACCESS] += count
    words[STAMP], words[PLACE] = stamp, place
    return logged


@native_entry(
    "int64", "int64*", "int64*", "int64*", "uint32*", "uint32*", "uint16*", "uint32*", "int64*", "int64*", "int64*", "int64*",
)  # fmt: skip
def translate(
    state_at: State,
    words_of_it: State,
    operations_at: State,
    stamps_at: State,
    places_at: State,
    owners_at: State,
    sites_at: State,
    firsts_at: State,
    outside_at: State,
    calls_at: State,
    plans_at: State,
) -> int:
    """Translate operations up to END, or as many as there is room for; return how many, BROKEN if they name what is not there."""
    state, words, operations = words_at(state_at), words_at(words_of_it), words_at(operations_at)
    stamps, places, owners, sites = (
        words_at(stamps_at), words_at(places_at), words_at(owners_at), words_at(sites_at),
    )  # fmt: skip
    firsts, outside, calls, plans = (
        words_at(firsts_at), words_at(outside_at), words_at(calls_at), words_at(plans_at),
    )  # fmt: skip
    to = w.OPERATIONS_AT + words[CORE] * w.MAX_OPERATIONS * w.OPERATION_WORDS
    begin, end, logged = words[BEGIN], min(words[END], words[BEGIN] + w.MAX_OPERATIONS), 0
    while words[BEGIN] < end:
        at = words[BEGIN] * w.OPERATION_WORDS
        kind, first, second = operations[at], operations[at + 1], operations[at + 2]
        third, fourth = operations[at + 3], operations[at + 4]
        if kind == w.ACCESS:
            if logged + third > w.LOG_ENTRIES:
                break
            before = logged
            logged = log_call(
                state, words, stamps, places, owners, sites, firsts, outside, third, logged,
            )  # fmt: skip
            if logged == BROKEN or fourth >= words[CALLS]:
                return BROKEN
            kind, third, fourth = calls[fourth], before, logged
        elif kind == w.SET_UP:
            first, second = first * words[WRITE_CCLK] + second * words[READ_CCLK], third
        elif kind == w.COPY:
            if first >= words[COPIES]:
                return BROKEN
            first = plans[first]
        state[to], state[to + 1], state[to + 2] = kind, first, second
        state[to + 3], state[to + 4] = third, fourth
        to += w.OPERATION_WORDS
        words[BEGIN] += 1
    return int(words[BEGIN] - begin)


CALL = CFUNCTYPE(c_int64, *[c_void_p] * 11)
MAX_CALLS = 1 << 17
"""Kernels with their arguments that a core may call."""


class Translator:
    """Translates the work of one core into the state of a bus, whose chip takes so long for `events`."""

    def __init__(self, bus: Bus, core: int, events: EventSpec) -> None:
        self._bus = bus
        self._firsts = np.array(bus.owners.first, np.int64)
        self._outside = (self._firsts < int(bus.words[w.L2_END])).astype(np.int64)
        self._kinds, self._plans = np.zeros(MAX_CALLS, np.int64), np.zeros(w.MAX_PLANS, np.int64)
        self._words = np.zeros(11, np.int64)
        self._words[[CORE, OWNERS, WRITE_CCLK, READ_CCLK]] = (
            core, len(self._firsts), events.mmr_write_cclk, events.mmr_read_cclk,
        )  # fmt: skip
        self._translate: Callable[[], int]

    def add_call(self, kind: int) -> None:
        """Note what the next call that was prepared is to the bus: RUN or ACCESS. Raises IndexError where there is no room for it."""
        self._kinds[self._words[CALLS]] = kind
        self._words[CALLS] += 1

    def add_copies(self, plans: NDArray[np.int64]) -> None:
        """Note the plans of the next copies."""
        count = int(self._words[COPIES])
        self._plans[count : count + len(plans)] = plans
        self._words[COPIES] = count + len(plans)

    def begin(self, work: FrameWork) -> None:
        """Begin with a frame."""
        self._words[[BEGIN, ACCESS, STAMP, PLACE]] = 0
        arrays = (
            self._bus.state, self._words, np.ascontiguousarray(work.operations), *work.accesses,
            self._firsts, self._outside, self._kinds, self._plans,
        )  # fmt: skip
        self._translate = compiled(*arrays)

    def stretches(self, end: int) -> Iterator[int]:
        """Write what comes before operation `end`, and the call of firmware there, into the bus; yield how many operations that is.

        Most often it is one stretch; where there is no room for all at once, what was yielded must be played first. Raises
        ValueError for what cannot be played.
        """
        self._words[END] = end
        while self._words[BEGIN] < end:
            operations = int(self._translate())
            if operations in (BROKEN, 0):  # or a call has more accesses than there is room for
                raise ValueError("an access, a call or a copy is out of its range")
            yield operations
        self._words[BEGIN] = end + 1


def compiled(*arrays: NDArray[Any]) -> Callable[[], int]:
    """Bind the compiled `translate` to its arrays."""
    places = [each.ctypes.data_as(c_void_p) for each in arrays]  # these keep the arrays
    return partial(CALL(translate.address()), *places)
