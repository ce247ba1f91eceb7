"""The awaited ends on the bus, by number: of transfers, and of the cores' calls and stretches."""

from __future__ import annotations

from collections.abc import Callable

import simpy

from bfsim.machine.bus import state as w
from bfsim.machine.bus.stretches import end_of_stretch, moment_of
from bfsim.machine.simulation import Simulation


class Ends:
    """The awaited events. An event's number is what the weave returns when it happens."""

    def __init__(self, env: Simulation) -> None:
        self._env = env
        self._awaited: dict[int, simpy.Event] = {}
        self._moments: dict[int, Callable[[], None]] = {}

    def __bool__(self) -> bool:
        return bool(self._awaited)

    def of_transfer(self, number: int) -> simpy.Event:
        """Return the event at the end of a transfer, or of its next row if rows wake."""
        event = self._awaited.get(number)
        if event is None:
            event = self._awaited[number] = self._env.event()
        return event

    def of_call(self, core: int) -> simpy.Event:
        """Return the event at the end of a core's call."""
        return self.of_transfer(w.NONE - 1 - core)

    def of_stretch(self, core: int) -> simpy.Event:
        """Return the event at the end of a core's stretch."""
        return self.of_transfer(end_of_stretch(core))

    def at_moments(self, core: int, what: Callable[[], None]) -> None:
        """Call `what` at each moment of a core's stretches."""
        self._moments[moment_of(core)] = what

    def wake(self, number: int, tick: int) -> bool:
        """Trigger the event of a number at a tick. Return whether there is one. For a moment, do what is due then."""
        event = self._awaited.pop(number, None)
        if event is None:
            if number in self._moments:
                self._moments[number]()
            return False
        self._env.trigger_at(event, tick)
        return True
