"""A core in step with simulated time: it does everything at its time.

Calls in L1 only add to its own clock, and simulated time catches up with that where the core meets another device.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from typing import Any

import simpy

from bfsim.kernel import Work
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.stalls import BUS_STALLS
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.calls.call_cache import KnownCall
from bfsim.machine.core.clock.accounts import KERNELS
from bfsim.machine.core.clock.clock import CoreClock
from bfsim.machine.core.interrupts import Handler, Interrupts
from bfsim.machine.core.progress.line_copies import CopiesInStep, Copy, LineCopies, Lines
from bfsim.machine.core.progress.progress import Away
from bfsim.machine.core.waits import Wait, Waits
from bfsim.machine.simulation import Simulation
from bfsim.trace import StallReason


class InStep:
    """`Progress` of a core that is never ahead."""

    runs_ahead = is_full = False
    tape = None
    serve_interrupts: Callable[[], Wait]
    """Runs the handlers of pending interrupts. Set by the part that plays the firmware."""

    def __init__(
        self, env: Simulation, bus: Bus, number: int, clock: CoreClock, interrupts: Interrupts, waits: Waits
    ) -> None:
        """`number` is the core's number on the bus."""
        self.clock = clock
        self.interrupts = interrupts
        self.waits = waits
        self._env = env
        self._bus = bus
        self._number = number

    # ---- kernels

    def note_call(self, work: Work, call: KnownCall) -> None:
        """Do nothing: no call is made ahead."""

    def charge_call(self, work: Work, call: KnownCall) -> None:
        """Charge a call."""
        self.clock.call(work, {}, call.name)

    def play_call(self, work: Work, call: KnownCall) -> Wait:
        """Play and charge a call."""
        return self._play(work, call.name, KERNELS)

    def access_shared(self, work: Work, owner: str) -> Wait:
        """Play and charge an instruction."""
        return self._play(work, "TESTSET", owner)

    def _play(self, work: Work, name: str, owner: str) -> Wait:
        stalls: dict[StallReason, int] = {}
        if work.accesses:
            cclk, cores = work.issue_cclk + work.stall_cclk, self._bus.cores
            yield cores.access(self._number, self.clock.ticks, cclk, work.accesses)
            by_reason = zip(BUS_STALLS, cores.stalls_of(self._number), strict=True)
            stalls = {reason: stalled for reason, stalled in by_reason if stalled}
        self.clock.call(work, stalls, name, owner)

    # ---- time

    def sync(self) -> Wait:
        """Catch up, and take interrupts until none is pending."""
        yield from self._catch_up_at_last()
        while self.interrupts.can_be_taken:
            yield from self.serve_interrupts()
            yield from self._catch_up_at_last()

    def _catch_up_at_last(self) -> Wait:
        while (ahead_ticks := self.clock.ticks - self._env.tick) > 0:  # a handler may come in between
            yield self._env.after(ahead_ticks)

    def catch_up(self) -> simpy.Event | None:
        """Return the event to wait for, if any."""
        ahead_ticks = self.clock.ticks - self._env.tick
        if ahead_ticks > 0:
            return self._env.after(ahead_ticks)
        return self._env.after(0) if self.interrupts.can_be_taken else None

    def when_there(self, what: Callable[[], None]) -> None:
        """Call `what` now: the core is there."""
        what()

    def issue(self, cclk: int, owner: str) -> None:
        """Let cycles pass."""
        self.clock.issue(cclk, owner)

    def program_device(self, owner: str, *, writes: int, reads: int = 0) -> None:
        """Let the time of the registers pass."""
        self.clock.program_device(owner, writes=writes, reads=reads)

    # ---- copies

    def copies(self, lines: Lines) -> LineCopies:
        """Return the object that posts these copies."""
        return CopiesInStep(lines, self.clock)

    def settle(self) -> None:
        """Settle the bus."""
        self._bus.settle()

    def has(self, copy: Copy) -> bool:
        """Whether the copy is over."""
        assert isinstance(copy, Transfer), "nothing is copied ahead"
        return self.clock.is_over(copy)

    def wait_transfer(self, copy: Copy, reason: StallReason, owner: str) -> Wait:
        """Wait for the end of the copy."""
        assert isinstance(copy, Transfer), "nothing is copied ahead"
        can_come = self.interrupts.can_come  # during the wait, so even a known end is waited for
        if can_come or copy.end is None:
            yield from self.sync()
            self._bus.settle()
            if copy.end is None or (can_come and not self.has(copy)):
                yield from self.blocked(iter([self._end_of(copy)]), "DMA", reason)
        assert copy.end is not None, "it was waited for"
        self.clock.waited(reason, self.clock.until(copy.end), owner, copy)

    def _end_of(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of `transfer`, which is later than the core's clock."""
        if transfer.end is None:
            return self._bus.when_done(transfer)
        return self._env.after(max(0, transfer.end - self._env.tick))

    # ---- others

    def wait_event(self, event: simpy.Event | None, what: str, last: Callable[[], Transfer | None]) -> Wait:
        """Wait for the event unless it is over."""
        yield from self.sync()
        if event is not None and not event.processed:
            yield from self.blocked(iter([event]), what, StallReason.RING_EMPTY)
            self.clock.wake(StallReason.RING_EMPTY, what, ended_by=last())

    def blocked(
        self, wait: Any, what: str, reason: StallReason | None, away: Callable[[], Away] = nullcontext
    ) -> Wait:
        """Play the wait."""
        self.waits.present = f"{what}, since cycle {self.clock.cclk:,}"
        if self.interrupts.can_come:
            wait = self._interruptible(wait, reason, away)
        result = yield from wait
        self.waits.present = None
        return result

    def _interruptible(self, wait: Any, reason: StallReason | None, away: Callable[[], Away]) -> Wait:
        """Take interrupts between the events of `wait`. The time before each of them is on no account yet."""
        owed_cclk, what = 0, self.waits.present
        with self.interrupts.held():  # the clock is still where the wait began, so nothing else may take them
            while True:
                try:
                    event = next(wait)
                except StopIteration as end:
                    result = end.value
                    break
                while not event.processed:
                    yield self._env.any_of([event, self.interrupts.next_request()])
                    if self.interrupts.is_waiting:
                        passed_cclk = self.clock.until(self._env.tick)
                        self.clock.pass_waiting(reason, passed_cclk)
                        owed_cclk += passed_cclk
                        with away():
                            yield from self.serve_interrupts()
                        self.waits.present = what
        self.clock.owed_cclk = owed_cclk
        return result

    def on_interrupt(self, source: str, handler: Handler) -> None:
        """Attach the handler."""
        self.interrupts.attach(source, handler)

    def request_interrupt(self, source: str) -> None:
        """Request the interrupt."""
        self.interrupts.request(source)

    def stay_in_step(self) -> None:
        """Do nothing: the core is in step already."""
