"""What the bus tells the timeline: its transfers, once they are over, and the share of time that it is busy.

The compiled code knows nothing of this. The begin of a transfer follows from its own end and from its master's earlier transfers.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import CORE_ROWS, DMA_MASTERS, INTERNAL, NAMED
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.bus.traffic import TRAFFIC_SHAPE, traffic_in
from bfsim.machine.timeline import Timeline
from bfsim.spans import SpanKind
from bfsim.spans.columns import SpanColumns

NAMES = {master: name for name, masters in NAMED.items() for master in masters}
MOST_PENDING = 1024
"""Most noted transfers before finished ones are told: far fewer than the ends that the bus remembers."""
SAMPLE_CCLK = 60_000
"""Least cycles over which the load of a bus is averaged: 100 µs at 600 MHz."""

_CORES = [row for rows in CORE_ROWS.values() for row in rows]
_BUSY = {"DMA": [each.number for each in DMA_MASTERS], "cores": _CORES}
_TRANSFER = SpanKind.TRANSFER
_AT_L2_PORT = (*INTERNAL, *_CORES)
"""The masters that use the modelled port of L2."""


class _Posted(NamedTuple):
    """A posted transfer: its number and name, the tick from which it may begin, and its bytes."""

    number: int
    name: str
    at: int
    nbytes: int


class ToldBus:
    """Tells the timeline about a bus, whose state is in `words`."""

    def __init__(
        self, timeline: Timeline, board: BoardSpec, words: Sequence[int], owners: MemoryOwners
    ) -> None:
        self._timeline = timeline
        self._words = words
        self._traffic = traffic_in(words).reshape(-1)
        self._owners = owners
        self._known_owners = 0
        self._l2 = board.chip.l2
        self._cclk_ticks = board.clocks.cclk_ticks
        self._posted: dict[int, deque[_Posted]] = {}
        self._pending: dict[int, bool] = {}  # by number: whether a core waited for its end
        self._free_at: dict[int, int] = {}
        self._sampled_cclk = 0
        self.next_sample = SAMPLE_CCLK * self._cclk_ticks
        """The tick at which the load is told next, once the bus has reached it."""
        self._sums = [0] * (len(_BUSY) + 1)
        self.before: list[Callable[[], None]] = []
        """Functions to call before transfers are told."""

    # ---- transfers

    def post(self, master: int, number: int, name: str, at: int, nbytes: int, now: int) -> None:
        """Note a transfer that may begin at tick `at`."""
        if len(self._pending) >= MOST_PENDING:
            self.tell(now)
        self.note(master, number, name, at, nbytes)

    def note(self, master: int, number: int, name: str, at: int, nbytes: int) -> None:
        """Note a transfer that a core posted while it ran ahead."""
        self._pending[number] = False
        self._posted.setdefault(master, deque()).append(_Posted(number, name, at, nbytes))

    def flow_of(self, number: int) -> int:
        """Return the flow from a transfer to the wait that it has just ended, 0 if the transfer was told already."""
        if number not in self._pending:
            return 0
        self._pending[number] = True
        return number + 1

    def tell(self, now: int) -> None:
        """Tell the transfers that were over before tick `now`: no wait for them can begin any more.

        Before that, cores that run ahead tell what the bus has played for them, and which transfers they have waited for.
        """
        for each in self.before:
            each()
        words, what_of = self._words, self._timeline.whats.number
        told: list[tuple[int, ...]] = []
        for master, posted in self._posted.items():
            where, free_at = NAMES[master], self._free_at.get(master, 0)
            while posted and w.NONE != (end := words[w.ENDS_AT + posted[0].number % w.ENDS]) < now:
                number, name, at, nbytes = posted.popleft()
                flow = number + 1 if self._pending.pop(number) else 0
                told.append((what_of(_TRANSFER, where, name), max(at, free_at), end, 0, nbytes, flow, 0))
                free_at = end
            self._free_at[master] = free_at
        if told:
            columns = np.array(told, np.int64)
            columns[:, 1:3] = -(-columns[:, 1:3] // self._cclk_ticks)
            self._timeline.tell(SpanColumns.of(self._timeline.whats, columns))

    # ---- load

    def sample(self, now: int) -> None:
        """Tell how busy the bus was since the last sample, if that is long enough ago. The bus has reached tick `now`."""
        if now < self.next_sample:
            return
        now_cclk = now // self._cclk_ticks
        elapsed_cclk = now_cclk - self._sampled_cclk
        self.next_sample = now + SAMPLE_CCLK * self._cclk_ticks
        before, self._sums = self._sums, self._summed()
        *busy, l2_bytes = (after - first for first, after in zip(before, self._sums, strict=True))
        for who, ticks in zip(_BUSY, busy, strict=True):
            percent = 100 * ticks // (elapsed_cclk * self._cclk_ticks)
            self._timeline.level("SDRAM bus", f"busy with {who}, %", percent, self._sampled_cclk)
        if self._l2:
            held_cclk = l2_bytes * self._l2.next_cclk // self._l2.port_bytes
            self._timeline.level("L2 port", "busy, %", 100 * held_cclk // elapsed_cclk, self._sampled_cclk)
        self._sampled_cclk = now_cclk

    def _summed(self) -> list[int]:
        """Return how long SDRAM has been busy with each kind of master so far, and the bytes that went through the port of L2."""
        if len(self._owners) != self._known_owners:
            self._known_owners = len(self._owners)
            parts = [self._places("SDRAM", masters, [w.BUSY]) for masters in _BUSY.values()]
            parts.append(self._places("L2", _AT_L2_PORT, [w.READ_BYTES, w.WRITTEN_BYTES]))
            self._counters = np.concatenate(parts)
            self._begins = np.cumsum([0, *map(len, parts[:-1])])
        sums: list[int] = np.add.reduceat(self._traffic[self._counters], self._begins).tolist()
        return sums

    def _places(self, memory: str, masters: Sequence[int], counters: Sequence[int]) -> NDArray[np.intp]:
        """Return where the counters of some masters are, for all buffers in a memory."""
        owners = [number for number, each in enumerate(self._owners) if each.memory == memory]
        grid = np.ix_(owners, masters, counters)
        return np.ravel_multi_index(np.broadcast_arrays(*grid), TRAFFIC_SHAPE).ravel()
