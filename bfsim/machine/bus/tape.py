"""The tape of a core that runs ahead, compiled: each operation is written where the bus will play it, as soon as firmware asks for it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.calls import work as numbers
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.state import State
from bfsim.machine_code.built_in import built_in
from bfsim.machine_code.going_on import Noted

MOST_OPERATIONS, MOST_ACCESSES = w.MAX_OPERATIONS // 2, 1 << 16
"""The length of a full tape. There is room for more, because a core cannot meet the other devices at every operation."""


@native
def end_of(state: State, core: int) -> int:
    """Return where to write the next operation of a core."""
    number = core * w.MAX_OPERATIONS + state[w.TAPES_AT + core * w.TAPE_WORDS + w.NOTED]
    return w.OPERATIONS_AT + number * w.OPERATION_WORDS


@native
def write(
    state: State, core: int, kind: int, one: int, two: int, three: int, four: int, call: int = w.NONE
) -> int:
    """Write an operation, of a prepared call or of none. Return how many there are."""
    at, tape = end_of(state, core), w.TAPES_AT + core * w.TAPE_WORDS
    state[at], state[at + 1], state[at + 2], state[at + 3], state[at + 4] = kind, one, two, three, four
    state[at + w.OF_CALL] = call
    state[tape + w.NOTED] += 1
    kept = state[w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.KEPT]
    if state[tape + w.NOTED] > state[tape + w.MOST] or kept > MOST_ACCESSES:
        state[tape + w.IS_FULL] = 1
    return state[tape + w.NOTED]


@native_entry("int64", "int64*", "int64", "int64", "int64", "int64", "int64", "int64")
def note(state_at: Any, core: int, kind: int, one: int, two: int, three: int, four: int) -> int:
    """Note an operation. Return how many there are."""
    return write(words_at(state_at), core, kind, one, two, three, four)


@native_entry("int64", "int64*", "int64", "int64*", "int64")
def note_run(state_at: Any, core: int, work_at: Any, call: int) -> int:
    """Note a call that stays in L1, by the numbers of its `Work` and its own number. Return how many operations were noted before.

    If there were none, the call is not noted. Unless the time of each operation is kept, consecutive calls are noted as one.
    """
    state: State = words_at(state_at)
    work: State = words_at(work_at)
    tape = w.TAPES_AT + core * w.TAPE_WORDS
    noted, last = state[tape + w.NOTED], end_of(state, core) - w.OPERATION_WORDS
    if noted > state[tape + w.MARKED] and state[last] == w.RUN and state[tape + w.IS_TOLD] == 0:
        state[last + 1] += work[numbers.ISSUE_CCLK]
        state[last + 2] += work[numbers.STALL_CCLK]
    elif noted:
        write(state, core, w.RUN, work[numbers.ISSUE_CCLK], work[numbers.STALL_CCLK], 0, 0, call)
    return noted


@native_entry("int64", "int64*", "int64", "int64*", "int64")
def note_access(state_at: Any, core: int, work_at: Any, call: int) -> int:
    """Note a call, by the numbers of its `Work` and its own number, and keep the accesses it just logged. Return how many operations there are."""
    state: State = words_at(state_at)
    work: State = words_at(work_at)
    trace = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS
    first = state[trace + log.KEPT]
    last = first + work[numbers.ACCESSES]
    state[trace + log.ENTRIES] = state[trace + log.KEPT] = last
    return write(state, core, w.ACCESS, work[numbers.ISSUE_CCLK], work[numbers.STALL_CCLK], first, last, call)


class Tape:
    """The tape of one core, in the `state` of the bus. `memory` is the whole memory of the chip.

    Operations are noted by built-in functions.
    """

    def __init__(self, core: int, state: NDArray[np.int64], memory: NDArray[Any]) -> None:
        self.at = state.ctypes.data, memory.ctypes.data, core
        """The addresses of state and memory, and the core."""
        self.core = core
        self._state = state
        self._words: Any = state.data
        self._tape = w.TAPES_AT + core * w.TAPE_WORDS
        self._words[self._tape + w.MOST] = MOST_OPERATIONS
        first = state.ctypes.data + state.itemsize * self._tape
        self.takes_calls_at = first + state.itemsize * w.TAKES_CALLS
        self.calls = Noted(state.ctypes.data, core, first + state.itemsize * w.IS_FULL)
        """How machine code notes calls."""
        self._first = w.OPERATIONS_AT + core * w.MAX_OPERATIONS * w.OPERATION_WORDS
        self.note = built_in(note.address(), 5, state.ctypes.data, core)
        """Notes an operation: its kind and four numbers."""
        self.note_run = built_in(note_run.address(), 2, state.ctypes.data, core)
        self.note_access = built_in(note_access.address(), 2, state.ctypes.data, core)
        """These take the address of a `Work`'s numbers and the number of its call."""

    @property
    def noted(self) -> int:
        """Number of noted operations."""
        count: int = self._words[self._tape + w.NOTED]
        return count

    @property
    def is_full(self) -> bool:
        """Whether the core must meet the other devices before it notes more."""
        return bool(self._words[self._tape + w.IS_FULL])

    @is_full.setter
    def is_full(self, is_full: bool) -> None:
        self._words[self._tape + w.IS_FULL] = is_full

    @property
    def takes_calls(self) -> bool:
        """Whether calls are noted without Python."""
        return bool(self._words[self._tape + w.TAKES_CALLS])

    @takes_calls.setter
    def takes_calls(self, takes_calls: bool) -> None:
        self._words[self._tape + w.TAKES_CALLS] = takes_calls

    def operations(self, first: int, end: int) -> NDArray[np.int64]:
        """Return operations, one row each."""
        at = self._first + first * w.OPERATION_WORDS
        return self._state[at : self._first + end * w.OPERATION_WORDS].reshape(-1, w.OPERATION_WORDS)

    def tell(self) -> None:
        """Keep from now on what each operation takes."""
        self._words[self._tape + w.IS_TOLD] = 1

    def took(self, first: int, end: int) -> NDArray[np.int64]:
        """Return what played operations took, one row each, if that is kept."""
        at, end_at = (
            w.TOOK_AT + (self.core * w.MAX_OPERATIONS + each) * w.TOOK_WORDS for each in (first, end)
        )
        return self._state[at:end_at].reshape(-1, w.TOOK_WORDS)

    @property
    def played(self) -> int:
        """How many operations of the last stretch the bus has played."""
        count: int = self._words[w.PLAYS_AT + self.core * w.PLAY_WORDS + w.OPERATION]
        return count

    def mark(self) -> int:
        """Set a mark, so that calls before and after it are not noted as one. Return how many operations are before it."""
        marked = self._words[self._tape + w.MARKED] = self.noted
        return marked

    def clear(self) -> None:
        """Begin anew."""
        self._words[self._tape + w.NOTED] = 0
        self.is_full = False
        self.mark()
