"""The UART: bytes go out through DMA2 channel 6 and in through channel 5, simultaneously, between two ends with their own clocks.

XXX: UART_TX_DMA comes with the last stop bit; on the chip it comes when the last byte is in UART_THR, up to two bytes earlier. No
bytes come while the board does not receive: the device waits for it, as with a flag as a clear-to-send line.
"""

from __future__ import annotations

from fractions import Fraction

from bfsim.chip.uart_registers import FRAME_BITS, TRANSFER_WRITES, rate_for
from bfsim.errors import ConfigError, FirmwareError, shown
from bfsim.machine.bus import state as w
from bfsim.machine.peripherals.device import Device, Message
from bfsim.machine.peripherals.peripheral import Peripheral
from bfsim.machine.peripherals.wire import Surroundings, WireSpec


class UartMessage(Message):
    """What a device on the UART sends in one transfer: its name in the report, and its bytes."""

    over = "UART"
    word_bytes = 1


class UartDevice(Device):
    """A device at the other end of the UART, with 8 data bits, no parity and one stop bit. Its messages are `UartMessage`.

    `baud` is the rate at which it sends and listens. The board's divisor latch is set to its nearest rate, at which the board
    sends. The two rates must be close enough for both to understand each other.
    """

    baud: Fraction | int = 115_200


class Uart(Peripheral):
    """The UART of the board."""

    name = UartMessage.over
    device_kind = UartDevice
    message_kind = UartMessage
    transfer_writes = TRANSFER_WRITES
    wires = 2

    def __init__(self, around: Surroundings, device: Device, outside: int) -> None:
        clocks, theirs = around.board.clocks, _baud_of(device)
        try:
            ours = rate_for(theirs, clocks.sclk_hz).baud(clocks.sclk_hz)
        except ConfigError as error:
            raise FirmwareError(f"baud of {type(device).__name__}: {error}") from None
        out, into = (
            WireSpec(
                master=master,
                interrupt=interrupt,
                word_bytes=UartMessage.word_bytes,
                word_ticks=FRAME_BITS * clocks.tick_hz / baud,
            )
            for master, interrupt, baud in (
                (w.UART_TX, "UART_TX_DMA", ours),
                (w.UART_RX, "UART_RX_DMA", theirs),
            )
        )
        super().__init__(around, device, (out, into), outside)


def _baud_of(device: Device) -> Fraction:
    assert isinstance(device, UartDevice), "the table has checked it"
    if isinstance(device.baud, bool) or not isinstance(device.baud, int | Fraction):
        raise FirmwareError(
            f"baud of {type(device).__name__} must be an int or a Fraction, not {shown(device.baud)}"
        )
    return Fraction(device.baud)
