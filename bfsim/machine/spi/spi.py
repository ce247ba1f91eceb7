"""SPI: messages to and from the device at its other end, word by word through DMA2 channel 4, one direction at a time."""

from __future__ import annotations

from collections.abc import Callable, Generator
from fractions import Fraction
from math import ceil
from typing import Any

import numpy as np
import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.chip.spi_registers import SpiRate
from bfsim.errors import FirmwareError, shown
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.transfer_plans import Pace, Transfer, Walk
from bfsim.machine.memories import Memories, Row
from bfsim.machine.simulation import Simulation
from bfsim.machine.spi.device import LARGEST_MESSAGE_BYTES, WORD_BYTES, SpiDevice, SpiMessage, device_at_work
from bfsim.spans import SpanKind
from bfsim.trace import MessageRecord


class Spi:
    """The SPI of the board, with a device on it. `busy` is the event at which the present transfer ends."""

    def __init__(
        self, env: Simulation, board: BoardSpec, bus: Bus, memories: Memories, device: SpiDevice,
        on_interrupt: Callable[[], None], outside: int,
    ) -> None:  # fmt: skip
        """`outside`: where in the arena a message stands on its way. `on_interrupt`: called when DMA is done."""
        self._env = env
        self._bus = bus
        self._memories = memories
        self._device = device
        self._on_interrupt = on_interrupt
        self._outside = outside
        self._clocks = board.clocks
        rate = SpiRate(baud=max(2, ceil(board.clocks.sclk_hz / (2 * board.spi_clk_hz))))
        sck_ticks = board.clocks.tick_hz / rate.sck_hz(board.clocks.sclk_hz)
        self._word_ticks: Fraction = (8 * WORD_BYTES + rate.gap_sck) * sck_ticks
        self.busy: simpy.Event | None = None
        self.records: list[MessageRecord] = []
        """Every message so far, in order of their ends."""

    @property
    def has_message(self) -> bool:
        """Whether the device has something to say, and the wire is free for it."""
        if self.busy is not None:
            return False
        with device_at_work():
            return bool(self._device.requests(self._now_ns))

    @property
    def _now_ns(self) -> int:
        return self._clocks.ns_of_ticks(self._env.tick)

    def send(self, row: Row, nbytes: int) -> None:
        """Begin to send the first `nbytes` of `row`."""
        if not 0 < nbytes <= min(row.nbytes, LARGEST_MESSAGE_BYTES) or nbytes % WORD_BYTES:
            raise FirmwareError(
                f"a message must have 2 to {min(row.nbytes, LARGEST_MESSAGE_BYTES)} bytes of {row.buffer}, whole words, not {nbytes}"
            )
        self.busy = self._env.process(self._send(row, nbytes, self.busy))

    def _send(self, row: Row, nbytes: int, before: simpy.Event | None) -> Generator[Any, Any, None]:
        """Send, once the transfer `before` is through: both cores may have waited for that one."""
        if before is not None:
            yield before
        begin = self._env.tick
        plan = self._bus.planner.send(
            w.SPI, self._walk(row.offset, nbytes), self._walk(self._outside, nbytes), nbytes // WORD_BYTES,
            element_bytes=WORD_BYTES, pace=self._pace(nbytes), name=f"{row.buffer} → out",
        )  # fmt: skip
        yield self._bus.when_done(self._bus.post(plan))
        octets = self._memories.bytes_from(self._outside, nbytes).tobytes()
        with device_at_work():
            kind = self._device.receive(octets, self._now_ns)
        if not isinstance(kind, str):
            raise FirmwareError(f"receive of the device on the SPI must return a str, not {shown(kind)}")
        self._record("out", kind, nbytes, begin)
        self._finish(self._env.active_process)

    def _finish(self, transfer: simpy.Event | None) -> None:
        """End `transfer`, which is the present one unless another one has queued up behind it."""
        if self.busy is transfer:
            self.busy = None
        self._on_interrupt()

    def receive(self, row: Row) -> tuple[Transfer, int]:
        """Begin to take the next message into `row`; return the transfer and its bytes.

        DMA takes as many words as `row` has room for; what the device sends beyond them is lost.
        """
        message = self._next_message()
        nbytes = min(len(message.octets), row.nbytes // WORD_BYTES * WORD_BYTES)
        self._memories.bytes_from(self._outside, nbytes)[:] = np.frombuffer(message.octets, np.uint8, nbytes)
        plan = self._bus.planner.receive(
            w.SPI, self._walk(self._outside, nbytes), self._walk(row.offset, nbytes), nbytes // WORD_BYTES,
            element_bytes=WORD_BYTES, pace=self._pace(nbytes), name=f"{message.type} → {row.buffer}",
        )  # fmt: skip
        transfer = self._bus.post(plan)
        begin, self.busy = self._env.tick, self._bus.when_done(transfer)
        assert self.busy.callbacks is not None
        kind = message.type if nbytes == len(message.octets) else f"{message.type} (cut short)"
        self.busy.callbacks.append(
            lambda done: self._received(done, kind, nbytes, begin)
        )  # before any core goes on
        return transfer, nbytes

    def _next_message(self) -> SpiMessage:
        with device_at_work():
            message = self._device.send(self._now_ns)
        if not isinstance(message, SpiMessage):
            raise FirmwareError(
                f"send of the device on the SPI must return an SpiMessage, not {shown(message)}"
            )
        return message

    def _received(self, transfer: simpy.Event, kind: str, nbytes: int, begin: int) -> None:
        self._record("in", kind, nbytes, begin)
        self._finish(transfer)

    def _walk(self, offset: int, nbytes: int) -> Walk:
        return Walk(offset, nbytes // WORD_BYTES, WORD_BYTES, WORD_BYTES)

    def _pace(self, nbytes: int) -> Pace:
        words = nbytes // WORD_BYTES
        return Pace(self._env.tick, words, self._word_ticks, words * self._word_ticks)

    def _record(self, direction: str, kind: str, nbytes: int, begin: int) -> None:
        cclk_ticks = self._clocks.cclk_ticks
        if timeline := self._env.timeline:
            edges = timeline.cclk(begin), timeline.cclk(self._env.tick)
            timeline.span(SpanKind.MESSAGE, "SPI", f"{kind} {direction}", *edges, nbytes)
        self.records.append(
            MessageRecord(
                direction=direction, type=kind, nbytes=nbytes,
                begin_cclk=begin // cclk_ticks, end_cclk=-(-self._env.tick // cclk_ticks),
            )
        )  # fmt: skip
