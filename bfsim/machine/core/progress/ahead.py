"""A core that runs ahead: it does at once what no other device can notice, and the buses play it before the core meets one.

Kernels in L1 or on the core's own buffers, and the lines of its rings, run as soon as the firmware asks for them, so their bytes
are written before time has passed. They are noted as operations of a stretch (`bus.stretches`), whose playing gives their cycles.
Before the core waits for a picture, the other core or a device, the bus plays its stretches, and its clock is known again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import nullcontext
from functools import partial
from typing import Any

import numpy as np
import simpy

from bfsim.chip.block_spec import EventSpec
from bfsim.chip.dma_registers import COPY_READS, COPY_WRITES
from bfsim.errors import FirmwareError
from bfsim.kernel import Work
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.machine.bus import state as w
from bfsim.machine.bus.stalls import COUNTER_OF
from bfsim.machine.bus.tape import Tape
from bfsim.machine.bus.tape_lines import COPY_WORDS, HEAD, PLAN, NotedLines
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.calls.call_cache import KnownCall
from bfsim.machine.core.interrupts import Handler
from bfsim.machine.core.progress.in_step import InStep
from bfsim.machine.core.progress.line_copies import Copy, LineCopies, Lines
from bfsim.machine.core.progress.progress import Away
from bfsim.machine.core.progress.told_ahead import ToldAhead
from bfsim.machine.core.waits import Wait
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.memories import Row
from bfsim.machine.simulation import Simulation
from bfsim.trace import StallReason

MOST_COPIES = 1 << 10
"""Most rings that are remembered. A ring over a moving area is a new one in each frame."""


class CopiesAhead:
    """`LineCopies` of a core that runs ahead: bytes are moved at once, and the request is noted on the tape."""

    def __init__(self, core: Ahead, lines: Lines, in_step: LineCopies) -> None:
        self.lines = lines
        self._core = core
        self._in_step = in_step
        self._words = np.full(HEAD + len(lines) * COPY_WORDS, w.NONE, np.int64)
        cclk = core.programming_cclk(COPY_WRITES, COPY_READS)
        why = core.account_of(lines.owner), COUNTER_OF[lines.reason]
        self._words[:HEAD] = len(lines), *why, cclk, COPY_WRITES, COPY_READS
        self.at: int = self._words.ctypes.data
        self.ahead = core.lines

    def program(self) -> None:
        """Note the programming of the stream, or let its time pass."""
        core = self._core
        if core.runs_ahead or core.tape.noted:
            self.ahead.program(self.at)
        else:
            self._in_step.program()

    def copy(self, number: int) -> Copy:
        """Copy line `number` at once."""
        core = self._core
        if not (core.runs_ahead or core.tape.noted):
            return self._in_step.copy(number)
        self.plan(number)
        return self.ahead.copy(self.at, number)

    def plan(self, *numbers: int) -> None:
        """Plan the copies of lines without a plan, and of all later lines. A number may be beyond the last line."""
        lines = self.lines
        for number in numbers:
            if number < len(lines) and self._words[HEAD + number * COPY_WORDS + PLAN] == w.NONE:
                lines.rows(number)  # raises here if something is wrong with them
                words = self._core.planned(lines.stream, lines.rows_from(number))
                first = HEAD + number * COPY_WORDS
                self._words[first : first + len(words)] = words

    def goes_on(self, copy: Copy) -> bool:
        """Note the wait for a copy that was made ahead, and go on. In step, ask whether the copy is over."""
        if not self._core.runs_ahead:
            return self._core.has(copy)
        self.ahead.wait(self.at, copy)
        return True


class Ahead:
    """`Progress` of a core that runs ahead until something may interrupt it; `in_step` does what is done at its time."""

    def __init__(
        self, env: Simulation, in_step: InStep, name: str, number: int, bus: WovenBus, tape: Tape,
        access_trace: AccessTrace, events: EventSpec, told: ToldAhead | None,
    ) -> None:  # fmt: skip
        """`told` reports to the timeline, if there is one."""
        self.clock = in_step.clock
        self.interrupts = in_step.interrupts
        self.waits = in_step.waits
        self.runs_ahead = True
        self._env = env
        self._in_step = in_step
        self._name = name
        self._number = number
        self._bus = bus
        self._access_trace = access_trace
        self._write_cclk, self._read_cclk = events.mmr_write_cclk, events.mmr_read_cclk
        self.tape = tape
        self.tape.takes_calls = True
        self._told = told
        self.lines = NotedLines(self.tape)
        """Notes lines of rings on the tape."""
        self._owners: dict[str, int] = {}  # of accounts
        self._copies: dict[tuple[object, ...], CopiesAhead] = {}
        self._plans: dict[tuple[object, ...], int] = {}
        self._begin()

    def _begin(self) -> None:
        """Begin a new tape: the clock has caught up with the firmware."""
        self.tape.clear()
        if self._told:
            self._told.clear()
        self._moments: list[tuple[int, Callable[[], None]]] = []  # what to do, and after how many operations
        self._access_trace.drop()

    @property
    def is_full(self) -> bool:
        """Whether the core must `sync` before it does more."""
        return self.tape.is_full

    # ---- kernels

    def note_call(self, work: Work, call: KnownCall) -> None:
        """Note the call on the tape."""
        self.tape.note_access(work.at, call.number)

    def charge_call(self, work: Work, call: KnownCall) -> None:
        """Append the call to the tape if it has operations, or charge it at once."""
        if not self.tape.note_run(work.at, call.number):
            self._in_step.charge_call(work, call)

    def play_call(self, work: Work, call: KnownCall) -> Wait:
        """Play and charge the call."""
        return self._in_step.play_call(work, call)

    def access_shared(self, work: Work, owner: str) -> Wait:
        """Play and charge the instruction."""
        return self._in_step.access_shared(work, owner)

    # ---- time

    def sync(self) -> Wait:
        """Determine the clock, and wait until simulated time has reached it."""
        yield from self.play_stretches()
        yield from self._in_step.sync()

    def catch_up(self) -> simpy.Event | None:
        """Note that the core waits for simulated time, or wait for it."""
        if self.runs_ahead:
            self.tape.note(w.CATCH_UP, 0, 0, 0, 0)
            return None
        return self._env.process(self.sync()) if self.tape.noted else self._in_step.catch_up()

    def when_there(self, what: Callable[[], None]) -> None:
        """Call `what` when the clock is where the firmware is now."""
        if noted := self.tape.mark():
            self._moments.append((noted, what))
        else:
            what()

    def issue(self, cclk: int, owner: str) -> None:
        """Let the cycles pass when the clock gets there."""
        self.when_there(partial(self.clock.issue, cclk, owner))

    def program_device(self, owner: str, *, writes: int, reads: int = 0) -> None:
        """Note the register accesses, or let their time pass."""
        if self.runs_ahead or self.tape.noted:
            cclk = self.programming_cclk(writes, reads)
            self.tape.note(w.SET_UP, cclk, self.account_of(owner), writes, reads)
        else:
            self._in_step.program_device(owner, writes=writes, reads=reads)

    def programming_cclk(self, writes: int, reads: int) -> int:
        """Return the cycles of writing and reading so many registers."""
        return writes * self._write_cclk + reads * self._read_cclk

    # ---- copies

    def copies(self, lines: Lines) -> LineCopies:
        """Return the object that makes these copies ahead, the same as last time for the same rows."""
        sources, destinations = lines.sources, lines.destinations
        # there are many rows, and hashing all of them takes longer than comparing them
        kind = lines.stream, sources[0], sources[-1], destinations[0], destinations[-1]
        copies = self._copies.get(kind)
        if copies is None or copies.lines != lines:
            if len(self._copies) == MOST_COPIES:
                self._copies.clear()
            copies = self._copies[kind] = CopiesAhead(self, lines, self._in_step.copies(lines))
        return copies

    def planned(self, stream: MdmaStream, copies: Iterable[tuple[Row, Row]]) -> list[int]:
        """Return copies as the tape keeps them in a table: each with the number of its plan, which copies of its kind share."""
        words: list[int] = []
        plans = self._plans
        for source, destination in copies:
            kind = stream, *stream.kind_of(source, destination)
            if kind not in plans:
                plan = stream.plan(source, destination)
                plans[kind] = int(self._bus.stretches.keep_plans([plan.words])[0])
                if self._told:
                    self._told.plans[plans[kind]] = plan
            words += plans[kind], source.offset, destination.offset, 0, source.nbytes
        return words

    def settle(self) -> None:
        """Settle the bus, unless the core is ahead: what it does then does not depend on the bus."""
        if not (self.runs_ahead or self.tape.noted):
            self._in_step.settle()

    def has(self, copy: Copy) -> bool:
        """Whether a copy is over. Of one made ahead, that is unknown until the core waits for it."""
        return not (self.runs_ahead or self.tape.noted) and self._in_step.has(self._posted(copy))

    def wait_transfer(self, copy: Copy, reason: StallReason, owner: str) -> Wait:
        """Wait for the end of the copy."""
        yield from self.play_stretches()
        yield from self._in_step.wait_transfer(self._posted(copy), reason, owner)

    def _posted(self, copy: Copy) -> Transfer:
        """Return the bus transfer of a copy that was made ahead and has been played."""
        if isinstance(copy, Transfer):
            return copy
        return Transfer(self._bus.words, *self._bus.stretches.copy_of(self._number, copy))

    # ---- others

    def wait_event(self, event: simpy.Event | None, what: str, last: Callable[[], Transfer | None]) -> Wait:
        """Wait for the event."""
        yield from self.play_stretches()
        yield from self._in_step.wait_event(event, what, last)

    def blocked(
        self, wait: Any, what: str, reason: StallReason | None, away: Callable[[], Away] = nullcontext
    ) -> Wait:
        """Play the wait."""
        return self._in_step.blocked(wait, what, reason, away)

    def on_interrupt(self, source: str, handler: Handler) -> None:
        """Attach the handler when the clock gets there. From now on every call may be interrupted."""
        self.stay_in_step()
        self.interrupts.source(source)  # raises here if there is no such source
        self.when_there(partial(self._in_step.on_interrupt, source, handler))
        self.tape.is_full = bool(self.tape.noted)

    def request_interrupt(self, source: str) -> None:
        """Request the interrupt when the clock gets there."""
        self.interrupts.source(source)
        self.when_there(partial(self._in_step.request_interrupt, source))

    def stay_in_step(self) -> None:
        """Stop running ahead."""
        self.runs_ahead = False
        self.tape.takes_calls = False

    # ---- stretches

    def play_stretches(self) -> Wait:
        """Have the bus play what was done ahead, and do at each moment what is due then."""
        if noted := self.tape.noted:
            yield from self._play(noted)

    def _play(self, noted: int) -> Wait:
        """Have the bus play `noted` operations without interruption."""
        with self.interrupts.held():  # no handler comes in between,
            self.tape.is_full = False  # and nothing is played twice
            stretches, owners, first = self._bus.stretches, list(self._owners), 0
            for end, what in (*self._moments, (noted, self._begin)):
                if end > first:
                    if self._told:
                        self._told.begin(first, self.clock.cclk, owners)
                    yield stretches.play(self._number, self.clock.cclk, len(owners), end, first)
                    if self._told:
                        self._told.tell()
                    self.clock.stretch(stretches.played(self._number, len(owners)), owners)
                    first = end
                what()

    def account_of(self, owner: str) -> int:
        """Return the number of an owner's account. Raises FirmwareError if there are too many."""
        number = self._owners.setdefault(owner, len(self._owners))
        if number == w.MAX_ACCOUNTS:
            raise FirmwareError(f"core {self._name} must use at most {w.MAX_ACCOUNTS} rings and devices")
        return number
