"""The SPI: the board is the master, and moves 16-bit words through DMA2 channel 4, one direction at a time."""

from __future__ import annotations

from math import ceil

from bfsim.chip.spi_registers import TRANSFER_WRITES, SpiRate
from bfsim.machine.bus import state as w
from bfsim.machine.peripherals.device import Device, Message
from bfsim.machine.peripherals.peripheral import Peripheral
from bfsim.machine.peripherals.wire import Surroundings, WireSpec


class SpiMessage(Message):
    """What a device on the SPI sends in one transfer: its name in the report, and its words as bytes, low byte first."""

    over = "SPI"
    word_bytes = 2  # SPI_CTL with SIZE


class SpiDevice(Device):
    """A device at the other end of the SPI, a slave with a request line. Its messages are `SpiMessage`."""


class Spi(Peripheral):
    """The SPI of the board."""

    name = SpiMessage.over
    device_kind = SpiDevice
    message_kind = SpiMessage
    transfer_writes = TRANSFER_WRITES
    wires = 1

    def __init__(self, around: Surroundings, device: Device, outside: int) -> None:
        clocks = around.board.clocks
        rate = SpiRate(baud=max(2, ceil(clocks.sclk_hz / (2 * around.board.spi_clk_hz))))
        sck_ticks = clocks.tick_hz / rate.sck_hz(clocks.sclk_hz)
        word_ticks = (8 * SpiMessage.word_bytes + rate.gap_sck) * sck_ticks
        wire = WireSpec(
            master=w.SPI, interrupt="SPI_DMA", word_bytes=SpiMessage.word_bytes, word_ticks=word_ticks
        )
        super().__init__(around, device, (wire,), outside)
