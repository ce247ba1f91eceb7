"""SimPy's environment with time in whole ticks, which plays the bus up to each of its events.

Nothing waits for a single word on a bus; only its effect on the bus matters to the next user. So the bus is no
process. Before each event, everything earlier on the bus is played, and the end of a transfer becomes an event only
if something waits for it.
"""

from __future__ import annotations

from heapq import heappush
from typing import Protocol

import simpy
from simpy.events import NORMAL, EventPriority

from bfsim.machine.timeline import Timeline


class Followed(Protocol):
    """An object whose own time lags behind the simulation's."""

    @property
    def is_awaited(self) -> bool:
        """Whether anything waits for one of its ends."""

    def play_until(self, tick: int) -> bool:
        """Play up to `tick`. Return True if it stopped at an awaited end, whose event is on the queue."""


END_OF_TIME = 1 << 62


class Simulation(simpy.Environment):
    """The one queue of events of a board."""

    def __init__(self) -> None:
        super().__init__()
        self._bus: Followed | None = None
        self.timeline: Timeline | None = None
        """The timeline that hears what happens when, if anyone wants to know."""

    def follow(self, bus: Followed) -> None:
        """Play `bus` up to each event from now on."""
        self._bus = bus

    @property
    def tick(self) -> int:
        """Current time in ticks."""
        return self._now  # type: ignore[return-value]  # only whole delays are ever scheduled

    def after(self, ticks: int) -> simpy.Timeout:
        """Return the event after so many ticks (like `timeout`, without its detour through a descriptor)."""
        return simpy.Timeout(self, ticks)

    def trigger_at(self, event: simpy.Event, tick: int) -> None:
        """Let `event` happen at `tick`, which must not be over yet."""
        event._ok = True  # noqa: SLF001  # as simpy.Timeout does
        event._value = None  # noqa: SLF001
        self.schedule(event, delay=max(0, tick - self.tick))

    def schedule(
        self, event: simpy.Event, priority: EventPriority = NORMAL, delay: simpy.core.SimTime = 0
    ) -> None:
        """Put an event on the queue. Ctrl-C, which SimPy would keep as the failure of a process, ends the simulation at once.

        Before that failure's turn came, another core could begin something endless. (Calling SimPy's own method for the rest takes as
        long as an event.)
        """
        if not event._ok and isinstance(event._value, KeyboardInterrupt):  # noqa: SLF001  # the process has not happened yet
            raise event._value  # noqa: SLF001
        heappush(self._queue, (self._now + delay, priority, next(self._eid), event))

    def step(self) -> None:
        """Play the bus up to the next event, or to an awaited end before it; then process the event."""
        bus = self._bus
        if bus is not None and bus.is_awaited:
            while bus.play_until(self._queue[0][0] if self._queue else END_OF_TIME):  # type: ignore[arg-type]
                pass
        super().step()

    def count_events(self) -> int:
        """Return how many events were scheduled so far. Call this once, at the end: each call counts as an event."""
        return next(self._eid)
