"""SPI: messages to and from the strategy unit, word by word through DMA2 channel 4, one direction at a time."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator
from fractions import Fraction
from math import ceil
from typing import Any

import numpy as np
import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.chip.spi_registers import SpiRate
from bfsim.errors import FirmwareError
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import Bus, Pace, Transfer, Walk
from bfsim.machine.memories import Memories, Row
from bfsim.machine.simulation import Simulation
from bfsim.machine.spi.protocol import MessageError, MessageType, decode
from bfsim.machine.spi.strategy import StrategyUnit
from bfsim.trace import MessageRecord

WORD_BYTES, WORD_BITS = 2, 16  # SPI_CTL with SIZE
DAMAGED = "damaged"  # the type, in the records, of what came in and is no message
OUTSIDE_BYTES = 4096
"""Room for a message on its way, in the arena."""


class Spi:
    """The SPI of the board, with the strategy unit on it. `busy` is the event at which the present transfer ends."""

    def __init__(
        self, env: Simulation, board: BoardSpec, bus: Bus, memories: Memories, strategy: StrategyUnit,
        on_interrupt: Callable[[], None], outside: int,
    ) -> None:  # fmt: skip
        """`outside`: where in the arena a message stands on its way. `on_interrupt`: called when DMA is done."""
        self._env = env
        self._bus = bus
        self._memories = memories
        self._strategy = strategy
        self._on_interrupt = on_interrupt
        self._outside = outside
        self._cclk_ticks = board.clocks.cclk_ticks
        rate = SpiRate(baud=max(2, ceil(board.clocks.sclk_hz / (2 * board.spi_clk_hz))))
        sck_ticks = board.clocks.tick_hz / rate.sck_hz(board.clocks.sclk_hz)
        self._word_ticks: Fraction = (WORD_BITS + rate.gap_sck) * sck_ticks
        self._results = 0
        self._waiting = deque(strategy.due(0))
        self.busy: simpy.Event | None = None
        self.records: list[MessageRecord] = []
        """Every message so far, in order of their ends."""

    @property
    def has_message(self) -> bool:
        """Whether the strategy unit has something to say."""
        return bool(self._waiting) and self.busy is None

    def send(self, row: Row, nbytes: int) -> None:
        """Begin to send the first `nbytes` of `row`."""
        if not 0 < nbytes <= min(row.nbytes, OUTSIDE_BYTES) or nbytes % WORD_BYTES:
            raise FirmwareError(
                f"a message must have 2 to {min(row.nbytes, OUTSIDE_BYTES)} bytes of {row.buffer}, whole words, not {nbytes}"
            )
        self.busy = self._env.process(self._send(row, nbytes, self.busy))

    def _send(self, row: Row, nbytes: int, before: simpy.Event | None) -> Generator[Any, Any, None]:
        """Send, once the transfer `before` is through: both cores may have waited for that one."""
        if before is not None:
            yield before
        begin = self._env.tick
        plan = self._bus.plan_send(
            w.SPI, self._walk(row.offset, nbytes), self._walk(self._outside, nbytes), nbytes // WORD_BYTES,
            element_bytes=WORD_BYTES, pace=self._pace(nbytes),
        )  # fmt: skip
        yield self._bus.when_done(self._bus.post(plan))
        octets = self._memories.bytes_from(self._outside, nbytes).tobytes()
        message = self._strategy.receive(octets, self._env.tick)
        self._record("out", message.type.name, message.sequence, nbytes, begin)
        if message.type is MessageType.RESULTS:
            self._results += 1
            self._waiting.extend(self._strategy.due(self._results))
        self._finish(self._env.active_process)

    def _finish(self, transfer: simpy.Event | None) -> None:
        """End `transfer`, which is the present one unless another one has queued up behind it."""
        if self.busy is transfer:
            self.busy = None
        self._on_interrupt()

    def receive(self, row: Row) -> tuple[Transfer, int]:
        """Begin to take the next message into `row`; return the transfer and its bytes.

        DMA takes as many words as `row` has room for; what the strategy unit sends beyond them is lost.
        """
        octets = self._waiting.popleft()
        nbytes = min(len(octets), row.nbytes // WORD_BYTES * WORD_BYTES, OUTSIDE_BYTES)
        self._memories.bytes_from(self._outside, nbytes)[:] = np.frombuffer(octets, np.uint8, nbytes)
        plan = self._bus.plan_receive(
            w.SPI, self._walk(self._outside, nbytes), self._walk(row.offset, nbytes), nbytes // WORD_BYTES,
            element_bytes=WORD_BYTES, pace=self._pace(nbytes),
        )  # fmt: skip
        transfer = self._bus.post(plan)
        begin, self.busy = self._env.tick, self._bus.when_done(transfer)
        assert self.busy.callbacks is not None
        self.busy.callbacks.append(
            lambda done: self._received(done, octets[:nbytes], begin)
        )  # before any core goes on
        return transfer, nbytes

    def _received(self, transfer: simpy.Event, octets: bytes, begin: int) -> None:
        try:
            message = decode(octets)
        except MessageError:  # the firmware is to find out
            self._record("in", DAMAGED, 0, len(octets), begin)
        else:
            self._record("in", message.type.name, message.sequence, len(octets), begin)
        self._finish(transfer)

    def _walk(self, offset: int, nbytes: int) -> Walk:
        return Walk(offset, nbytes // WORD_BYTES, WORD_BYTES, WORD_BYTES)

    def _pace(self, nbytes: int) -> Pace:
        words = nbytes // WORD_BYTES
        return Pace(self._env.tick, words, self._word_ticks, words * self._word_ticks)

    def _record(self, direction: str, kind: str, sequence: int, nbytes: int, begin: int) -> None:
        self.records.append(
            MessageRecord(
                direction=direction, type=kind, sequence=sequence, nbytes=nbytes,
                begin_cclk=begin // self._cclk_ticks, end_cclk=-(-self._env.tick // self._cclk_ticks),
            )
        )  # fmt: skip
