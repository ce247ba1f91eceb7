"""Stretches of the cores: what a core does by itself is handed to the bus, which plays it and returns what it took."""

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
"""Positions of these, counted from TOUCHED."""


def played_of(words: list[int], clock_cclk: int) -> Played:
    """Return what a stretch took, from its words from TOUCHED on (`bus.state`) and its clock."""
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
        """Let a core do its operations from `first` to before `end`, with its clock at `clock_cclk`. Return the event at their end.

        They use at most `accounts` accounts. The accesses of their calls are in the core's log.
        """
        play, words = w.PLAYS_AT + core * w.PLAY_WORDS, self._words
        copies = words[play + w.COPIES]
        self._state[play + w.BEGUN_WORDS : play + w.ACCOUNTS + accounts * w.ACCOUNT_WORDS] = 0
        BEGUN.pack_into(words, 8 * play, first, end, clock_cclk, self._env.tick, w.NONE, copies)
        return self._ends.of_stretch(core)

    def at_moments(self, core: int, what: Callable[[], None]) -> None:
        """Call `what` at each moment of a core's stretches."""
        self._ends.at_moments(core, what)

    def clock_cclk(self, core: int) -> int:
        """Return a core's clock after its last stretch. Raises FirmwareError if DMA had no room for all its copies."""
        play, words = w.PLAYS_AT + core * w.PLAY_WORDS, self._words
        if words[play + w.OPERATION] < words[play + w.OPERATIONS_END]:
            raise FirmwareError(f"DMA must have at most {w.MAX_TRANSFERS} transfers to do at a time")
        cclk: int = words[play + w.CLOCK]
        return cclk

    def played(self, core: int, accounts: int) -> Played:
        """Return what a core's last stretch took, on so many `accounts`. Raises FirmwareError as above."""
        play = w.PLAYS_AT + core * w.PLAY_WORDS
        words = self._words[play + w.TOUCHED : play + w.ACCOUNTS + accounts * w.ACCOUNT_WORDS].tolist()
        return played_of(words, self.clock_cclk(core))

    def copy_of(self, core: int, number: int) -> tuple[int, int]:
        """Return number and place of the transfer of a core's copy `number`, counted over all copies that it has posted."""
        at = w.COPIES_AT + 2 * (core * w.ENDS + number % w.ENDS)
        return self._words[at], self._words[at + 1]

    def keep_plans(self, words: Sequence[Sequence[int]]) -> NDArray[np.int64]:
        """Keep plans where stretches find them, each the `words` of a `TransferPlan`. Return their numbers.

        These transfers move no bytes: if anyone looks at the bytes, they have been moved before.
        """
        numbers = np.arange(self._plans, self._plans + len(words))
        self._plans += len(words)
        if self._plans > w.MAX_PLANS:
            raise FirmwareError(f"a recorded run must have at most {w.MAX_PLANS} different copies")
        plans = self._state[w.PLANS_AT : w.PLANS_AT + self._plans * w.PLAN_WORDS].reshape(-1, w.PLAN_WORDS)
        plans[numbers, w.SETUP :] = words
        plans[numbers, w.IS_MOVED] = 1
        return numbers
