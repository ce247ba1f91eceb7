"""How cores meet each other: semaphores, spin locks, and the interrupt that one core raises at the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import simpy

from bfsim.chip.spec import ChipSpec
from bfsim.errors import FirmwareError
from bfsim.kernel import Work
from bfsim.kernel.calls import access_log as log
from bfsim.machine.bus.bus import Bus
from bfsim.machine.core.progress.progress import Progress
from bfsim.machine.core.synchronisation.shared_objects import SharedObjects
from bfsim.machine.core.waits import Wait
from bfsim.machine.firmware_lines import running_line
from bfsim.machine.simulation import Simulation
from bfsim.spans import SpanKind
from bfsim.trace import StallReason

UNLOCK_CCLK = 1
"""A store."""
OTHER_CORE = "SUPPLEMENTAL_0"  # the supplemental interrupt that one core raises at the other


class Synchronisation:
    """The semaphores, locks and interrupts of the other core, as core `name` uses them; `number` is its number on the bus.

    XXX: the counter of a semaphore is not read and written besides its TESTSET; that would be a load and a store in L2,
    10 to 12 CCLK. The first TESTSET of a wait decides at its end, later ones when they get the port, which is 11 CCLK
    earlier. A lock is free as soon as its store is in the store buffer, though earlier stores may still wait there.
    """

    def __init__(
        self, env: Simulation, name: str, number: int, chip: ChipSpec, bus: Bus, progress: Progress, shared: SharedObjects,
        check_claimed: Callable[[], None],
    ) -> None:  # fmt: skip
        """`check_claimed` raises an error if the firmware has forgotten to yield a call."""
        self._env = env
        self._name = name
        self._number = number
        self._chip = chip
        self._bus = bus
        self._progress = progress
        self._shared = shared
        self._handovers = shared.handovers
        self._check_claimed = check_claimed

    def post(self, name: str) -> Wait:
        """Add one to a semaphore."""
        yield from self._test_and_set(f"semaphore {name}")
        self._handovers.give(self._name, f"semaphore {name}")
        self._shared.semaphore(name).post()
        self._tell_count(name)

    def wait(self, name: str) -> Wait:
        """Take one from a semaphore."""
        yield from self._test_and_set(f"semaphore {name}")
        turn = self._shared.semaphore(name).take()
        if turn is not None:
            yield from self._take_turn(turn, f"semaphore {name!r}", f"semaphore {name}")
        self._handovers.take(self._name, f"semaphore {name}")
        self._tell_count(name)

    def lock(self, name: str) -> Wait:
        """Take a spin lock."""
        yield from self._test_and_set(f"lock {name}")
        lock = self._shared.lock(name)
        if lock.core == self._name:
            raise FirmwareError(f"core {self._name} must not take lock {name!r} again: it holds it already")
        turn = lock.take(self._name, self._described())
        if turn is not None:
            yield from self._take_turn(turn, f"lock {name!r}, held by {lock.holder}", f"lock {name}")
            lock.holder = self._described()
        lock.since_cclk = self._progress.clock.cclk
        self._handovers.take(self._name, f"lock {name}")

    def unlock(self, name: str) -> Wait:
        """Give a spin lock back."""
        # asked for at cycle 0: the store buffer has it in its own cycle, and requests the port at once
        yield from self._access(log.STORE, UNLOCK_CCLK, 0, f"lock {name}")
        lock, clock = self._shared.lock(name), self._progress.clock
        if lock.core != self._name:
            raise FirmwareError(
                f"core {self._name} must not give lock {name!r} back, which {lock.holder or 'nobody'} holds"
            )
        if timeline := self._env.timeline:
            timeline.span(SpanKind.LOCK, f"lock {name}", f"core {self._name}", lock.since_cclk, clock.cclk)
        self._handovers.give(self._name, f"lock {name}")
        lock.release()

    def interrupt_core(self, other: str) -> Wait:
        """Raise the supplemental interrupt at another core."""
        others = self._shared.interrupts
        if other not in others or other == self._name:
            raise FirmwareError(f"core {self._name} can interrupt another core of the chip, not {other!r}")
        self._progress.issue(self._chip.events.mmr_write_cclk, f"interrupt {OTHER_CORE}")
        yield from self._progress.sync()
        self._handovers.give(self._name, f"{OTHER_CORE} of core {other}")
        others[other].request(OTHER_CORE)

    def _take_turn(self, turn: simpy.Event, what: str, owner: str) -> Wait:
        """Loop around TESTSET until `turn`, when another core gives way. The first try from then on succeeds."""
        progress, cores = self._progress, self._bus.cores
        if not progress.interrupts.can_come:
            self._shared.turns[self._name] = turn
        if self._chip.l2:
            cores.spin(self._number, progress.clock.ticks)
            yield from progress.blocked(iter([turn]), what, StallReason.SEMAPHORE, away=self._not_spinning)
            self._shared.turns.pop(self._name, None)
            with progress.interrupts.held():  # the clock is still where the wait began
                yield cores.stop_spinning(self._number)
        else:
            yield from progress.blocked(iter([turn]), what, StallReason.SEMAPHORE)
            self._shared.turns.pop(self._name, None)
        progress.clock.wake(StallReason.SEMAPHORE, owner)

    @contextmanager
    def _not_spinning(self) -> Iterator[None]:
        """Stop spinning inside this context, and spin on at its end."""
        self._bus.cores.pause_spinning(self._number)
        yield
        self._bus.cores.spin(self._number, self._progress.clock.ticks)

    def _tell_count(self, name: str) -> None:
        if timeline := self._env.timeline:
            count = self._shared.semaphore(name).count
            timeline.level(f"semaphore {name}", "count", count, self._progress.clock.cclk)

    def _described(self) -> str:
        return f"core {self._name} since cycle {self._progress.clock.cclk:,} ({running_line()})"

    def _test_and_set(self, owner: str) -> Wait:
        testset_cclk = self._chip.events.testset_cclk  # the time of its memory comes on top
        yield from self._access(log.TEST_AND_SET, testset_cclk, testset_cclk, owner)

    def _access(self, kind: int, issue_cclk: int, asks_cclk: int, owner: str) -> Wait:
        """Access a shared variable in L2, in an instruction of `issue_cclk` that requests its memory at cycle `asks_cclk`.

        Simulated time then catches up. Without L2, only the issue costs cycles.
        """
        self._check_claimed()
        progress = self._progress
        if not self._chip.l2:
            progress.issue(issue_cclk, owner)
        else:
            yield from progress.sync()
            entries = self._bus.logs.log_in_l2(self._number, asks_cclk, kind)
            yield from progress.access_shared(Work(issue_cclk, 0, accesses=entries), owner)
        yield from progress.sync()
