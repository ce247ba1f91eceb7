"""What the bus tells the timeline: its transfers, when they are over, and how much of the time it is busy.

The compiled code knows of none of it. When a transfer began follows from its end and from those of its master before it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import CORE_ROWS, DMA_MASTERS, INTERNAL, NAMED
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.bus.traffic import traffic_in
from bfsim.machine.timeline import Timeline
from bfsim.spans import SpanKind

NAMES = {master: name for name, masters in NAMED.items() for master in masters}
MOST_PENDING = 1024
"""Transfers that are noted before those that are over are told: far fewer than the ends that the bus remembers."""
SAMPLE_CCLK = 60_000
"""Cycles, at least, that a number for the load of a bus is of: 100 µs at 600 MHz."""

_CORES = [row for rows in CORE_ROWS.values() for row in rows]
_BUSY = {"DMA": [each.number for each in DMA_MASTERS], "cores": _CORES}
_AT_L2_PORT = (*INTERNAL, *_CORES)
"""Who comes through the port of L2 that is modelled."""


class _Posted(NamedTuple):
    """A transfer that was posted: its number and name, the tick from which it may begin, and its bytes."""

    number: int
    name: str
    at: int
    nbytes: int


class ToldBus:
    """A bus as the timeline sees it. `words`: the bus's state."""

    def __init__(
        self, timeline: Timeline, board: BoardSpec, words: Sequence[int], owners: MemoryOwners
    ) -> None:
        self._timeline = timeline
        self._words = words
        self._owners = owners
        self._l2 = board.chip.l2
        self._cclk_ticks = board.clocks.cclk_ticks
        self._posted: dict[int, deque[_Posted]] = {}
        self._pending: dict[int, bool] = {}  # by number: whether a core waited for its end
        self._free_at: dict[int, int] = {}
        self._sampled_cclk = 0
        self._next_sample = SAMPLE_CCLK * self._cclk_ticks
        self._busy = dict.fromkeys(_BUSY, 0)
        self._l2_bytes = 0

    # ---- transfers

    def post(self, master: int, number: int, name: str, at: int, nbytes: int, now: int) -> None:
        """Note a transfer that may begin at tick `at`."""
        if len(self._pending) >= MOST_PENDING:
            self.tell(now)
        self._pending[number] = False
        self._posted.setdefault(master, deque()).append(_Posted(number, name, at, nbytes))

    def flow_of(self, number: int) -> int:
        """Return the flow from a transfer to the wait that it has just ended; 0 if it was told already."""
        if number not in self._pending:
            return 0
        self._pending[number] = True
        return number + 1

    def tell(self, now: int) -> None:
        """Tell the transfers that were over before tick `now`: nobody begins to wait for them any more."""
        for master, posted in self._posted.items():
            while posted and w.NONE != (end := self._words[w.ENDS_AT + posted[0].number % w.ENDS]) < now:
                number, name, at, nbytes = posted.popleft()
                begin, self._free_at[master] = max(at, self._free_at.get(master, 0)), end
                flow = number + 1 if self._pending.pop(number) else 0
                edges = self._timeline.cclk(begin), self._timeline.cclk(end)
                self._timeline.span(SpanKind.TRANSFER, NAMES[master], name, *edges, nbytes, flow)

    # ---- load

    def sample(self, now: int) -> None:
        """Tell how busy the bus was since the last time, if that is long enough ago; it has come up to tick `now`."""
        if now < self._next_sample:
            return
        now_cclk = now // self._cclk_ticks
        elapsed_cclk = now_cclk - self._sampled_cclk
        self._next_sample = now + SAMPLE_CCLK * self._cclk_ticks
        for who, masters in _BUSY.items():
            before, self._busy[who] = self._busy[who], self._sum("SDRAM", masters, [w.BUSY])
            percent = 100 * (self._busy[who] - before) // (elapsed_cclk * self._cclk_ticks)
            self._timeline.level("SDRAM bus", f"busy with {who}, %", percent, self._sampled_cclk)
        if self._l2:
            before, self._l2_bytes = (
                self._l2_bytes,
                self._sum("L2", _AT_L2_PORT, [w.READ_BYTES, w.WRITTEN_BYTES]),
            )
            held_cclk = (self._l2_bytes - before) * self._l2.next_cclk // self._l2.port_bytes
            self._timeline.level("L2 port", "busy, %", 100 * held_cclk // elapsed_cclk, self._sampled_cclk)
        self._sampled_cclk = now_cclk

    def _sum(self, memory: str, masters: Sequence[int], counters: Sequence[int]) -> int:
        """Return the sum of some counters of some masters over all buffers in a memory."""
        owners = [number for number, each in enumerate(self._owners) if each.memory == memory]
        return int(traffic_in(self._words)[np.ix_(owners, masters, counters)].sum())
