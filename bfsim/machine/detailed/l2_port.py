"""The port of L2 in the detailed mode: the cores take turns with the internal DMA [assumed]."""

from __future__ import annotations

from typing import Any

import simpy

from bfsim.chip.block_spec import L2Spec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import INTERNAL
from bfsim.machine.detailed.arbiter import Arbiter, CoreTurns, Grant, Request, count_bytes
from bfsim.machine.detailed.sdram import Page
from bfsim.machine.simulation import Simulation


class L2Port:
    """The port of L2 that both cores and the internal DMA share.

    XXX: the other DMAs use their own port, 32 bits per SCLK, and meet this one in the sub-banks of L2, which are not modelled.
    A word holds a sub-bank for at most 2 of 5 CCLK, so a core's load in the same 16 KB waits at most 0.8 CCLK longer on average,
    9 % of its latency, and in another sub-bank not at all. It is also not modelled that TESTSET stalls the other core on
    silicon before revision 0.5 (anomaly 05000248).
    """

    def __init__(self, env: Simulation, l2: L2Spec, cclk_ticks: int, words: Any) -> None:
        self._env = env
        self._arbiter = Arbiter(env, self)
        self._core_turns = CoreTurns()
        self._words = words
        self._l2 = l2
        self._cclk_ticks = cclk_ticks
        self._free = 0
        self._imdma_was_last = False

    def ask(self, master: int, owner: int, nbytes: int, *, write: bool) -> simpy.Event:
        """Request `nbytes` for a core to read or write. Return the event of the grant."""
        return self._ask_for(
            master, owner, nbytes, -(-nbytes // self._l2.port_bytes) * self._l2.next_cclk, write=write
        )

    def ask_locked(self, master: int, nbytes: int) -> simpy.Event:
        """Request a TESTSET: nothing else gets the port between its read and its write."""
        owner = w.NO_BUFFER_IN_L2
        count_bytes(self._words, master, owner, nbytes, write=True)
        return self._ask_for(master, owner, nbytes, self._l2.read_cclk + self._l2.next_cclk, write=False)

    def ask_for_word(self, master: int, times: int) -> simpy.Event:
        """Request a word of the internal DMA. `times` is 2 if it is both read and written here."""
        return self._ask_for(master, w.NO_BUFFER_IN_L2, 0, times * self._l2.next_cclk, write=False)

    def _ask_for(self, master: int, owner: int, nbytes: int, hold_cclk: int, *, write: bool) -> simpy.Event:
        granted = self._env.event()
        return self._arbiter.ask(Request(granted, master, owner, nbytes, write=write, hold_cclk=hold_cclk))

    def free_at(self) -> int:
        """Tick from which the next transaction can be served."""
        return self._free

    def is_held_up(self) -> bool:
        """Whether the memory does something of its own first: never."""
        return False

    def rank(self, request: Request) -> tuple[int, ...]:
        """Return the key of a request. The least key is served first."""
        if request.master in INTERNAL:
            return (1 if self._imdma_was_last else -1, request.master)
        return (0, *self._core_turns.rank(request.master))

    def serve(self, request: Request) -> Grant:
        """Serve the request from now on."""
        now = self._env.tick
        self._free = now + request.hold_cclk * self._cclk_ticks
        self._imdma_was_last = request.master in INTERNAL
        self._core_turns.count(request.master)
        if request.nbytes:
            count_bytes(self._words, request.master, request.owner, request.nbytes, write=request.write)
        through = now + self._l2.read_cclk * self._cclk_ticks
        return Grant(now, self._free, through, through, Page.HIT, 0)
