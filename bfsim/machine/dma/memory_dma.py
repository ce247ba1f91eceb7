"""Memory DMA as firmware programs it: the registers of a stream's two channels, descriptors, and the resulting transfers."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from typing import Any

import simpy

from bfsim.chip.dma_channels import BF561_CHANNELS
from bfsim.chip.dma_registers import ELEMENT_BYTES
from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.masters import STREAMS
from bfsim.machine.bus.transfer_plans import Transfer, Walk
from bfsim.machine.core.progress.progress import Progress
from bfsim.machine.core.waits import awaited
from bfsim.machine.dma.channel import ChannelStep, DmaChannel, check_pair
from bfsim.machine.dma.checks import DmaSpace
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.dma.unit import WorkUnit
from bfsim.machine.firmware_lines import running_line
from bfsim.machine.memories import Memories
from bfsim.machine.simulation import Simulation


class Dma:
    """The memory DMA streams of a chip. Both cores can program each of them."""

    def __init__(
        self, env: Simulation, board: BoardSpec, bus: Bus, memories: Memories, space: DmaSpace
    ) -> None:
        self._env = env
        self._board = board
        self._bus = bus
        self._memories = memories
        self._space = space
        self._streams: dict[str, MemoryDma] = {}

    def stream(self, name: str, progress: Progress) -> MemoryDma:
        """Return the stream `name`. From now on, the core with this progress programs its registers."""
        known = [each for each in STREAMS if each in self._board.chip.interrupts.__members__]
        if name not in known:
            raise FirmwareError(f"a memory DMA stream must be one of {', '.join(known)}, not {name!r}")
        if name not in self._streams:
            self._streams[name] = MemoryDma(
                self._env, self._board, self._bus, self._memories, self._space, name
            )
        self._streams[name].is_of(progress)
        return self._streams[name]


class MemoryDma:
    """One stream: a source channel, which reads memory, and a destination channel, which writes it.

    Firmware sets the registers with `program` and starts both channels with `start`. The words move while the core goes on.
    """

    def __init__(
        self, env: Simulation, board: BoardSpec, bus: Bus, memories: Memories, space: DmaSpace, name: str
    ) -> None:
        controller, number = name.rsplit("_", 1)
        self.name = name
        self._env = env
        self._bus = bus
        self._memories = memories
        self._dma = board.chip.dma
        self._sclk_ticks = board.clocks.sclk_ticks
        self.source = DmaChannel(BF561_CHANNELS[f"{controller}_S{number}"], space, self._read16)
        self.destination = DmaChannel(BF561_CHANNELS[f"{controller}_D{number}"], space, self._read16)
        self.done: simpy.Event | None = None
        """The event at which the current work ends, None if nothing was started."""
        self._stopping = False
        self._last: Transfer | None = None

    def _read16(self, address: int) -> int:
        offset = self._memories.offset_of(address, 2)
        return int.from_bytes(self._memories.bytes_from(offset, 2).tobytes(), "little")

    def program(self, *, source: Mapping[str, int], destination: Mapping[str, int]) -> None:
        """Set registers of the two channels, such as START_ADDR=row.address, X_COUNT=160, X_MODIFY=4."""
        place = running_line()
        for channel, registers in ((self.source, source), (self.destination, destination)):
            for register, value in registers.items():
                channel.write(register, value, place)
        self._progress.program_device(self.name, writes=len(source) + len(destination))

    def is_of(self, progress: Progress) -> None:
        """Let the core with this progress program the stream from now on."""
        self._progress = progress
        self._waits = progress.waits

    @awaited
    def start(self, source: DmaConfig, destination: DmaConfig) -> Generator[Any, Any, None]:
        """Write both CONFIG registers, which starts the first work unit. Raises MmrError for what the chip would flag."""
        place = running_line()
        self._progress.program_device(self.name, writes=2)
        yield from self._progress.sync()
        steps = self.source.start(source, place), self.destination.start(destination, place)
        check_pair(self.source, self.destination)
        self._stopping = False
        self.done = self._env.process(self._run(*steps))

    def stop(self) -> None:
        """Write both CONFIG registers with DMAEN=0. The work unit under way is completed; the chip would cut it short."""
        self._progress.program_device(self.name, writes=2)
        self._stopping = True

    @awaited
    def wait(self) -> Generator[Any, Any, None]:
        """Stall until the started work is done; with FLOW=AUTO, that is only after a `stop`."""
        yield from self._progress.wait_event(self.done, f"{self.name}", lambda: self._last)

    def _run(self, source: ChannelStep, destination: ChannelStep) -> Generator[Any, Any, None]:
        """Move one work unit after the other until one of the channels stops."""
        while source.unit and destination.unit:
            transfer, rows = self._post(source, destination), destination.unit.y_count
            self._last = transfer
            noted = 0
            while transfer.end is None:
                yield (
                    self._bus.when_row(transfer)
                    if destination.unit.row_interrupt
                    else self._bus.when_done(transfer)
                )
                # several rows may have ended; the last one ends with the unit
                moved = (
                    self._bus.moved_by(transfer) // destination.unit.x_count
                    if transfer.end is None
                    else rows - 1
                )
                for _ in range(noted, moved):
                    self.source.row_done()
                    self._interrupt(wanted=self.destination.row_done())
                noted = max(noted, moved)
            self.source.fetched()
            self.destination.fetched()
            source, destination = self.source.unit_done(), self.destination.unit_done()
            self._interrupt(wanted=source.interrupt or destination.interrupt)
            if self._stopping:
                break
            if source.unit and destination.unit:
                check_pair(self.source, self.destination)
        self.source.stop()
        self.destination.stop()

    def _post(self, source: ChannelStep, destination: ChannelStep) -> Transfer:
        """Post the transfers that fetch the descriptors, and then the one that moves the words. Return the last one."""
        assert source.unit is not None
        assert destination.unit is not None
        master = STREAMS[self.name]
        for step in (source, destination):
            if step.fetch:
                elements = step.fetch.elements
                offset = self._memories.offset_of(step.fetch.address, elements * ELEMENT_BYTES)
                setup_sclk = elements * self._dma.descriptor_sclk
                fetch = self._bus.planner.fetch(master, offset, elements, setup_sclk * self._sclk_ticks)
                self._bus.post(fetch)
        plan = self._bus.planner.copy(
            master,
            self._walk(source.unit),
            self._walk(destination.unit),
            destination.unit.words,
            element_bytes=destination.unit.word_bytes,
            setup=self._dma.startup_sclk * self._sclk_ticks,
            name="work unit",
        )
        return self._bus.post(plan)

    def _walk(self, unit: WorkUnit) -> Walk:
        offset = self._memories.offset_of(unit.start_address, unit.word_bytes)
        return Walk(offset, unit.x_count, unit.x_modify, unit.y_modify if unit.y_count > 1 else unit.x_modify)

    def _interrupt(self, *, wanted: bool) -> None:
        if wanted:
            self._progress.request_interrupt(self.name)
