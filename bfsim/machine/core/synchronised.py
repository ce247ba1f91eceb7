"""How cores meet each other and the devices: semaphores, spin locks and interrupts."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from typing import Any

from bfsim.errors import FirmwareError
from bfsim.machine.core.clock import CoreClock
from bfsim.machine.core.interrupts import Handler, Interrupts
from bfsim.machine.core.semaphore import Semaphore
from bfsim.machine.core.spin_lock import SpinLock
from bfsim.machine.firmware_lines import running_line
from bfsim.trace import StallReason

OTHER_CORE = "SUPPLEMENTAL_0"  # the supplemental interrupt that one core raises at the other


class SharedObjects:
    """What both cores know by name: semaphores, locks, and each other's interrupts."""

    def __init__(self) -> None:
        self.semaphores: dict[str, Semaphore] = {}
        self.locks: dict[str, SpinLock] = {}
        self.interrupts: dict[str, Interrupts] = {}


class SynchronisedCore(CoreClock):
    """A core's part of semaphores, locks and interrupts."""

    _shared: SharedObjects
    _interrupts: Interrupts
    _in_handler: bool

    # ---- semaphores and locks, in L2

    def post(self, name: str) -> Generator[Any, Any, None]:
        """Add one to the semaphore `name`, in L2."""
        yield from self._test_and_set()
        self._semaphore(name).post()

    def wait(self, name: str) -> Generator[Any, Any, None]:
        """Take one from the semaphore `name`, waiting until another core has posted it."""
        yield from self._test_and_set()
        turn = self._semaphore(name).take()
        if turn is not None:
            yield from self._blocked(iter([turn]), f"semaphore {name!r}")
            self._wake(StallReason.SEMAPHORE)

    def lock(self, name: str) -> Generator[Any, Any, None]:
        """Take the spin lock `name`, trying until the other core gives it back. Whole turns of the spin loop are waited."""
        yield from self._test_and_set()
        lock = self._lock(name)
        if lock.core == self.name:
            raise FirmwareError(f"core {self.name} must not take lock {name!r} again: it holds it already")
        turn = lock.take(self.name, self._described())
        if turn is not None:
            yield from self._blocked(iter([turn]), f"lock {name!r}, held by {lock.holder}")
            self._wake(StallReason.SEMAPHORE, self._test_and_set_cclk() + self._board.chip.events.spin_cclk)
            lock.holder = self._described()

    def unlock(self, name: str) -> Generator[Any, Any, None]:
        """Give the spin lock `name` back."""
        self.issue(1)  # a store of zero, posted
        yield from self._sync()
        lock = self._lock(name)
        if lock.core != self.name:
            raise FirmwareError(
                f"core {self.name} must not give lock {name!r} back, which {lock.holder or 'nobody'} holds"
            )
        lock.release()

    def _described(self) -> str:
        return f"core {self.name} since cycle {self._cclk:,} ({running_line()})"

    def _test_and_set_cclk(self) -> int:
        chip = self._board.chip
        return chip.events.testset_cclk + (chip.l2.read_cclk if chip.l2 else 0)

    def _test_and_set(self) -> Generator[Any, Any, None]:
        testset_cclk = self._board.chip.events.testset_cclk
        self.issue(testset_cclk)
        if self._board.chip.l2:
            self.stall(StallReason.L2_LATENCY, self._test_and_set_cclk() - testset_cclk)
        yield from self._sync()

    def _semaphore(self, name: str) -> Semaphore:
        return self._shared.semaphores.setdefault(name, Semaphore(self._env, name))

    def _lock(self, name: str) -> SpinLock:
        return self._shared.locks.setdefault(name, SpinLock(self._env, name))

    # ---- interrupts

    def on_interrupt(self, source: str, handler: Handler) -> None:
        """Have `handler(core)` called at every interrupt of `source`, such as MDMA1_0, SPI_DMA or SUPPLEMENTAL_0.

        A handler may be a generator function that yields kernels.
        """
        self._interrupts.attach(source, handler)

    def request_interrupt(self, source: str) -> None:
        """Ask this core for an interrupt, as a device does."""
        self._interrupts.request(source)

    def interrupt_core(self, other: str) -> Generator[Any, Any, None]:
        """Raise the supplemental interrupt SUPPLEMENTAL_0 at another core."""
        others: Mapping[str, Interrupts] = self._shared.interrupts
        if other not in others or other == self.name:
            raise FirmwareError(f"core {self.name} can interrupt another core of the chip, not {other!r}")
        self.issue(self._board.chip.events.mmr_write_cclk)
        yield from self._sync()
        others[other].request(OTHER_CORE)

    def idle(self) -> Generator[Any, Any, None]:
        """Wait for an interrupt, and let its handler run; one that was asked for already ends the wait at once."""
        before, self._in_handler = self._in_handler, True
        yield from self._sync()
        self._in_handler = before
        if not self._interrupts.is_waiting:
            yield from self._blocked(iter([self._interrupts.next_request()]), "an interrupt")
            self._wake(None)
        if not self._in_handler:
            yield from self._take_interrupts()

    def _blocked(self, wait: Any, what: str) -> Generator[Any, Any, Any]:
        """Play `wait`, a generator of events, saying meanwhile what the core waits for; interrupts are taken as they come."""
        if self._interrupts.are_handled and not self._in_handler:
            wait = self._interruptible(wait)
        return super()._blocked(wait, what)

    def _interruptible(self, wait: Any) -> Generator[Any, Any, Any]:
        owed_cclk, what = 0, self.waiting_for
        self._in_handler = True  # the clock still stands where the wait began: nobody else may take them
        while True:
            try:
                event = next(wait)
            except StopIteration as end:
                result = end.value
                break
            while not event.processed:
                yield self._env.any_of([event, self._interrupts.next_request()])
                if self._interrupts.is_waiting:
                    passed_cclk = self._until(self._env.tick)
                    self._cclk += passed_cclk
                    owed_cclk += passed_cclk
                    yield from self._take_interrupts()
                    self.waiting_for = what
        self._in_handler = False
        self._owed_cclk = owed_cclk
        return result

    def _take_interrupts(self) -> Generator[Any, Any, None]:
        """Run the handlers of all interrupts that wait; the way in and out is a stall."""
        events = self._board.chip.events
        before, self._in_handler = self._in_handler, True
        while self._interrupts.is_waiting:
            handler = self._interrupts.take()
            self.stall(StallReason.INTERRUPT, events.interrupt_entry_cclk)
            task = handler(self)
            if isinstance(task, Generator):
                yield from self._perform(task)
            self.stall(StallReason.INTERRUPT, events.interrupt_exit_cclk)
        self._in_handler = before

    def _perform(self, task: Generator[Any, Any, Any]) -> Generator[Any, Any, None]:
        """Play a generator of the firmware."""
        raise NotImplementedError
