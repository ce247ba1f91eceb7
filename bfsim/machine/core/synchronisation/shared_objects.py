"""What both cores know by name: semaphores, locks, and each other's interrupts."""

from __future__ import annotations

from collections.abc import Mapping

import simpy

from bfsim.machine.core.interrupts import Interrupts
from bfsim.machine.core.synchronisation.handovers import Handovers
from bfsim.machine.core.synchronisation.semaphore import Semaphore
from bfsim.machine.core.synchronisation.spin_lock import SpinLock
from bfsim.machine.simulation import Simulation


class SharedObjects:
    """What both cores know by name: semaphores, locks, and each other's interrupts."""

    def __init__(self, env: Simulation, interrupts: Mapping[str, Interrupts]) -> None:
        self._env = env
        self._semaphores: dict[str, Semaphore] = {}
        self._locks: dict[str, SpinLock] = {}
        self.interrupts = interrupts
        self.handovers = Handovers(interrupts)
        self.turns: dict[str, simpy.Event] = {}
        """By core that waits and that no device can release: the event at which its turn at a semaphore or lock comes."""

    def semaphore(self, name: str) -> Semaphore:
        """Return the semaphore `name`."""
        return self._semaphores.setdefault(name, Semaphore(self._env, name))

    @property
    def unawaited(self) -> list[str]:
        """Names of the semaphores that were posted but never taken."""
        return [name for name, each in self._semaphores.items() if each.count and not each.taken]

    def lock(self, name: str) -> SpinLock:
        """Return the spin lock `name`."""
        return self._locks.setdefault(name, SpinLock(self._env, name))

    def interrupt(self, source: str) -> None:
        """Interrupt every core whose firmware has a handler for it: each core has its own SIC."""
        for each in self.interrupts.values():
            each.request(source)
