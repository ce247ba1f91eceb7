"""The messages that a core sends and receives over peripherals."""

from __future__ import annotations

from collections.abc import Mapping

from bfsim.errors import FirmwareError, shown
from bfsim.machine.core.progress.progress import Progress
from bfsim.machine.core.waits import Wait
from bfsim.machine.memories import Row
from bfsim.machine.peripherals.peripheral import Peripheral
from bfsim.trace import StallReason


class Messages:
    """The messages of one core over `peripherals`, by name."""

    def __init__(self, progress: Progress, peripherals: Mapping[str, Peripheral]) -> None:
        self._progress = progress
        self._peripherals = peripherals

    def send(self, row: Row, nbytes: int, over: str) -> Wait:
        """Send the first `nbytes` of `row`, once the previous message is out."""
        peripheral, progress = self._peripheral(over), self._progress
        yield from progress.sync()
        if peripheral.sending is not None:
            yield from progress.blocked(iter([peripheral.sending]), f"the {over}", StallReason.RING_FULL)
            progress.clock.wake(StallReason.RING_FULL, over)
        progress.program_device(over, writes=peripheral.transfer_writes)
        yield from progress.sync()
        peripheral.send(row, nbytes)

    def receive(self, row: Row, over: str) -> Wait:
        """Receive the next message into `row`. Return its bytes, 0 if there is none."""
        peripheral, progress = self._peripheral(over), self._progress
        yield from progress.sync()
        if not peripheral.has_message:
            return 0
        progress.program_device(over, writes=peripheral.transfer_writes)
        yield from progress.sync()
        if not peripheral.has_message:  # the other core was faster
            return 0
        transfer, nbytes = peripheral.receive(row)
        yield from progress.wait_transfer(transfer, StallReason.RING_EMPTY, over)
        return nbytes

    def _peripheral(self, name: str) -> Peripheral:
        if name not in self._peripherals:
            raise FirmwareError(f"messages must go over {' or '.join(self._peripherals)}, not {shown(name)}")
        return self._peripherals[name]
