"""The stages of a replayed core: within a stretch, machine code goes from one to the next (`left_stage`) and separates their costs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.machine.bus import state as w
from bfsim.machine.bus.stretch_player import ACCOUNTS, played_of
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.core.parts import Parts
from bfsim.machine.retiming.left_stage import (
    CONFLICTS,
    COST_WORDS,
    OF_STRETCH,
    end_stretch,
    leave_stage,
)
from bfsim.machine.retiming.work_check import not_there
from bfsim.machine_code.built_in import built_in
from bfsim.trace import REST, StallReason


@dataclass(slots=True)
class ReplayedStage:
    """The stage `name`. Machine code keeps its `costs`: `leave` at its end, `end` at the end of a stretch in it.

    `kept` are arrays whose addresses machine code has.
    """

    name: str
    costs: NDArray[np.int64]
    end: Callable[[int], int]
    leave: Callable[[int], int]
    kept: tuple[NDArray[Any], ...] = ()


class ReplayedStages:
    """The stages of one core. `pass_mark` lets its counters count the events up to the next mark."""

    def __init__(self, parts: Parts, bus: WovenBus, pass_mark: Callable[[], None]) -> None:
        self._pass_mark = pass_mark
        self._clock, self._calls, self._stretches = parts.clock, parts.calls, bus.stretches
        self._name, self._core = parts.name, parts.number
        self._state_at = np.asarray(bus.words).ctypes.data
        self._entered = np.zeros(1, np.int64)
        self._stages: list[ReplayedStage] = []
        self._present = 0
        self._passed: dict[int, None] = {0: None}  # since the last charge
        self._owners: Sequence[str] = ()
        self.know([REST])
        bus.stretches.at_moments(parts.number, self._leave)

    def know(self, names: Iterable[str]) -> None:
        """Add stages, numbered after the known ones."""
        for name in names:
            costs = np.zeros(COST_WORDS, np.int64)
            end = built_in(end_stretch.address(), 1, self._state_at, self._core, costs.ctypes.data)
            self._stages.append(ReplayedStage(name, costs, end, end))
            self._look_at(self._stages[-1])

    def use(self, owners: Sequence[str]) -> None:
        """Use these owners of accounts, by number, from now on."""
        self._owners = owners

    @property
    def count(self) -> int:
        """Number of known stages."""
        return len(self._stages)

    @property
    def must_look(self) -> bool:
        """Whether the current stage has new calls that must be looked at before it ends."""
        return self._calls.groups_in(self._stages[self._present].name).has_new

    def look(self) -> None:
        """Look at what the calls of the current stage access."""
        self._look_at(self._stages[self._present])

    def _look_at(self, stage: ReplayedStage) -> None:
        calls, banks = self._calls, self._calls.sub_banks
        spread, before = calls.groups_in(stage.name).look()
        events = np.zeros(len(before), np.int64)
        counters_at, _ = calls.counters_at
        stage.kept = spread, before, events
        stage.leave = built_in(
            leave_stage.address(), 1, *banks.at, self._core, self._entered.ctypes.data, counters_at, calls.conflicts_at,
            stage.costs.ctypes.data, banks.conflict_cclk, spread.ctypes.data, before.ctypes.data, len(before), events.ctypes.data,
        )  # fmt: skip

    def _leave(self) -> None:
        """Go on to the next stage, at a moment of a stretch."""
        try:
            self._pass_mark()
        except ValueError as error:
            raise not_there(self._name, error) from error
        self._present = self._stages[self._present].leave(len(self._owners))
        self._passed[self._present] = None

    def charge(self) -> None:
        """Charge each stage for its cost since the last charge: a stretch has ended."""
        clock, cclk, accounts = self._clock, self._stretches.clock_cclk(self._core), len(self._owners)
        self._stages[self._present].end(accounts)
        for number in self._passed:
            stage = self._stages[number]
            clock.accounts.enter(stage.name)
            costs = stage.costs[: OF_STRETCH + ACCOUNTS + accounts * w.ACCOUNT_WORDS]
            words = costs.tolist()
            if not any(words):
                continue
            costs[:] = 0
            clock.stretch(played_of(words[OF_STRETCH:], cclk), self._owners)
            if words[CONFLICTS]:
                clock.accounts.now.kernels.stall(StallReason.L1_CONFLICT, words[CONFLICTS])
        clock.cclk = cclk
        name = self._stages[self._present].name
        clock.accounts.enter(name)
        if self._calls.stage != name:
            self._calls.enter(name)
        self._passed = {self._present: None}
