"""SimPy's environment with time in whole ticks, which plays the bus up to each of its events.

A word on a bus has no one who waits for it; only what it does to the bus matters to whoever comes next. So the bus is no
process: before each event everything on it that comes earlier is played, and the end of a transfer becomes an event only
if somebody waits for it.
"""

from __future__ import annotations

from heapq import heappush
from typing import Protocol

import simpy
from simpy.events import NORMAL, EventPriority

from bfsim.machine.timeline import Timeline


class Followed(Protocol):
    """What keeps its own time behind the simulation's."""

    @property
    def is_awaited(self) -> bool:
        """Whether somebody waits for one of its ends."""

    def play_until(self, tick: int) -> bool:
        """Play up to `tick`; return True when it stopped at an end, whose event is on the queue."""


END_OF_TIME = 1 << 62


class Simulation(simpy.Environment):
    """The one queue of events of a board."""

    def __init__(self) -> None:
        super().__init__()
        self._bus: Followed | None = None
        self.timeline: Timeline | None = None
        """What is told what happens when, if anybody wants to know."""

    def follow(self, bus: Followed) -> None:
        """Play `bus` up to each event from now on."""
        self._bus = bus

    @property
    def tick(self) -> int:
        """Current time in ticks."""
        return self._now  # type: ignore[return-value]  # only whole delays are ever scheduled

    def after(self, ticks: int) -> simpy.Timeout:
        """Return the event that happens in so many ticks (as `timeout`, without its detour through a descriptor)."""
        return simpy.Timeout(self, ticks)

    def trigger_at(self, event: simpy.Event, tick: int) -> None:
        """Let `event` happen at `tick`, which is not over yet."""
        event._ok = True  # noqa: SLF001  # as simpy.Timeout does
        event._value = None  # noqa: SLF001
        self.schedule(event, delay=max(0, tick - self.tick))

    def schedule(
        self, event: simpy.Event, priority: EventPriority = NORMAL, delay: simpy.core.SimTime = 0
    ) -> None:
        """Put an event on the queue; but Ctrl-C, which SimPy would keep as the failure of a process, ends the simulation at once.

        Until that failure had its turn, another core could begin what does not end. (To call SimPy's own for the rest takes as long as
        an event does.)
        """
        if not event._ok and isinstance(event._value, KeyboardInterrupt):  # noqa: SLF001  # the process has not happened yet
            raise event._value  # noqa: SLF001
        heappush(self._queue, (self._now + delay, priority, next(self._eid), event))

    def step(self) -> None:
        """Play the bus up to the next event, or to an end before it that somebody waits for; then process the event."""
        bus = self._bus
        if bus is not None and bus.is_awaited:
            while bus.play_until(self._queue[0][0] if self._queue else END_OF_TIME):  # type: ignore[arg-type]
                pass
        super().step()

    def count_events(self) -> int:
        """Return how many events were scheduled so far. Call it once, at the end: asking counts as one."""
        return next(self._eid)
