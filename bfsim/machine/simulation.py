"""SimPy's environment with time as an integer: every delay that is scheduled is a whole number of ticks."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import simpy


class Simulation(simpy.Environment):
    """The one queue of events of a board."""

    @property
    def tick(self) -> int:
        """Current time in ticks."""
        return cast(int, self._now)

    def call_at(self, tick: int, function: Callable[[simpy.Event], None]) -> None:
        """Call `function` at `tick`, which must not have passed."""
        callbacks = self.timeout(tick - self.tick).callbacks
        assert callbacks is not None
        callbacks.append(function)

    def count_events(self) -> int:
        """Return how many events were scheduled so far. Call it once, at the end: asking counts as one."""
        return next(self._eid)
