"""SimPy's environment with time as an integer: every delay that is scheduled is a whole number of ticks."""

from __future__ import annotations

from collections.abc import Callable

import simpy


class Simulation(simpy.Environment):
    """The one queue of events of a board."""

    @property
    def tick(self) -> int:
        """Current time in ticks."""
        return self._now  # type: ignore[return-value]  # only whole delays are ever scheduled

    def after(self, ticks: int) -> simpy.Timeout:
        """Return the event that happens in so many ticks (as `timeout`, without its detour through a descriptor)."""
        return simpy.Timeout(self, ticks)

    def call_at(self, tick: int, function: Callable[[simpy.Event], None]) -> None:
        """Call `function` at `tick`, which must not have passed."""
        callbacks = simpy.Timeout(self, tick - self.tick).callbacks
        assert callbacks is not None
        callbacks.append(function)

    def count_events(self) -> int:
        """Return how many events were scheduled so far. Call it once, at the end: asking counts as one."""
        return next(self._eid)
