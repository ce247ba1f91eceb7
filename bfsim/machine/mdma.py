"""MDMA: a memory DMA stream copies rows between memories while the cores compute, one after the other.

A copy's end is known as soon as it starts, so the end needs no event: whoever waits for it reads `end`. For that
it asks for the bus when it starts, for the time after its start-up; who asks in between comes after it.
"""

from __future__ import annotations

from collections import deque

from bfsim.chip.spec import BoardSpec
from bfsim.machine.ebiu import BurstRate, Ebiu
from bfsim.machine.memories import Row
from bfsim.machine.simulation import Simulation
from bfsim.machine.traffic import Account


class Transfer:
    """One copy of a row. `end` is the tick at which it is done, or None as long as it has not started."""

    __slots__ = ("at", "destination", "end", "source")

    def __init__(self, source: Row, destination: Row, at: int) -> None:
        self.source = source
        self.destination = destination
        self.at = at
        self.end: int | None = None


class MdmaStream:
    """One memory DMA stream with its queue of copies."""

    def __init__(self, env: Simulation, board: BoardSpec, ebiu: Ebiu, account: Account) -> None:
        """`account`: what the stream moves to and from SDRAM."""
        self._env = env
        self._account = account
        self._read = BurstRate(board.chip.mdma_read_sclk, board.sdram.nCL)
        self._write = BurstRate(board.chip.mdma_write_sclk)
        self._sclk_ticks = board.clocks.sclk_ticks
        self._startup_ticks = board.chip.mdma_startup_sclk * self._sclk_ticks
        self._ebiu = ebiu
        self._queue: deque[Transfer] = deque()
        self._free_at = 0

    def copy(self, source: Row, destination: Row, at: int) -> Transfer:
        """Copy `source` to `destination`, not before tick `at`, after all copies asked for before."""
        transfer = Transfer(source, destination, max(at, self._env.tick))
        self._queue.append(transfer)
        if len(self._queue) == 1:
            self._env.note(max(transfer.at, self._free_at), self._begin)
        return transfer

    def _begin(self, now: int) -> None:
        """Start the first copy of the queue, and note when the one after it begins."""
        self._start(self._queue.popleft(), now)
        if self._queue:
            self._env.note(max(self._queue[0].at, self._free_at), self._begin)

    def _start(self, transfer: Transfer, now: int) -> None:
        source, destination = transfer.source, transfer.destination
        destination.octets[:] = source.octets
        ready = now + self._startup_ticks
        if source.pages:
            ready = self._ebiu.burst(self._account, ready, source, self._read, write=False)
        if destination.pages:
            ready = self._ebiu.burst(self._account, ready, destination, self._write, write=True)
        if not source.pages and not destination.pages:
            ready += self._on_chip_ticks(source)
        self._free_at = transfer.end = ready

    def _on_chip_ticks(self, row: Row) -> int:
        """Between L1 and L2 the stream moves a 32-bit word per SCLK, without the EBIU."""
        return self._write[row.words] * self._sclk_ticks
