"""The main loops of the cores, played side by side until they end, or until nothing lets a core go on any more."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

import simpy

from bfsim.errors import DeadlockError, FirmwareError
from bfsim.machine.core.core import Core
from bfsim.machine.firmware_lines import place_of
from bfsim.machine.listeners import Announcer
from bfsim.machine.program import Main
from bfsim.machine.simulation import Simulation


class MainLoops:
    """One main loop a core. `turns`: of each core that only another one can let go on, the event for which it waits."""

    def __init__(
        self,
        env: Simulation,
        cores: Mapping[str, Core],
        mains: Mapping[str, Main],
        turns: Mapping[str, simpy.Event],
        announcer: Announcer,
    ) -> None:
        self._env = env
        self._cores = cores
        self._mains = mains
        self._turns = turns
        self._announcer = announcer

    def play(self) -> None:
        """Play the main loops to their ends, if they have any."""
        self.play_until(
            self._env.all_of(
                [self._env.process(core.play(self._mains[name])) for name, core in self._cores.items()]
            )
        )

    def play_until(self, event: simpy.Event) -> None:
        """Let time pass until `event`, or until nothing can happen any more that lets a core go on."""
        with suppress(simpy.core.EmptySchedule):
            while not (event.processed or (self._turns and self._is_deadlock())):
                self._env.step()
                self._announcer.tell_step()

    def _is_deadlock(self) -> bool:
        """Whether every core has ended or waits for another one, whatever DMA and cameras go on doing."""
        return all(
            core.is_done or (name in self._turns and not self._turns[name].triggered)
            for name, core in self._cores.items()
        )

    def check_end(self, frames: int, *, has_more: bool) -> None:
        """Raise an error unless both main loops have ended, with the same `frames`, and with all of them.

        `has_more`: whether the recording has. Raises DeadlockError when the cores block each other.
        """
        if not all(core.is_done for core in self._cores.values()):
            waits = "; ".join(core.describe_wait() for core in self._cores.values())
            raise DeadlockError(f"nothing can happen any more: {waits}")
        for name, core in self._cores.items():
            if core.finished:
                raise FirmwareError(
                    f"every core must take every frame, but only core {name} took frame {core.finished[0].index}"
                )
        early = [name for name, core in self._cores.items() if not core.is_over]
        if early and has_more:
            raise FirmwareError(
                f"the main loop of core {early[0]} must go on until next_frame gives None, not end after "
                f"{frames} frames: the recording has more ({place_of(self._mains[early[0]])})"
            )
