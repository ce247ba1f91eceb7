"""The stage that a core is in: the row of the budget that its cycles go to, and the cost of its conflicts in L1."""

from __future__ import annotations

from functools import partial

from bfsim.errors import FirmwareError, shown
from bfsim.machine.bus.bus import Bus
from bfsim.machine.calls.call_cache import CallCache
from bfsim.machine.calls.conflicts import Accesses
from bfsim.machine.core.clock.accounts import KERNELS
from bfsim.machine.core.progress.progress import Progress
from bfsim.trace import StallReason


class Stages:
    """The stages of a core's firmware, called `names`."""

    def __init__(self, names: tuple[str, ...], progress: Progress, calls: CallCache, bus: Bus) -> None:
        self._names = names
        self._progress = progress
        self._clock = progress.clock
        self._calls = calls
        self._bus = bus
        self._entered_at_cclk = 0

    @property
    def present(self) -> str:
        """The firmware's current stage."""
        return self._calls.stage

    def check(self, name: str) -> None:
        """Raise FirmwareError unless there is a stage `name`."""
        if name not in self._names:
            known = (
                f"one of {', '.join(self._names)}"
                if self._names
                else "one of the firmware's rows, which has none"
            )
            raise FirmwareError(f"stage must be {known}, not {shown(name)}")

    def enter(self, stage: str) -> None:
        """Enter another stage, and charge the previous one for its conflicts in L1."""
        accessed = self._calls.accessed()
        self._calls.enter(stage)
        self._progress.when_there(partial(self._change_account, stage, accessed))

    def _change_account(self, stage: str, accessed: Accesses) -> None:
        """Let cycles go to `stage` from now on. Conflicts among what was `accessed` in L1 are charged to the previous stage."""
        self._bus.settle()
        clock = self._clock
        conflicts_cclk = self._calls.conflicts_cclk(accessed, clock.cclk - self._entered_at_cclk)
        if conflicts_cclk:
            clock.stall(StallReason.L1_CONFLICT, conflicts_cclk, KERNELS)
        self._entered_at_cclk = clock.cclk
        if clock.timeline:
            clock.timeline.enter(stage, clock.cclk)
        clock.accounts.enter(stage)
