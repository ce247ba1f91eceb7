"""Shared variables in L2 by which the cores wait for each other: counting semaphores made of TESTSET."""

from __future__ import annotations

from collections import deque

import simpy

from bfsim.machine.simulation import Simulation


class Semaphore:
    """A counter that never falls below zero. Waiters are served in order of arrival."""

    def __init__(self, env: Simulation, name: str) -> None:
        self.name = name
        self.taken = 0
        """How often it was taken, by any core."""
        self._env = env
        self._count = 0
        self._waiters: deque[simpy.Event] = deque()

    @property
    def count(self) -> int:
        """The counter."""
        return self._count

    def post(self) -> None:
        """Add one, or let the first waiter go on."""
        if self._waiters:
            self.taken += 1
            self._waiters.popleft().succeed()
        else:
            self._count += 1

    def take(self) -> simpy.Event | None:
        """Subtract one and return None, or return the event at which this waiter's turn comes."""
        if self._count:
            self._count -= 1
            self.taken += 1
            return None
        event = self._env.event()
        self._waiters.append(event)
        return event
