"""Stretches of recorded work: what a core does by itself is handed to the bus, which plays it, and says what it took."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from struct import Struct
from typing import Any

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.errors import FirmwareError
from bfsim.machine.bus import state as w
from bfsim.machine.bus.ends import Ends
from bfsim.machine.bus.transfer_plans import Played
from bfsim.machine.simulation import Simulation

BEGUN = Struct(f"@{w.BEGUN_WORDS}q")
ISSUED, STALLS, ACCOUNTS = (each - w.TOUCHED for each in (w.ISSUED, w.INTERLOCKED, w.ACCOUNTS))
"""Where these stand behind TOUCHED."""


def played_of(words: list[int], clock_cclk: int) -> Played:
    """Return what a stretch took, by its words from TOUCHED on (`bus.state`), and where its clock is."""
    touches, accounts = words[ACCOUNTS + w.TOUCH :: w.ACCOUNT_WORDS] if words[0] else [], {}
    for touch, number in sorted(zip(touches, range(len(touches)), strict=True)):
        if touch:
            begin = ACCOUNTS + number * w.ACCOUNT_WORDS
            accounts[number] = words[begin : begin + w.ACCOUNT_WORDS]
    return Played(clock_cclk, words[ISSUED], words[STALLS:ACCOUNTS], accounts)


class StretchPlayer:
    """The stretches of each core, and the plans of their copies, in the `state` of the bus."""

    def __init__(self, env: Simulation, state: NDArray[np.int64], ends: Ends) -> None:
        self._env = env
        self._state = state
        self._words: Any = state.data
        self._ends = ends
        self._plans = 0

    def play(self, core: int, clock_cclk: int, accounts: int, end: int, first: int = 0) -> simpy.Event:
        """Let a core do what is written by itself from now on, its clock being at a cycle: operations from `first` up to `end`; return the end.

        They use so many `accounts` at most. What their calls access is in the core's log.
        """
        play, words = w.PLAYS_AT + core * w.PLAY_WORDS, self._words
        copies = words[play + w.COPIES]
        self._state[play + w.BEGUN_WORDS : play + w.ACCOUNTS + accounts * w.ACCOUNT_WORDS] = 0
        BEGUN.pack_into(words, 8 * play, first, end, clock_cclk, self._env.tick, w.NONE, copies)
        return self._ends.of_stretch(core)

    def at_moments(self, core: int, what: Callable[[], None]) -> None:
        """Do `what` at each moment of a core's stretches."""
        self._ends.at_moments(core, what)

    def clock_cclk(self, core: int) -> int:
        """Return where a core's clock is after its last stretch. Raises FirmwareError if DMA had no room for all of its copies."""
        play, words = w.PLAYS_AT + core * w.PLAY_WORDS, self._words
        if words[play + w.OPERATION] < words[play + w.OPERATIONS_END]:
            raise FirmwareError(f"DMA must have at most {w.MAX_TRANSFERS} transfers to do at a time")
        cclk: int = words[play + w.CLOCK]
        return cclk

    def played(self, core: int, accounts: int) -> Played:
        """Return what the last stretch of a core took, with so many `accounts`. Raises FirmwareError as above."""
        play = w.PLAYS_AT + core * w.PLAY_WORDS
        words = self._words[play + w.TOUCHED : play + w.ACCOUNTS + accounts * w.ACCOUNT_WORDS].tolist()
        return played_of(words, self.clock_cclk(core))

    def copy_of(self, core: int, number: int) -> tuple[int, int]:
        """Return number and place of the transfer that the copy `number` of a core was, of those that it has posted."""
        at = w.COPIES_AT + 2 * (core * w.ENDS + number % w.ENDS)
        return self._words[at], self._words[at + 1]

    def keep_plans(self, words: Sequence[Sequence[int]]) -> NDArray[np.int64]:
        """Keep plans where stretches find them, each the `words` of a `TransferPlan`; return their numbers.

        Their bytes do not move: where somebody looks at them, they have been moved before.
        """
        numbers = np.arange(self._plans, self._plans + len(words))
        self._plans += len(words)
        if self._plans > w.MAX_PLANS:
            raise FirmwareError(f"a recorded run must have at most {w.MAX_PLANS} different copies")
        plans = self._state[w.PLANS_AT : w.PLANS_AT + self._plans * w.PLAN_WORDS].reshape(-1, w.PLAN_WORDS)
        plans[numbers, w.SETUP :] = words
        plans[numbers, w.IS_MOVED] = 1
        return numbers
