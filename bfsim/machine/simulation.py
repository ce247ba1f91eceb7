"""SimPy's environment with time in whole ticks, and an agenda for what must happen in order but need not be an event.

The start of a DMA burst has no one who waits for it; only what it does to the bus matters to whoever comes next.
Such things are noted on the agenda with their tick, and done in order of time as soon as anyone looks at the
state they change. That gives the same result as an event each, at a fraction of the cost.
"""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush

import simpy


class Simulation(simpy.Environment):
    """The one queue of events of a board, and its agenda."""

    def __init__(self) -> None:
        super().__init__()
        self._agenda: list[tuple[int, int, Callable[[int], None]]] = []
        self._noted = 0

    @property
    def tick(self) -> int:
        """Current time in ticks."""
        return self._now  # type: ignore[return-value]  # only whole delays are ever scheduled

    def after(self, ticks: int) -> simpy.Timeout:
        """Return the event that happens in so many ticks (as `timeout`, without its detour through a descriptor)."""
        return simpy.Timeout(self, ticks)

    def note(self, tick: int, action: Callable[[int], None]) -> None:
        """Have `action(tick)` done at `tick`; of several at one tick, the first noted is the first done."""
        self._noted += 1
        heappush(self._agenda, (tick, self._noted, action))

    def settle(self) -> None:
        """Do what was noted up to now, in order. Call it before looking at, or adding to, what actions change."""
        agenda, now = self._agenda, self._now
        while agenda and agenda[0][0] <= now:
            tick, _, action = heappop(agenda)
            action(tick)

    def until_next_note(self) -> simpy.Timeout:
        """Return the event at which the next action is due; there must be one."""
        return self.after(self._agenda[0][0] - self.tick)

    def count_events(self) -> int:
        """Return how many events were scheduled so far. Call it once, at the end: asking counts as one."""
        return next(self._eid)
