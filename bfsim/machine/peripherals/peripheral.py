"""A peripheral other than a camera: a serial port that moves messages by DMA between buffers of the firmware and a device."""

from __future__ import annotations

from typing import ClassVar

import simpy

from bfsim.errors import FirmwareError, shown
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.memories import Row
from bfsim.machine.peripherals.device import LARGEST_MESSAGE_BYTES, Device, Message, device_at_work, notes_of
from bfsim.machine.peripherals.wire import Surroundings, Wire, WireSpec
from bfsim.spans import SpanKind
from bfsim.trace import MessageRecord


class Peripheral:
    """The common part of all peripherals. Each says its name, the classes of its messages and device, and its wires."""

    name: ClassVar[str]
    """Its name in firmware, records and reports. Firmware provides its device under this name in lower case."""
    device_kind: ClassVar[type[Device]]
    message_kind: ClassVar[type[Message]]
    transfer_writes: ClassVar[int]
    """Registers to write for a transfer."""
    wires: ClassVar[int]
    """Number of simultaneous transfers. Each needs room for a message outside."""

    def __init__(
        self, around: Surroundings, device: Device, specs: tuple[WireSpec, ...], outside: int
    ) -> None:
        """`specs` of the wire out and the wire in, or of one for both. `outside` is where messages are on their way."""
        self._around = around
        self._device = device
        wires = [
            Wire(around, each, outside + number * LARGEST_MESSAGE_BYTES) for number, each in enumerate(specs)
        ]
        self._out, self._in = wires[0], wires[-1]
        self.records: list[MessageRecord] = []
        """All messages so far, in order of their ends."""

    @property
    def sending(self) -> simpy.Event | None:
        """The event at which the wire out becomes free, None if it is free."""
        return self._out.busy

    @property
    def busy(self) -> list[simpy.Event]:
        """The ends of all transfers under way."""
        return [each.busy for each in dict.fromkeys((self._out, self._in)) if each.busy is not None]

    @property
    def has_message(self) -> bool:
        """Whether the device has something to send, and the wire is free for it."""
        if self._in.busy is not None:
            return False
        with device_at_work(self.name):
            return bool(self._device.requests(self._now_ns))

    @property
    def notes(self) -> tuple[str, ...]:
        """Warnings for the user, now that the run is over: about lost words, and from the device."""
        lost = self._in.lost
        loss = (f"{lost} words came while the FIFO of the DMA was full, and were lost",) if lost else ()
        return (*loss, *notes_of(self._device, self.name))

    def send(self, row: Row, nbytes: int) -> None:
        """Begin to send the first `nbytes` of `row`."""
        least, most = self.message_kind.word_bytes, min(row.nbytes, LARGEST_MESSAGE_BYTES)
        if not 0 < nbytes <= most or nbytes % least:
            raise FirmwareError(
                f"a message must have {least} to {most} bytes of {row.buffer}, whole words, not {nbytes}"
            )
        self._out.send(row, nbytes, self._sent)

    def _sent(self, octets: bytes, begin: int) -> None:
        with device_at_work(self.name):
            kind = self._device.receive(octets, self._now_ns)
        if not isinstance(kind, str):
            raise FirmwareError(
                f"receive of the device on the {self.name} must return a str, not {shown(kind)}"
            )
        self._record("out", kind, len(octets), begin)

    def receive(self, row: Row) -> tuple[Transfer, int]:
        """Begin to receive the next message into `row`. Return the transfer and its bytes. Words without room there are lost."""
        with device_at_work(self.name):
            message = self._device.send(self._now_ns)
        if not isinstance(message, self.message_kind):
            wanted = self.message_kind.__name__
            raise FirmwareError(
                f"send of the device on the {self.name} must return {wanted}, not {shown(message)}"
            )

        def received(nbytes: int, begin: int) -> None:
            is_whole = nbytes == len(message.octets)
            self._record("in", message.type if is_whole else f"{message.type} (cut short)", nbytes, begin)

        return self._in.receive(message.octets, row, message.type, received)

    @property
    def _now_ns(self) -> int:
        return self._around.board.clocks.ns_of_ticks(self._around.env.tick)

    def _record(self, direction: str, kind: str, nbytes: int, begin: int) -> None:
        env, cclk_ticks = self._around.env, self._around.board.clocks.cclk_ticks
        if timeline := env.timeline:
            edges = timeline.cclk(begin), timeline.cclk(env.tick)
            timeline.span(SpanKind.MESSAGE, self.name, f"{kind} {direction}", *edges, nbytes)
        self.records.append(
            MessageRecord(
                over=self.name, direction=direction, type=kind, nbytes=nbytes,
                begin_cclk=begin // cclk_ticks, end_cclk=-(-env.tick // cclk_ticks),
            )
        )  # fmt: skip
