"""The lines of a ring on the tape of a core that runs ahead, compiled: they are copied, and all their operations are noted.

The lines have words that stay the same each time the ring is made: HEAD of them, then COPY_WORDS for each line. The ring itself
has DONE, DEPTH and, from LATEST on, copies.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from bfsim.kernel.native.entries import NativeEntry, native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.state import State
from bfsim.machine.bus.tape import Tape, write
from bfsim.machine_code.answers import answering
from bfsim.machine_code.built_in import built_in

(COUNT, ACCOUNT, REASON, SET_UP_CCLK, SET_UP_WRITES, SET_UP_READS) = range(6)
"""The number of lines, the account of the ring, the reason of stalls for a line, and the cycles of programming the stream with so
many writes and reads of registers."""
HEAD = 6
(PLAN, FROM, TO, NUMBER, NBYTES) = range(5)
"""Fields of a copy: its plan (NONE if it has none yet), where it begins to read and to write, the number noted after these, and its length."""
COPY_WORDS = 5
(DONE, DEPTH, LATEST) = range(3)
"""Fields of a ring: how many lines were taken or sent, its number of rows, and copies. An input ring has the copy of its next line, NONE if
that is not on its way. An output ring has the copy of the last line of each row."""


@native
def runs_ahead(state: State, core: int) -> bool:
    """Whether a core runs ahead and notes its operations."""
    return state[w.TAPES_AT + core * w.TAPE_WORDS + w.TAKES_CALLS] != 0


@native
def has_plan(lines: State, number: int) -> bool:
    """Whether a line's copy has its plan already."""
    return lines[HEAD + number * COPY_WORDS + PLAN] != w.NONE


@native
def program(state: State, core: int, lines: State) -> int:
    """Note that the stream is programmed. Return how many operations there are."""
    cclk, writes, reads = lines[SET_UP_CCLK], lines[SET_UP_WRITES], lines[SET_UP_READS]
    return write(state, core, w.SET_UP, cclk, lines[ACCOUNT], writes, reads)


@native
def copy(state: State, memory: State, core: int, lines: State, number: int) -> int:
    """Copy a line that has a plan. Return the copy's number among those of the core."""
    tape, at = w.TAPES_AT + core * w.TAPE_WORDS, HEAD + number * COPY_WORDS
    first, to = lines[at + FROM], lines[at + TO]
    for octet in range(lines[at + NBYTES]):
        memory[to + octet] = memory[first + octet]
    write(state, core, w.COPY, lines[at + PLAN], first, to, lines[at + NUMBER])
    state[tape + w.NOTED_COPIES] += 1
    return state[tape + w.NOTED_COPIES] - 1


@native
def wait(state: State, core: int, lines: State, copied: int) -> int:
    """Note that the core waits for its copy number `copied`. Return how many operations there are."""
    back = state[w.TAPES_AT + core * w.TAPE_WORDS + w.NOTED_COPIES] - copied
    return write(state, core, w.AWAIT, back, lines[REASON], lines[ACCOUNT], 0)


@native_entry("int64", "int64*", "uint8*", "int64", "int64*")
def note_program(state_at: Any, _memory_at: Any, core: int, lines_at: Any) -> int:
    """Note that the stream is programmed. Return how many operations there are."""
    return program(words_at(state_at), core, words_at(lines_at))


@native_entry("int64", "int64*", "uint8*", "int64", "int64*", "int64")
def note_copy(state_at: Any, memory_at: Any, core: int, lines_at: Any, number: int) -> int:
    """Copy a line. Return the copy's number among those of the core, or NONE if the line has no plan yet."""
    state, memory, lines = words_at(state_at), words_at(memory_at), words_at(lines_at)
    return copy(state, memory, core, lines, number) if has_plan(lines, number) else w.NONE


@native_entry("int64", "int64*", "uint8*", "int64", "int64*", "int64")
def note_wait(state_at: Any, _memory_at: Any, core: int, lines_at: Any, copied: int) -> int:
    """Note that the core waits for its copy number `copied`. Return how many operations there are."""
    return wait(words_at(state_at), core, words_at(lines_at), copied)


@native_entry("int64", "int64*", "uint8*", "int64", "int64*", "int64*")
def note_fetch(state_at: Any, memory_at: Any, core: int, lines_at: Any, ring_at: Any) -> int:
    """Take the next line: let the bus catch up, program the stream, copy the line after it, and wait for this one.

    Returns its row. Does nothing and returns NONE if the core does not run ahead or a line has no plan yet.
    """
    state, memory, lines = words_at(state_at), words_at(memory_at), words_at(lines_at)
    ring: State = words_at(ring_at)
    number, following = ring[DONE], ring[DONE] + 1
    if not runs_ahead(state, core) or following > lines[COUNT] or not has_plan(lines, number):
        return w.NONE
    if following < lines[COUNT] and not has_plan(lines, following):
        return w.NONE
    write(state, core, w.CATCH_UP, 0, 0, 0, 0)
    program(state, core, lines)
    copied = copy(state, memory, core, lines, number) if ring[LATEST] == w.NONE else ring[LATEST]
    ring[LATEST] = copy(state, memory, core, lines, following) if following < lines[COUNT] else w.NONE
    wait(state, core, lines, copied)
    ring[DONE] = following
    return number % ring[DEPTH]


@native_entry("int64", "int64*", "uint8*", "int64", "int64*", "int64*")
def note_row(state_at: Any, _memory_at: Any, core: int, lines_at: Any, ring_at: Any) -> int:
    """Wait until the row for the next line is free, and return it. Returns NONE if the core does not run ahead."""
    state: State = words_at(state_at)
    ring: State = words_at(ring_at)
    row = ring[DONE] % ring[DEPTH]
    if not runs_ahead(state, core):
        return w.NONE
    if ring[DONE] >= ring[DEPTH]:
        wait(state, core, words_at(lines_at), ring[LATEST + row])
    return row


@native_entry("int64", "int64*", "uint8*", "int64", "int64*", "int64*")
def note_send(state_at: Any, memory_at: Any, core: int, lines_at: Any, ring_at: Any) -> int:
    """Program the stream and copy the next line. Return its row; do nothing and return NONE as above."""
    state, memory, lines = words_at(state_at), words_at(memory_at), words_at(lines_at)
    ring: State = words_at(ring_at)
    number = ring[DONE]
    if not runs_ahead(state, core) or number >= lines[COUNT] or not has_plan(lines, number):
        return w.NONE
    row = number % ring[DEPTH]
    program(state, core, lines)
    ring[LATEST + row] = copy(state, memory, core, lines, number)
    ring[DONE] = number + 1
    return row


def ring_words(depth: int, copies: int) -> ctypes.Array[ctypes.c_int64]:
    """Return the words of a new ring of `depth` rows, with room for so many copies."""
    return (ctypes.c_int64 * (LATEST + copies))(0, depth, *(copies * [w.NONE]))


class NotedLines:
    """Notes lines of rings on a tape: the functions above as built-in ones. They take the address of the lines' words and the rest.

    Firmware calls functions of its own (`answering`).
    """

    def __init__(self, tape: Tape) -> None:
        self._tape = tape.at
        self.program = built_in(note_program.address(), 1, *tape.at)
        self.copy = built_in(note_copy.address(), 2, *tape.at)
        self.wait = built_in(note_wait.address(), 2, *tape.at)
        self.fetch = built_in(note_fetch.address(), 2, *tape.at)
        self.row = built_in(note_row.address(), 2, *tape.at)
        self.send = built_in(note_send.address(), 2, *tape.at)

    def answering(
        self, note: NativeEntry, lines: int, ring: int, answers: tuple[object, ...], other: Callable[[], Any]
    ) -> Callable[[], Any]:
        """Return a function that calls `note` with the addresses of the words of lines and of their ring.

        It returns the answer with the number that `note` returns, or what `other` returns if that is NONE.
        """
        return answering(note.address(), (*self._tape, lines, ring), answers, other)
