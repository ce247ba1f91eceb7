"""The main loops of the cores, played side by side until they end, or until nothing can let a core go on."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

import simpy

from bfsim.errors import DeadlockError, FirmwareError
from bfsim.machine.core.synchronisation.shared_objects import SharedObjects
from bfsim.machine.firmware_lines import place_of
from bfsim.machine.listeners import Announcer
from bfsim.machine.main_loop import MainLoop
from bfsim.machine.simulation import Simulation


class MainLoops:
    """One main loop per core. `shared` has the objects with which they wait for each other."""

    def __init__(
        self,
        env: Simulation,
        loops: Mapping[str, MainLoop],
        shared: SharedObjects,
        announcer: Announcer,
    ) -> None:
        self._env = env
        self._loops = loops
        self._shared = shared
        self._turns = shared.turns
        self._announcer = announcer

    def play(self) -> None:
        """Play the main loops to their ends, if they have any."""
        self.play_until(self._env.all_of([self._env.process(each.play()) for each in self._loops.values()]))

    def play_until(self, event: simpy.Event) -> None:
        """Let time pass until `event`, or until nothing can let a core go on."""
        with suppress(simpy.core.EmptySchedule):
            while not (event.processed or (self._turns and self._is_deadlock())):
                self._env.step()
                self._announcer.tell_step()

    def _is_deadlock(self) -> bool:
        """Whether every core has ended or waits for another one, even if DMA and cameras go on."""
        return all(
            each.is_done or (name in self._turns and not self._turns[name].triggered)
            for name, each in self._loops.items()
        )

    def check_end(self, frames: int, *, has_more: bool) -> None:
        """Raise an error unless both main loops have ended, with the same `frames`, and with all of them.

        `has_more` says whether the recording has more. Raises DeadlockError if the cores block each other, and names
        a wait that was never begun, which may be why.
        """
        if not all(each.is_done for each in self._loops.values()):
            waits = [each.describe_wait() for each in self._loops.values()]
            forgotten = [each.forgotten_wait for each in self._loops.values() if each.forgotten_wait]
            unawaited = [
                f"semaphore {name!r} was posted, but nobody has waited for it"
                for name in self._shared.unawaited
            ]
            raise DeadlockError(f"nothing can happen any more: {'; '.join([*waits, *forgotten, *unawaited])}")
        for name, each in self._loops.items():
            if finished := each.pictures.finished:
                raise FirmwareError(
                    f"every core must take every frame, but only core {name} took frame {finished[0].index}"
                )
        early = [name for name, each in self._loops.items() if not each.pictures.is_over]
        if early and has_more:
            raise FirmwareError(
                f"the main loop of core {early[0]} must go on until next_frame gives None, not end after "
                f"{frames} frames: the recording has more ({place_of(self._loops[early[0]].main)})"
            )
