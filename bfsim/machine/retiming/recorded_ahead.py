"""The progress of a core that runs ahead and records it, stretch by stretch, as operations of `FrameWork`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from bfsim.kernel import Work
from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import RING_STREAMS
from bfsim.machine.bus.tape_lines import COPY_WORDS, NUMBER
from bfsim.machine.calls.call_cache import KnownCall
from bfsim.machine.core.progress.ahead import Ahead
from bfsim.machine.core.waits import Wait
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.memories import Row
from bfsim.machine.retiming.work import CALL, OPERATION_COLUMNS, Table
from bfsim.machine.retiming.work_notes import WorkNotes

LATEST = 1 << 14
"""How many of a core's latest copies can be waited for: the bus remembers their ends."""


class RecordedAhead(Ahead):
    """`Ahead` that takes `notes`, unless it `is_paused`: inside a call of firmware that is noted as a whole."""

    def __init__(self, *parts: Any) -> None:
        super().__init__(*parts)
        self.notes = WorkNotes(self._name, self._bus.owners)
        self.is_paused = False
        self.is_too_late = False
        """Whether the core waited for a copy that is not among the latest."""

    def _begin(self) -> None:
        super()._begin()
        self._marks: list[tuple[int, int, int]] = []  # after how many operations each is, its kind and number

    def mark(self, kind: int = CALL, number: int = 0) -> None:
        """Note the place of a call of firmware, or of the beginning of a stage."""
        if noted := self.tape.mark():
            self._marks.append((noted, kind, number))
        else:
            self.notes.add(kind, number)

    def charge_call(self, work: Work, call: KnownCall) -> None:
        """Note the call even if the tape is empty."""
        if not (self.tape.noted or self.is_paused):
            self.notes.add(w.RUN, work.issue_cclk, work.stall_cclk)
        super().charge_call(work, call)

    def play_call(self, work: Work, call: KnownCall) -> Wait:
        """Play the call and note it."""
        yield from super().play_call(work, call)
        if not self.is_paused:
            trace, count = self._access_trace, work.accesses
            self.notes.add_accesses(trace.entries(count), trace.sites(count))
            self.notes.add(w.ACCESS, work.issue_cclk, work.stall_cclk, count, call.number)

    def planned(self, stream: MdmaStream, copies: Iterable[tuple[Row, Row]]) -> list[int]:
        """Return the planned copies with their numbers in the notes."""
        copies = list(copies)
        words, number = super().planned(stream, copies), RING_STREAMS[self._number].index(stream.master)
        words[NUMBER::COPY_WORDS] = [self.notes.copy(number, *each) for each in copies]
        return words

    def _play(self, noted: int) -> Wait:
        if not self.is_paused:
            self._note_stretch(self.tape.operations(0, noted))
        return super()._play(noted)

    def _note_stretch(self, on_tape: Table) -> None:
        """Note operations from the tape in the form of `FrameWork`."""
        operations, notes = on_tape[:, :OPERATION_COLUMNS].copy(), self.notes
        kinds = operations[:, 0]
        accounts = np.array([notes.account(each) for each in self._owners], np.int64)
        calls, set_ups, copies, awaits = (
            np.flatnonzero(kinds == each) for each in (w.ACCESS, w.SET_UP, w.COPY, w.AWAIT)
        )
        if len(calls):
            notes.add_accesses(*self._bus.logs.first(self._number, int(operations[calls[-1], 4])))
            operations[calls, 3] = operations[calls, 4] - operations[calls, 3]
            operations[calls, 4] = on_tape[calls, w.OF_CALL]
        _, _, account, writes, reads = operations[set_ups].T
        operations[set_ups, 1:] = np.column_stack([writes, reads, accounts[account], 0 * reads])
        operations[copies, 1], operations[copies, 2:] = operations[copies, 4], 0
        operations[awaits, 3] = accounts[operations[awaits, 3]]
        self.is_too_late |= bool((operations[awaits, 1] > LATEST).any())
        marks = np.array(self._marks, np.int64).reshape(-1, 3)
        rows = np.pad(marks[:, 1:], ((0, 0), (0, OPERATION_COLUMNS - 2)))
        notes.add_all(np.insert(operations, marks[:, 0], rows, axis=0))
