"""A DMA channel of the detailed mode: two processes with a FIFO between them, one that reads and one that writes, word by word.

A side in SDRAM requests the bus for each word. A side on the chip takes a word per cycle; the first one is read while the
channel starts. A side that is a device keeps the device's pace, and loses words that find the FIFO full.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil
from typing import Any

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.transfer_plans import Pace, TransferPlan, Walk
from bfsim.machine.detailed.arbiter import Grant, count_bytes, wait_until
from bfsim.machine.detailed.fifo import Element, Fifo
from bfsim.machine.detailed.l2_port import L2Port
from bfsim.machine.detailed.sdram_arbiter import SdramArbiter
from bfsim.machine.memories import Memories
from bfsim.machine.simulation import Simulation

Play = Generator[simpy.Event, Any, None]


@dataclass(slots=True)
class DetailedTransfer:
    """A plan in progress, from tick `at` on. `done` happens at its end, `rows` at the end of the next row that it writes."""

    number: int
    plan: TransferPlan
    at: int
    done: simpy.Event
    rows: list[simpy.Event] = field(default_factory=list)
    moved: int = 0

    def tell_row(self, moved: int) -> None:
        """Trigger the waits for a row if the last of `moved` elements ended one. The last row ends with the transfer."""
        self.moved = moved
        if moved % self.plan.destination.x_count == 0 and moved < self.plan.count:
            self.tell()

    def tell(self) -> None:
        """Trigger the waits for a row."""
        waiting, self.rows = self.rows, []
        for event in waiting:
            event.succeed()


def offsets(walk: Walk, count: int) -> Iterator[int]:
    """Yield the offsets of the first `count` elements of a walk."""
    line, first = 0, walk.offset
    for _ in range(count):
        yield first + line * walk.x_modify
        line += 1
        if line == walk.x_count:
            first += (line - 1) * walk.x_modify + walk.y_modify
            line = 0


def arrival(pace: Pace, number: int) -> int:
    """Return the tick at which a device has received or sent element `number`: the end of its time on the wire."""
    line, place = divmod(number, pace.line_elements)
    return pace.start + ceil(line * pace.line_ticks + (place + 1) * pace.element_ticks)


class DmaMaster:
    """One master with its queue of transfers. `lost` counts elements of a device that found the FIFO full."""

    def __init__(
        self,
        env: Simulation,
        board: BoardSpec,
        memories: Memories,
        sdram: SdramArbiter,
        l2: L2Port,
        words: Any,
        master: int,
    ) -> None:
        self._env = env
        self._board = board
        self._memories = memories
        self._sdram = sdram
        self._l2 = l2
        self._words = words
        self._master = master
        self._sclk = board.clocks.sclk_ticks
        self._bytes = memories.arena.data
        self._late = Fraction(0)
        self._queue = simpy.Store(env)
        self.lost = 0
        env.process(self._play())

    def post(self, transfer: DetailedTransfer) -> None:
        """Append a transfer to the queue."""
        self._queue.put(transfer)

    def _play(self) -> Generator[simpy.Event, Any, None]:
        while True:
            transfer = yield self._queue.get()
            plan = transfer.plan
            yield from wait_until(self._env, self._edge(max(self._env.tick, transfer.at) + plan.setup))
            fifo = Fifo(self._env, self._depth(), takes_turns=plan.mode == w.BOTH)
            self._env.process(self._source(plan, fifo))
            yield self._env.process(self._sink(transfer, fifo))
            self._words[w.ENDS_AT + transfer.number % w.ENDS] = self._env.tick
            transfer.tell()
            transfer.done.succeed()

    def _edge(self, tick: int) -> int:
        return -(-tick // self._sclk) * self._sclk

    def _depth(self) -> int:
        chip = self._board.chip
        return chip.dma.fifo_words + (chip.ppi_fifo_words if self._master in (w.PPI0, w.PPI1) else 0)

    def _source(self, plan: TransferPlan, fifo: Fifo) -> Play:
        if plan.mode == w.PACED_IN:
            yield from self._receive(plan, fifo)
        elif plan.source.offset < self._memories.sdram_end:
            yield from self._read_sdram(plan, fifo)
        elif plan.mode == w.THROUGH_L2_PORT:
            yield from self._read_through_l2_port(plan, fifo)
        else:
            yield from self._read_on_chip(plan, fifo)
        fifo.close()

    def _sink(self, transfer: DetailedTransfer, fifo: Fifo) -> Play:
        plan = transfer.plan
        if plan.mode == w.PACED_OUT:
            yield from self._send(transfer, fifo)
        elif plan.destination.offset < self._memories.sdram_end:
            yield from self._write_sdram(transfer, fifo)
        else:
            yield from self._write_on_chip(transfer, fifo)

    # ---- sides in SDRAM

    def _word(
        self, plan: TransferPlan, fifo: Fifo, offset: int, *, write: bool
    ) -> Generator[simpy.Event, Any, Grant]:
        """Wait for the bus, and return the result of an element's access."""

        def is_urgent() -> bool:
            if plan.mode == w.PACED_IN:
                return len(fifo) > fifo.depth // 2
            return plan.mode == w.PACED_OUT and len(fifo) < fifo.depth // 2

        yield from wait_until(self._env, self._edge(self._env.tick))
        grant: Grant = yield self._sdram.ask(
            self._master, plan.owners[write], offset, plan.element_bytes, write=write, is_urgent=is_urgent
        )
        return grant

    def _read_sdram(self, plan: TransferPlan, fifo: Fifo) -> Play:
        dma = self._board.chip.dma
        for offset in offsets(plan.source, plan.count):
            while not fifo.has_room:
                yield fifo.changed()
            grant = yield from self._word(plan, fifo, offset, write=False)
            fifo.put(Element(self._load(plan, offset), grant.through))
            pause = self._pause(dma.read_word_sclk) if plan.mode == w.READ else 0
            yield from wait_until(self._env, grant.free + pause)

    def _write_sdram(self, transfer: DetailedTransfer, fifo: Fifo) -> Play:
        plan = transfer.plan
        for number, offset in enumerate(offsets(plan.destination, plan.count)):
            if not (yield from self._next(fifo)):
                return
            grant = yield from self._word(plan, fifo, offset, write=True)
            self._store(plan, offset, fifo.first.value)
            fifo.take()
            yield from wait_until(self._env, grant.through)
            transfer.tell_row(number + 1)
            yield from wait_until(self._env, grant.free)

    def _pause(self, word_sclk: Fraction) -> int:
        """Add up the time of a word beyond one cycle. Return the ticks that are due, always for a whole FIFO of words."""
        burst = self._board.chip.dma.fifo_words
        self._late += word_sclk - 1
        cycles = int(self._late / burst) * burst
        self._late -= cycles
        return cycles * self._sclk

    def _next(self, fifo: Fifo) -> Generator[simpy.Event, Any, bool]:
        """Wait until the next element is there. Return False if there is none."""
        while not fifo.can_give:
            if fifo.is_done:
                return False
            yield fifo.changed()
        yield from wait_until(self._env, fifo.there_at)
        return True

    # ---- sides on the chip

    def _read_through_l2_port(self, plan: TransferPlan, fifo: Fifo) -> Play:
        """Read words, each in its time from the moment that the internal DMA gets the port of L2."""
        memories, word = self._memories, int(plan.pace.element_ticks)
        times = sum(
            memories.sdram_end <= each.offset < memories.l2_end for each in (plan.source, plan.destination)
        )
        for offset in offsets(plan.source, plan.count):
            grant: Grant = yield self._l2.ask_for_word(self._master, times)
            yield from wait_until(self._env, grant.at + word)
            fifo.put(Element(self._load(plan, offset), self._env.tick))

    def _read_on_chip(self, plan: TransferPlan, fifo: Fifo) -> Play:
        start = self._env.tick
        for number, offset in enumerate(offsets(plan.source, plan.count)):
            if plan.mode == w.ON_CHIP:
                yield from wait_until(self._env, start + ceil((number + 1) * plan.pace.element_ticks))
            else:
                yield from wait_until(self._env, start + number * self._sclk)
            while not fifo.has_room:
                yield fifo.changed()
            fifo.put(Element(self._load(plan, offset), self._env.tick))

    def _write_on_chip(self, transfer: DetailedTransfer, fifo: Fifo) -> Play:
        plan = transfer.plan
        for number, offset in enumerate(offsets(plan.destination, plan.count)):
            if not (yield from self._next(fifo)):
                return
            self._store(plan, offset, fifo.first.value)
            fifo.take()
            transfer.tell_row(number + 1)

    # ---- sides that are devices

    def _receive(self, plan: TransferPlan, fifo: Fifo) -> Play:
        for number, offset in enumerate(offsets(plan.source, plan.count)):
            yield from wait_until(self._env, arrival(plan.pace, number))
            if fifo.has_room:
                fifo.put(Element(self._load(plan, offset), self._env.tick))
            else:
                self.lost += 1

    def _send(self, transfer: DetailedTransfer, fifo: Fifo) -> Play:
        plan = transfer.plan
        for number, offset in enumerate(offsets(plan.destination, plan.count)):
            yield from wait_until(self._env, arrival(plan.pace, number))
            yield from self._next(fifo)
            self._store(plan, offset, fifo.first.value)
            fifo.take()
            transfer.tell_row(number + 1)

    # ---- bytes

    def _load(self, plan: TransferPlan, offset: int) -> bytes:
        self._count(plan, offset, write=False)
        return bytes(self._bytes[offset : offset + plan.element_bytes])

    def _store(self, plan: TransferPlan, offset: int, value: bytes) -> None:
        self._count(plan, offset, write=True)
        self._bytes[offset : offset + len(value)] = value

    def _count(self, plan: TransferPlan, offset: int, *, write: bool) -> None:
        """Count traffic with L2, L1 and its sub-banks. The arbiter counts traffic with SDRAM."""
        memories = self._memories
        if memories.sdram_end <= offset < memories.l2_end or offset >= memories.l1:
            count_bytes(self._words, self._master, plan.owners[write], plan.element_bytes, write=write)
        if offset >= memories.l1:
            self._words[w.SUBBANKS_AT + (offset - memories.l1) // self._board.chip.l1.subbank_bytes] += 1
