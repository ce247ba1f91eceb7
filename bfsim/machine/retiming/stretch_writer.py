"""The recorded work of a frame, written for a board: each stretch by one call of machine code (`written_stretch`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.block_spec import EventSpec
from bfsim.machine.retiming.frame_words import (
    ACCESS_DICTIONARY_ROWS,
    ACCESS_ROWS,
    ACCOUNTS,
    COPIES,
    DICTIONARIES_AT,
    EVENT_ROWS,
    FRAME_WORDS,
    IS_AT_CALL,
    MMR_READ,
    MMR_WRITE,
    NEXT,
    NO_CODE,
    NO_ROOM,
    NOT_THERE,
    ODD,
    OPERATION_DICTIONARY_ROWS,
    OWNERS,
    ROWS,
    STAGES,
)
from bfsim.machine.retiming.laid_dictionaries import ACCESS_ENTRY_WORDS, lay_dictionaries
from bfsim.machine.retiming.packed_work import WIDTHS, PackedWork
from bfsim.machine.retiming.passed_mark import pass_mark
from bfsim.machine.retiming.work import OPERATION_COLUMNS, Table
from bfsim.machine.retiming.written_stretch import write_stretch
from bfsim.machine_code.built_in import built_in

PROBLEMS = {
    NOT_THERE: "a call, a copy, an account, a counter or memory that is not there",
    NO_CODE: "code is fetched from where none lies",
    NO_ROOM: "more accesses than a core has room for",
    ODD: "a number that is out of its range",
}


class StretchWriter:
    """Writes a core's stretches into the `state` of a bus, frame by frame.

    `firsts` is where in the arena the memory of each owner begins, or IN_L1. `events` has the core's cycles for registers.
    """

    def __init__(self, state: Any, core: int, firsts: NDArray[np.int64], events: EventSpec) -> None:
        self._at = np.asarray(state).ctypes.data, core
        self._firsts, self._events = firsts, events
        self._words = self._room(DICTIONARIES_AT)
        self._work: PackedWork
        self._views_at: tuple[int, ...] = ()
        self.counters_at = 0, 0
        """The address of the core's counters, and their current number."""

    def _room(self, count: int) -> NDArray[np.int64]:
        """Make room for so many words."""
        words = np.zeros(count, np.int64)
        at, self._numbers = words.ctypes.data, words.data
        self._lay = built_in(lay_dictionaries.address(), 5, at)
        self._pass = built_in(pass_mark.address(), 6, at)
        self._write = built_in(write_stretch.address(), 8, *self._at, at)
        return words

    def begin(self, work: PackedWork, copies: Table, accounts: int, stages: int) -> None:
        """Go on with the work of another frame. `copies` has the numbers after COPY, a row for each; `accounts` and `stages` are counts.

        Raises ValueError if the work refers to something missing.
        """
        rows = work.rows
        operations, accesses = rows["operation_dictionary"], rows["access_dictionary"]
        count = DICTIONARIES_AT + accesses * ACCESS_ENTRY_WORDS + operations * OPERATION_COLUMNS
        if count > len(self._words):
            self._words = self._room(2 * count)
        words, events = self._words, self._events
        words[:FRAME_WORDS] = 0
        for word, number in (
            (ROWS, rows["operations"]), (ACCESS_ROWS, rows["accesses"]), (EVENT_ROWS, rows["events"]),
            (OPERATION_DICTIONARY_ROWS, operations), (ACCESS_DICTIONARY_ROWS, accesses),
            (COPIES, len(copies)), (ACCOUNTS, accounts), (OWNERS, len(self._firsts)), (STAGES, stages),
            (MMR_WRITE, events.mmr_write_cclk), (MMR_READ, events.mmr_read_cclk),
        ):  # fmt: skip
            self._numbers[word] = number
        words[FRAME_WORDS:DICTIONARIES_AT] = work.columns.reshape(-1)
        self._work, self._copies_at = work, copies.ctypes.data
        self._views_at = (np.frombuffer(work.octets, np.int8).ctypes.data,) * len(WIDTHS)
        if problem := self._lay(*self._views_at, self._firsts.ctypes.data):
            raise ValueError(PROBLEMS[problem])

    def write(self, kinds_at: int, calls: int, *, must_look: bool) -> int:
        """Write the next stretch and return how many operations it has.

        With `must_look`, it ends before the stage does. `kinds_at` is the address of the kinds of operation of the `calls` prepared by
        now. Raises ValueError if the work refers to something missing.
        """
        written = self._write(*self._views_at, self._copies_at, kinds_at, calls, must_look)
        if written < 0:
            raise ValueError(PROBLEMS[written])
        return written

    def pass_mark(self) -> None:
        """Add the kernels' counts up to the next mark to the core's counters. Raises ValueError as above."""
        if problem := self._pass(*self._views_at, *self.counters_at):
            raise ValueError(PROBLEMS[problem])

    @property
    def is_at_call(self) -> bool:
        """Whether a call of firmware follows what was written last."""
        return bool(self._numbers[IS_AT_CALL])

    @property
    def is_over(self) -> bool:
        """Whether everything was written."""
        return bool(self._numbers[NEXT] == self._numbers[ROWS])
