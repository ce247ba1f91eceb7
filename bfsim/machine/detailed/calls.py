"""The cores on the buses of the detailed mode: what each core has its port do."""

from __future__ import annotations

from collections.abc import Sequence

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus.core_calls import spin_ticks
from bfsim.machine.bus.core_logs import CoreLogs
from bfsim.machine.detailed.core import CorePort, Spin
from bfsim.machine.simulation import Simulation


class DetailedCalls:
    """`CoreCalls` access by access, by the `ports` of the cores."""

    def __init__(self, env: Simulation, board: BoardSpec, logs: CoreLogs, ports: Sequence[CorePort]) -> None:
        self._env = env
        self._logs = logs
        self._ports = ports
        self._spin_ticks = spin_ticks(board)
        self._spins: dict[int, Spin] = {}

    def access(self, core: int, begin: int, cclk: int, entries: int) -> simpy.Event:
        """Play a call's accesses."""
        done = self._env.event()
        accesses = self._logs.accesses(core, cclk, entries)
        self._env.process(self._ports[core].call(begin, cclk, accesses, done))
        return done

    def spin(self, core: int, since: int) -> None:
        """Spin until `stop_spinning`."""
        self._spins[core] = self._ports[core].spin(since + self._spin_ticks, self._spin_ticks)

    def pause_spinning(self, core: int) -> None:
        """Pause the spinning."""
        self._spins[core].is_paused = True

    def stop_spinning(self, core: int) -> simpy.Event:
        """Let the next try be the last one."""
        self._spins[core].won_at = self._env.tick
        return self._spins[core].done

    def stalls_of(self, core: int) -> Sequence[int]:
        """Return the stalls of the last call."""
        return self._ports[core].stalls
