"""A core that runs ahead: what nobody else can meet is done at once, and the buses play it when the core has to meet somebody.

Kernels in L1 or on buffers of its own and the lines of its rings run as the firmware asks for them, so bytes are where they belong
before time has passed; they are noted as operations of a stretch (`bus.stretches`), which says at which cycle each of them was.
Before the core waits for a picture, for the other core or for a device, the bus plays its stretches, and its clock is known again.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from functools import partial
from struct import pack
from typing import Any

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.chip.spec import EventSpec
from bfsim.errors import FirmwareError
from bfsim.kernel import Work
from bfsim.kernel.access_trace import AccessTrace
from bfsim.machine.bus import state as w
from bfsim.machine.bus.stalls import COUNTER_OF
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.calls.call_cache import KnownCall
from bfsim.machine.core.in_step import InStep
from bfsim.machine.core.interrupts import Handler
from bfsim.machine.core.progress import Away, Copy, Wait
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.memories import Row
from bfsim.machine.simulation import Simulation
from bfsim.trace import StallReason

MOST_WORDS, MOST_ACCESSES = w.MAX_OPERATIONS // 2 * w.OPERATION_WORDS, 1 << 16
"""What is done ahead, at most, before a core meets the others: its room is larger, for it cannot do so at every operation."""

Operation = tuple[int, int, int, int, int]


class Ahead:
    """`Progress` of a core that runs ahead until somebody may interrupt it; `in_step` does what is done at its time."""

    def __init__(
        self, env: Simulation, in_step: InStep, name: str, number: int, bus: WovenBus, access_trace: AccessTrace, events: EventSpec
    ) -> None:  # fmt: skip
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
        self._copies = 0
        self._known_copies: dict[tuple[MdmaStream, Row, Row], Operation] = {}
        self._plans: dict[tuple[object, ...], int] = {}
        self._begin()

    def _begin(self) -> None:
        """Begin anew: the clock is where the firmware is."""
        self._noted: list[int] = []  # operations, word by word,
        self._issued = self._interlocked = 0  # and what the calls behind the last of them took
        self._moments: list[tuple[int, Callable[[], None]]] = []  # what to do, and behind how many words
        self._owners: dict[str, int] = {}  # of their accounts
        self.is_full = False
        self._access_trace.drop()

    # ---- kernels

    def note_call(self, work: Work, call: KnownCall) -> None:  # noqa: ARG002
        """Note it."""
        if self._issued:
            self._note_calls()
        first = self._access_trace.keep(work.accesses)
        last = first + work.accesses
        self._noted += (w.ACCESS, work.issue_cclk, work.stall_cclk, first, last)
        if last > MOST_ACCESSES:
            self.is_full = True

    def charge_call(self, work: Work, call: KnownCall) -> None:
        """Note it behind what is noted, or charge it at once."""
        if self._noted:
            self._issued += work.issue_cclk
            self._interlocked += work.stall_cclk
        else:
            self._in_step.charge_call(work, call)

    def play_call(self, work: Work, call: KnownCall) -> Wait:
        """Play it."""
        return self._in_step.play_call(work, call)

    def access_shared(self, work: Work, owner: str) -> Wait:
        """Play it."""
        return self._in_step.access_shared(work, owner)

    # ---- time

    def sync(self) -> Wait:
        """Find the clock out, and wait until the simulated time has reached it."""
        yield from self.play_stretches()
        yield from self._in_step.sync()

    def catch_up(self) -> simpy.Event | None:
        """Note that the core meets the simulated time, or meet it."""
        if self.runs_ahead:
            if self._issued:
                self._note_calls()
            self._noted += (w.CATCH_UP, 0, 0, 0, 0)
            return None
        return self._env.process(self.sync()) if self._noted else self._in_step.catch_up()

    def when_there(self, what: Callable[[], None]) -> None:
        """Do it when the clock is where the firmware is now."""
        if self._noted:
            self._note_calls()
            self._moments.append((len(self._noted), what))
        else:
            what()

    def issue(self, cclk: int, owner: str) -> None:
        """Let the cycles pass when the clock is there."""
        self.when_there(partial(self.clock.issue, cclk, owner))

    def program_device(self, owner: str, *, writes: int, reads: int = 0) -> None:
        """Note it, or let its time pass."""
        if self.runs_ahead or self._noted:
            if self._issued:
                self._note_calls()
            cclk = writes * self._write_cclk + reads * self._read_cclk
            self._noted += (w.SET_UP, cclk, self._account_of(owner), writes, reads)
        else:
            self._in_step.program_device(owner, writes=writes, reads=reads)

    # ---- copies

    def copy(self, stream: MdmaStream, source: Row, destination: Row) -> Copy:
        """Copy at once, and note when that was asked for."""
        if not (self.runs_ahead or self._noted):
            return self._in_step.copy(stream, source, destination)
        key = stream, source, destination
        operation = self._known_copies.get(key)
        if operation is None:
            operation = self._known_copies[key] = self._planned(*key)
        destination.octets[:] = source.octets
        if self._issued:
            self._note_calls()
        self._noted += operation
        self._copies += 1
        return self._copies - 1

    def _planned(self, stream: MdmaStream, source: Row, destination: Row) -> Operation:
        """Return a copy as an operation: the number of its plan, which those of its kind share, and where it begins to read and to write."""
        kind = stream, *stream.kind_of(source, destination)
        if kind not in self._plans:
            plans = self._bus.stretches.keep_plans([stream.plan(source, destination).words])
            self._plans[kind] = int(plans[0])
        return w.COPY, self._plans[kind], source.offset, destination.offset, 0

    def settle(self) -> None:
        """Settle the bus, unless something is done ahead, which does not depend on it."""
        if not (self.runs_ahead or self._noted):
            self._in_step.settle()

    def has(self, copy: Copy) -> bool:
        """Whether it is over: nobody knows that of one made ahead before it is waited for."""
        return not (self.runs_ahead or self._noted) and self._in_step.has(self._posted(copy))

    def goes_on(self, copy: Copy, reason: StallReason, owner: str) -> bool:
        """Note the wait for a copy that was made ahead, and go on; else ask whether it is over."""
        if not (self.runs_ahead and isinstance(copy, int)):
            return self.has(copy)
        if self._issued:
            self._note_calls()
        self._noted += (w.AWAIT, self._copies - copy, COUNTER_OF[reason], self._account_of(owner), 0)
        if len(self._noted) > MOST_WORDS:
            self.is_full = True
        return True

    def wait_transfer(self, copy: Copy, reason: StallReason, owner: str) -> Wait:
        """Note the wait and go on, or wait."""
        if not self.runs_ahead or not self.goes_on(copy, reason, owner):
            yield from self.play_stretches()
            yield from self._in_step.wait_transfer(self._posted(copy), reason, owner)

    def _posted(self, copy: Copy) -> Transfer:
        """Return the transfer of the bus that a copy is which was made ahead and has been played."""
        if isinstance(copy, Transfer):
            return copy
        return Transfer(self._bus.words, *self._bus.stretches.copy_of(self._number, copy))

    # ---- others

    def wait_event(self, event: simpy.Event | None, what: str, last: Callable[[], Transfer | None]) -> Wait:
        """Wait for it."""
        yield from self.play_stretches()
        yield from self._in_step.wait_event(event, what, last)

    def blocked(
        self, wait: Any, what: str, reason: StallReason | None, away: Callable[[], Away] = nullcontext
    ) -> Wait:
        """Play it."""
        return self._in_step.blocked(wait, what, reason, away)

    def on_interrupt(self, source: str, handler: Handler) -> None:
        """Attach the handler when the clock is there: from now on every call may be interrupted."""
        self.stay_in_step()
        self.interrupts.source(source)  # a wrong one is told here
        self.when_there(partial(self._in_step.on_interrupt, source, handler))
        self.is_full = bool(self._noted)

    def request_interrupt(self, source: str) -> None:
        """Ask for it when the clock is there."""
        self.interrupts.source(source)
        self.when_there(partial(self._in_step.request_interrupt, source))

    def stay_in_step(self) -> None:
        """Run ahead no more."""
        self.runs_ahead = False

    # ---- stretches

    def play_stretches(self) -> Wait:
        """Have the bus play what was done ahead, and do at each moment what was to be done then."""
        if self._noted:
            self._note_calls()
            # numpy takes eight times as long for a list of ints
            words = pack(f"{len(self._noted)}q", *self._noted)
            yield from self._play(np.frombuffer(words, np.int64))

    def _play(self, operations: NDArray[np.int64]) -> Wait:
        """Have the bus play operations, all in one."""
        with self.interrupts.held():  # no handler comes between,
            self.is_full = False  # and no second play of the same
            stretches, owners, first = self._bus.stretches, list(self._owners), 0
            for end, what in (*self._moments, (len(operations), self._begin)):
                if end > first:
                    count = stretches.write(self._number, operations[first:end])
                    yield stretches.play(self._number, self.clock.cclk, count)
                    self.clock.stretch(stretches.played(self._number, len(owners)), owners)
                    first = end
                what()

    def _note_calls(self) -> None:
        """Note the calls that have met nobody since the last operation, as one."""
        issued, interlocked = self._issued, self._interlocked
        if issued or interlocked:
            self._issued = self._interlocked = 0
            self._noted += (w.RUN, issued, interlocked, 0, 0)

    def _account_of(self, owner: str) -> int:
        owners = self._owners
        if owner in owners:
            return owners[owner]
        number = owners[owner] = len(owners)
        if number == w.MAX_ACCOUNTS:
            raise FirmwareError(
                f"core {self._name} must use at most {w.MAX_ACCOUNTS} rings before it waits for a picture or another core"
            )
        if number > w.MAX_ACCOUNTS // 2:
            self.is_full = True
        return number
