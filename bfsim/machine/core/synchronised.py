"""How cores meet each other: semaphores, spin locks, and the interrupt that one raises at the other."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from typing import Any

import simpy

from bfsim.errors import FirmwareError
from bfsim.kernel import access_trace as log
from bfsim.machine.calls.call_cache import DeferredWork
from bfsim.machine.core.handovers import Handovers
from bfsim.machine.core.interrupts import Interrupts
from bfsim.machine.core.playing import PlayingCore
from bfsim.machine.core.semaphore import Semaphore
from bfsim.machine.core.shared_access import SharedAccess
from bfsim.machine.core.spin_lock import SpinLock
from bfsim.machine.core.waits import awaited
from bfsim.machine.firmware_lines import running_line
from bfsim.spans import SpanKind
from bfsim.trace import StallReason

UNLOCK_CCLK = 1
"""A store."""
OTHER_CORE = "SUPPLEMENTAL_0"  # the supplemental interrupt that one core raises at the other


class SharedObjects:
    """What both cores know by name: semaphores, locks, and each other's interrupts."""

    def __init__(self, interrupts: Mapping[str, Interrupts]) -> None:
        self.semaphores: dict[str, Semaphore] = {}
        self.locks: dict[str, SpinLock] = {}
        self.interrupts = interrupts
        self.handovers = Handovers(interrupts)
        self.turns: dict[str, simpy.Event] = {}
        """Of each core that no device can let go on: the event at which its turn at a semaphore or lock comes."""

    def interrupt(self, source: str) -> None:
        """Interrupt every core whose firmware asked for it: each has a SIC of its own."""
        for each in self.interrupts.values():
            each.request(source)


class SynchronisedCore(PlayingCore):
    """A core's part of semaphores, locks and the other core's interrupt.

    XXX: the counter of a semaphore is not read and written beside its TESTSET, which would be a load and a store of L2,
    10 to 12 CCLK; the first TESTSET of a wait decides at its end, those behind it when they have the port, which is
    11 CCLK earlier; and a lock is free when its store is in the store buffer, though others may wait there before it.
    """

    _shared: SharedObjects

    @awaited
    def post(self, name: str) -> Generator[Any, Any, None]:
        """Add one to the semaphore `name`, in L2."""
        yield from self._test_and_set(f"semaphore {name}")
        self._handovers.give(self.name, f"semaphore {name}")
        self._semaphore(name).post()
        self._tell_count(name)

    @awaited
    def wait(self, name: str) -> Generator[Any, Any, None]:
        """Take one from the semaphore `name`, trying until another core has posted it."""
        yield from self._test_and_set(f"semaphore {name}")
        turn = self._semaphore(name).take()
        if turn is not None:
            yield from self._take_turn(turn, f"semaphore {name!r}", f"semaphore {name}")
        self._handovers.take(self.name, f"semaphore {name}")
        self._tell_count(name)

    @awaited
    def lock(self, name: str) -> Generator[Any, Any, None]:
        """Take the spin lock `name`, trying until the other core gives it back."""
        yield from self._test_and_set(f"lock {name}")
        lock = self._lock(name)
        if lock.core == self.name:
            raise FirmwareError(f"core {self.name} must not take lock {name!r} again: it holds it already")
        turn = lock.take(self.name, self._described())
        if turn is not None:
            yield from self._take_turn(turn, f"lock {name!r}, held by {lock.holder}", f"lock {name}")
            lock.holder = self._described()
        lock.since_cclk = self._cclk
        self._handovers.take(self.name, f"lock {name}")

    @awaited
    def unlock(self, name: str) -> Generator[Any, Any, None]:
        """Give the spin lock `name` back."""
        # of zero: the store buffer has it in its own cycle, and asks for the port at once
        yield from self._access(log.STORE, UNLOCK_CCLK, 0, f"lock {name}")
        lock = self._lock(name)
        if lock.core != self.name:
            raise FirmwareError(
                f"core {self.name} must not give lock {name!r} back, which {lock.holder or 'nobody'} holds"
            )
        if timeline := self._env.timeline:
            timeline.span(SpanKind.LOCK, f"lock {name}", f"core {self.name}", lock.since_cclk, self._cclk)
        self._handovers.give(self.name, f"lock {name}")
        lock.release()

    def _take_turn(self, turn: simpy.Event, what: str, owner: str) -> Generator[Any, Any, None]:
        """Wait for `turn`, when another core gives way, in a loop around TESTSET; the first try from then on succeeds."""
        if not self.can_be_interrupted:
            self._shared.turns[self.name] = turn
        if self._board.chip.l2:
            self._is_spinning = True
            self._bus.cores.spin(self._number, self.now_ticks)
        yield from self._blocked(iter([turn]), what, StallReason.SEMAPHORE)
        self._shared.turns.pop(self.name, None)
        if self._is_spinning:
            self._is_spinning = False
            before, self._in_handler = self._in_handler, True  # the clock still stands where the wait began
            yield self._bus.cores.stop_spinning(self._number)
            self._in_handler = before
        self._wake(StallReason.SEMAPHORE, owner)

    def _tell_count(self, name: str) -> None:
        if timeline := self._env.timeline:
            timeline.level(f"semaphore {name}", "count", self._semaphore(name).count, self._cclk)

    def _described(self) -> str:
        return f"core {self.name} since cycle {self._cclk:,} ({running_line()})"

    def _test_and_set(self, owner: str) -> Generator[Any, Any, None]:
        testset_cclk = self._board.chip.events.testset_cclk  # its memory comes on top
        yield from self._access(log.TEST_AND_SET, testset_cclk, testset_cclk, owner)

    def _access(self, kind: int, issue_cclk: int, asks_cclk: int, owner: str) -> Generator[Any, Any, None]:
        """Access a shared variable in L2, and let the simulated time come up to that. Without L2 it costs its issue only."""
        if not self._board.chip.l2:
            self.issue(issue_cclk, owner)
        else:
            self._check_claimed()
            self._unclaimed_kernel = None
            access = SharedAccess(self._bus, self._number, kind, issue_cclk, asks_cclk)
            self._unclaimed = DeferredWork(access, (), owner)
            yield self._unclaimed
        yield from self.sync()

    def _semaphore(self, name: str) -> Semaphore:
        return self._shared.semaphores.setdefault(name, Semaphore(self._env, name))

    def _lock(self, name: str) -> SpinLock:
        return self._shared.locks.setdefault(name, SpinLock(self._env, name))

    @awaited
    def interrupt_core(self, other: str) -> Generator[Any, Any, None]:
        """Raise the supplemental interrupt SUPPLEMENTAL_0 at another core."""
        others: Mapping[str, Interrupts] = self._shared.interrupts
        if other not in others or other == self.name:
            raise FirmwareError(f"core {self.name} can interrupt another core of the chip, not {other!r}")
        self.issue(self._board.chip.events.mmr_write_cclk, f"interrupt {OTHER_CORE}")
        yield from self.sync()
        self._handovers.give(self.name, f"{OTHER_CORE} of core {other}")
        others[other].request(OTHER_CORE)
