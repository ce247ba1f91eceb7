"""Stretches of recorded work: what a core does by itself is handed to the bus, which plays it, and says what it took."""

from __future__ import annotations

from typing import Any

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.errors import FirmwareError
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import CoreLogs
from bfsim.machine.bus.ends import Ends
from bfsim.machine.bus.transfer_plans import Played
from bfsim.machine.simulation import Simulation


class StretchPlayer:
    """The stretches of each core, and the plans of their copies, in the `state` of the bus."""

    def __init__(self, env: Simulation, state: NDArray[np.int64], logs: CoreLogs, ends: Ends) -> None:
        self._env = env
        self._state = state
        self._words: Any = state.data
        self._logs = logs
        self._ends = ends
        self._plans = 0

    def play(
        self, core: int, clock_cclk: int, operations: NDArray[np.int64], accesses: NDArray[np.int64]
    ) -> simpy.Event:
        """Let a core do `operations` by itself from now on, its clock being at a cycle; return the end.

        `operations`: rows of OPERATION_WORDS as in `bus.state`, at most MAX_OPERATIONS of them. `accesses`: the log that those
        of their calls refer to, a row of entries and one of sites.
        """
        play = w.PLAYS_AT + core * w.PLAY_WORDS
        copies = self._words[play + w.COPIES]
        self._state[play : play + w.PLAY_WORDS] = 0
        for word, value in (
            (w.OPERATIONS_END, len(operations)), (w.CLOCK, clock_cclk), (w.ACTS_AT, self._env.tick),
            (w.AWAITED, w.NONE), (w.COPIES, copies),
        ):  # fmt: skip
            self._words[play + word] = value
        first = w.OPERATIONS_AT + core * w.MAX_OPERATIONS * w.OPERATION_WORDS
        self._state[first : first + operations.size] = operations.reshape(-1)
        self._logs.replace(core, accesses)
        return self._ends.of_stretch(core)

    def played(self, core: int) -> Played:
        """Return what the last stretch of a core took. Raises FirmwareError if DMA had no room for all of its copies."""
        play = w.PLAYS_AT + core * w.PLAY_WORDS
        words: list[int] = self._words[play : play + w.PLAY_WORDS].tolist()
        if words[w.OPERATION] < words[w.OPERATIONS_END]:
            raise FirmwareError(f"DMA must have at most {w.MAX_TRANSFERS} transfers to do at a time")
        accounts = [
            words[each : each + w.ACCOUNT_WORDS] for each in range(w.ACCOUNTS, w.PLAY_WORDS, w.ACCOUNT_WORDS)
        ]
        used = sorted((each[w.TOUCH], number) for number, each in enumerate(accounts) if each[w.TOUCH])
        return Played(
            clock_cclk=words[w.CLOCK],
            issue_cclk=words[w.ISSUED],
            interlocks_cclk=words[w.INTERLOCKED],
            bus_stalls_cclk=words[w.ON_BUS : w.ACCOUNTS],
            accounts={number: accounts[number] for _, number in used},
        )

    def keep_plans(self, words: NDArray[np.int64]) -> NDArray[np.int64]:
        """Keep plans where stretches find them, each a row of the `words` of a `TransferPlan`; return their numbers."""
        numbers = np.arange(self._plans, self._plans + len(words))
        self._plans += len(words)
        if self._plans > w.MAX_PLANS:
            raise FirmwareError(f"a recorded run must have at most {w.MAX_PLANS} different copies")
        plans = self._state[w.PLANS_AT : w.PLANS_AT + self._plans * w.PLAN_WORDS].reshape(-1, w.PLAN_WORDS)
        plans[numbers, w.SETUP :] = words
        return numbers
