"""The tape of a core that runs ahead, compiled: each operation is written where the bus plays it, as soon as the firmware asks for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel import access_trace as log
from bfsim.kernel import work as numbers
from bfsim.kernel.native import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.state import State
from bfsim.machine_code.built_in import built_in

(PLAN, FROM, TO, NUMBER, NBYTES) = range(5)
"""Of a copy: its plan, NONE if it has none yet, where it begins to read and to write, what is noted behind that, and how long it is."""
COPY_WORDS = 5
MOST_OPERATIONS, MOST_ACCESSES = w.MAX_OPERATIONS // 2, 1 << 16
"""What a tape has when it is full. Its room is larger, for a core cannot meet the others at every operation."""


@native
def end_of(state: State, core: int) -> int:
    """Return where the next operation of a core is to be written."""
    number = core * w.MAX_OPERATIONS + state[w.TAPES_AT + core * w.TAPE_WORDS + w.NOTED]
    return w.OPERATIONS_AT + number * w.OPERATION_WORDS


@native
def write(state: State, core: int, kind: int, one: int, two: int, three: int, four: int) -> bool:
    """Write an operation; return whether the tape is full."""
    at, tape = end_of(state, core), w.TAPES_AT + core * w.TAPE_WORDS
    state[at], state[at + 1], state[at + 2], state[at + 3], state[at + 4] = kind, one, two, three, four
    state[tape + w.NOTED] += 1
    kept = state[w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.KEPT]
    return state[tape + w.NOTED] > MOST_OPERATIONS or kept > MOST_ACCESSES


@native_entry("int64", "int64*", "int64", "int64", "int64", "int64", "int64", "int64")
def note(state_at: Any, core: int, kind: int, one: int, two: int, three: int, four: int) -> int:
    """Note an operation; return whether the tape is full."""
    return write(words_at(state_at), core, kind, one, two, three, four)


@native_entry("int64", "int64*", "int64", "int64*")
def note_run(state_at: Any, core: int, work_at: Any) -> int:
    """Note a call, by the numbers of its `Work`, that has met nobody, as one with those just before it; return how many operations were noted before: if none, it is not noted."""
    state: State = words_at(state_at)
    work: State = words_at(work_at)
    tape = w.TAPES_AT + core * w.TAPE_WORDS
    noted, last = state[tape + w.NOTED], end_of(state, core) - w.OPERATION_WORDS
    if noted > state[tape + w.MARKED] and state[last] == w.RUN:
        state[last + 1] += work[numbers.ISSUE_CCLK]
        state[last + 2] += work[numbers.STALL_CCLK]
    elif noted:
        write(state, core, w.RUN, work[numbers.ISSUE_CCLK], work[numbers.STALL_CCLK], 0, 0)
    return noted


@native_entry("int64", "int64*", "int64", "int64*")
def note_access(state_at: Any, core: int, work_at: Any) -> int:
    """Note a call, by its numbers, and keep its accesses, which it has just logged; return whether the tape is full."""
    state: State = words_at(state_at)
    work: State = words_at(work_at)
    trace = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS
    first = state[trace + log.KEPT]
    last = first + work[numbers.ACCESSES]
    state[trace + log.ENTRIES] = state[trace + log.KEPT] = last
    return write(state, core, w.ACCESS, work[numbers.ISSUE_CCLK], work[numbers.STALL_CCLK], first, last)


@native_entry("int64", "int64*", "uint8*", "int64", "int64*", "int64")
def note_copy(state_at: Any, memory_at: Any, core: int, copies_at: Any, number: int) -> int:
    """Do a copy, of a table of them; return the how-manieth of the core it is, or NONE if it has no plan yet."""
    state: State = words_at(state_at)
    memory, copies = words_at(memory_at), words_at(copies_at)
    tape, copy = w.TAPES_AT + core * w.TAPE_WORDS, number * COPY_WORDS
    if copies[copy + PLAN] == w.NONE:
        return w.NONE
    first, to = copies[copy + FROM], copies[copy + TO]
    for octet in range(copies[copy + NBYTES]):
        memory[to + octet] = memory[first + octet]
    write(state, core, w.COPY, copies[copy + PLAN], first, to, copies[copy + NUMBER])
    state[tape + w.NOTED_COPIES] += 1
    return state[tape + w.NOTED_COPIES] - 1


@native_entry("int64", "int64*", "int64", "int64", "int64", "int64")
def note_wait(state_at: Any, core: int, reason: int, account: int, copy: int) -> int:
    """Note that a core waits for the how-manieth of its copies; return whether the tape is full."""
    state = words_at(state_at)
    back = state[w.TAPES_AT + core * w.TAPE_WORDS + w.NOTED_COPIES] - copy
    return write(state, core, w.AWAIT, back, reason, account, 0)


class Tape:
    """The tape of one core, in the `state` of the bus; `memory`: all of the chip's.

    What notes an operation is a built-in function, and as much as can be is bound to it beforehand.
    """

    def __init__(self, core: int, state: NDArray[np.int64], memory: NDArray[Any]) -> None:
        self._core = core
        self._state = state
        self._memory = memory
        self._words: Any = state.data
        self._noted = w.TAPES_AT + core * w.TAPE_WORDS + w.NOTED
        self._first = w.OPERATIONS_AT + core * w.MAX_OPERATIONS * w.OPERATION_WORDS
        self.note_run = built_in(note_run.address(), 1, state.ctypes.data, core)
        self.note_access = built_in(note_access.address(), 1, state.ctypes.data, core)
        """Of a `Work`, by the address of its numbers."""

    def noting(
        self, kind: int, one: int = 0, two: int = 0, three: int = 0, four: int = 0
    ) -> Callable[[], int]:
        """Return what notes an operation."""
        return built_in(note.address(), 0, self._state.ctypes.data, self._core, kind, one, two, three, four)

    def copying(self, copies: NDArray[np.int64]) -> Callable[[int], int]:
        """Return what does a copy of a table, by its number there: see `note_copy`."""
        addresses = self._state.ctypes.data, self._memory.ctypes.data, self._core, copies.ctypes.data
        return built_in(note_copy.address(), 1, *addresses)

    def waiting(self, reason: int, account: int) -> Callable[[int], int]:
        """Return what notes a wait for a copy, the how-manieth of the core it is, and returns whether the tape is full."""
        return built_in(note_wait.address(), 1, self._state.ctypes.data, self._core, reason, account)

    @property
    def noted(self) -> int:
        """How many operations there are."""
        count: int = self._words[self._noted]
        return count

    def operations(self, first: int, end: int) -> NDArray[np.int64]:
        """Return operations, a row each."""
        rows = self._state[self._first : self._first + w.MAX_OPERATIONS * w.OPERATION_WORDS]
        return rows.reshape(-1, w.OPERATION_WORDS)[first:end]

    def mark(self) -> int:
        """Set a mark: calls before it and behind it are not noted as one. Return how many operations it is behind."""
        marked = self._words[self._noted + w.MARKED - w.NOTED] = self.noted
        return marked

    def clear(self) -> None:
        """Begin anew."""
        self._words[self._noted] = 0
        self.mark()
