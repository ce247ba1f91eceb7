"""A spin lock in shared memory: a byte that TESTSET sets, retried until the other core has cleared it."""

from __future__ import annotations

from collections import deque

import simpy

from bfsim.machine.simulation import Simulation


class SpinLock:
    """A lock that waiters get in order of arrival. `holder` describes the core that has it, None if it is free."""

    def __init__(self, env: Simulation, name: str) -> None:
        self.name = name
        self.taken = 0
        """How often it was taken, by any core."""
        self.core: str | None = None
        self.holder: str | None = None
        self.since_cclk = 0
        """When it was taken, by the clock of the core that holds it."""
        self._env = env
        self._waiters: deque[tuple[simpy.Event, str]] = deque()

    def take(self, core: str, holder: str) -> simpy.Event | None:
        """Give the lock to `core`, or return the event at which it gets it."""
        if self.core is None:
            self.core, self.holder = core, holder
            self.taken += 1
            return None
        event = self._env.event()
        self._waiters.append((event, core))
        return event

    def release(self) -> None:
        """Free the lock, or hand it on."""
        self.core = self.holder = None
        if self._waiters:
            event, self.core = self._waiters.popleft()
            self.taken += 1
            self.holder = f"core {self.core}"
            event.succeed()
