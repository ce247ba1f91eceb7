"""A DMA channel without time: registers in, work units out. The caller moves the words and tells it when they are done."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from bfsim.chip.dma_channels import ChannelSpec
from bfsim.chip.dma_registers import (
    DESCRIPTOR_ELEMENTS,
    ELEMENT_BYTES,
    ELEMENTS,
    IRQ_WRITE_1_TO_CLEAR,
    REGISTERS,
    Flow,
    IrqStatus,
)
from bfsim.errors import MmrError
from bfsim.machine.dma.checks import DmaSpace, check_config, check_unit
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.dma.descriptors import Read16, load, read_descriptor
from bfsim.machine.dma.mmr import check_value, refuse
from bfsim.machine.dma.unit import WorkUnit

LOADED = tuple(dict.fromkeys(register for register, _ in ELEMENTS.values()))
"""The registers that a descriptor can load."""

WRITABLE = (*(each for each in LOADED if each != "CONFIG"), "CURR_DESC_PTR")
"""The registers that `write` sets; CONFIG and IRQ_STATUS have methods of their own."""


@dataclass(frozen=True, slots=True)
class Fetch:
    """A descriptor that was read: `elements` 16-bit words from byte address `address` on."""

    address: int
    elements: int


@dataclass(frozen=True, slots=True)
class ChannelStep:
    """What a channel does next: its work unit, or None if it has stopped, and the descriptor that it came from, if any.

    With `interrupt`, the channel requests its interrupt for the work unit that has ended.
    """

    unit: WorkUnit | None
    fetch: Fetch | None = None
    interrupt: bool = False


class DmaChannel:
    """One channel: stopped after reset, running from `start` until the end of its work, `stop` or an error.

    The registers are read-only attributes in the manual's spelling; firmware sets them with `write`. Whatever the chip
    would flag raises MmrError with the register's name, sets DMA_ERR and stops the channel.

    XXX: PERIPHERAL_MAP keeps its reset value, so channels cannot be remapped. CURR_X_COUNT and CURR_ADDR advance row
    by row, not word by word.
    """

    def __init__(self, spec: ChannelSpec, space: DmaSpace, read16: Read16) -> None:
        """`read16` reads descriptors from memory."""
        self.spec = spec
        self._space = space
        self._read16 = read16
        self.direction = spec.direction
        """Direction in which the peripheral moves words. A PPI and the SPI set it when they are enabled."""
        self.CONFIG = 0
        self.config = DmaConfig.decode(0)
        """CONFIG, decoded."""
        self.unit: WorkUnit | None = None
        """The work unit under way."""
        self.where = ""
        """Origin of the work unit, for messages: the line that started the channel, or a descriptor."""
        self._started = ""
        self._row = 0
        self.NEXT_DESC_PTR = self.START_ADDR = 0
        self.X_COUNT = self.X_MODIFY = self.Y_COUNT = self.Y_MODIFY = 0
        self.CURR_DESC_PTR = self.CURR_ADDR = self.CURR_X_COUNT = self.CURR_Y_COUNT = 0
        self.IRQ_STATUS = IrqStatus(0)
        self.PERIPHERAL_MAP = spec.peripheral_map

    @property
    def running(self) -> bool:
        """Whether DMA_RUN is set."""
        return IrqStatus.DMA_RUN in self.IRQ_STATUS

    def write(self, register: str, value: int, place: str = "") -> None:
        """Set one of the registers in WRITABLE, at `place` of the firmware, such as firmware/core_a.py:41."""
        where = _at("set", place)
        name = f"{self.spec.name}_{register}"
        if register not in WRITABLE:
            refuse(
                f"a register that can be written must be one of {', '.join(WRITABLE)}, not {register}", where
            )
        with self._flagging():
            if self.running:
                refuse(f"{name} must not be written while the channel runs", where)
        check_value(name, value, REGISTERS[register].lowest, REGISTERS[register].highest, where)
        setattr(self, register, int(value))

    def start(self, config: DmaConfig | int, place: str = "") -> ChannelStep:
        """Write CONFIG with DMAEN set, at `place` of the firmware, and return the first step."""
        where = _at("set", place)
        with self._flagging():
            if self.running:
                refuse(
                    f"{self.spec.name}_CONFIG must not be written with DMAEN=1 while the channel runs", where
                )
            self._configure(config.encode() if isinstance(config, DmaConfig) else config, where)
            if not self.config.DMAEN:
                refuse(f"{self.spec.name}_CONFIG: DMAEN must be 1 to start the channel, not 0", where)
            self._started = self.where = _at("started", place)
            self.IRQ_STATUS |= IrqStatus.DMA_RUN
            return self._next(interrupt=False)

    def fetched(self) -> None:
        """Note that the descriptor of the last step has arrived."""
        self.IRQ_STATUS &= ~IrqStatus.DFETCH

    def row_done(self) -> bool:
        """Note the end of a row other than the last. Return whether the channel requests its interrupt."""
        assert self.unit is not None, "a stopped channel has no rows"
        self._row += 1
        self.CURR_Y_COUNT = self.unit.y_count - self._row & 0xFFFF
        self.CURR_ADDR = self.unit.row_address(self._row)
        return self._interrupt(self.unit.row_interrupt)

    def unit_done(self) -> ChannelStep:
        """Note the end of the work unit, with its FIFO empty. Return the next step."""
        done = self.unit
        assert done is not None, "a stopped channel has no work unit"
        interrupt = self._interrupt(done.row_interrupt or done.block_interrupt)
        # [assumed] what the counters read at the end: from memory of the HRM
        self.CURR_ADDR, self.CURR_X_COUNT, self.CURR_Y_COUNT = done.end_address, 0, 1
        if self.config.FLOW is Flow.STOP:
            self.stop()
            return ChannelStep(None, interrupt=interrupt)
        with self._flagging():
            return self._next(interrupt)

    def stop(self) -> None:
        """End the work at once, as a write of CONFIG with DMAEN=0 does. The registers keep their values."""
        self.IRQ_STATUS &= ~(IrqStatus.DMA_RUN | IrqStatus.DFETCH)
        self.unit = None

    def acknowledge(self, bits: IrqStatus) -> None:
        """Write `bits` to IRQ_STATUS: a 1 clears DMA_DONE or DMA_ERR."""
        self.IRQ_STATUS &= ~(bits & IRQ_WRITE_1_TO_CLEAR)

    def _interrupt(self, wanted: bool) -> bool:
        if wanted:
            self.IRQ_STATUS |= IrqStatus.DMA_DONE
        return wanted

    def _next(self, interrupt: bool) -> ChannelStep:
        """Fetch a descriptor if FLOW asks for one, and begin the work unit that the registers describe."""
        fetch = self._fetch() if self.config.FLOW in DESCRIPTOR_ELEMENTS else None
        if not self.config.DMAEN:  # only a descriptor can have cleared it
            self.stop()
            return ChannelStep(None, fetch, interrupt)
        unit = WorkUnit.programmed(
            self.config, self.START_ADDR, self.X_COUNT, self.X_MODIFY, self.Y_COUNT, self.Y_MODIFY
        )
        check_unit(self.spec, unit, self._space, self.where)
        self.unit, self._row = unit, 0
        self.CURR_ADDR, self.CURR_X_COUNT, self.CURR_Y_COUNT = self.START_ADDR, self.X_COUNT, self.Y_COUNT
        return ChannelStep(unit, fetch, interrupt)

    def _fetch(self) -> Fetch:
        """Load registers from the next descriptor: at NEXT_DESC_PTR in lists, after the previous one in arrays."""
        flow, ndsize = self.config.FLOW, self.config.NDSIZE
        register = "CURR_DESC_PTR" if flow is Flow.ARRAY else "NEXT_DESC_PTR"
        pointer: int = getattr(self, register)
        end = pointer + ndsize * ELEMENT_BYTES
        if pointer % ELEMENT_BYTES:
            refuse(
                f"{self.spec.name}_{register} must be a multiple of 2 bytes, not 0x{pointer:08X}", self.where
            )
        self._space.check(self.spec, register, pointer, (pointer, end - 1), self.where)
        elements = read_descriptor(self._read16, pointer, flow, ndsize)
        loaded = load({each: getattr(self, each) for each in LOADED}, elements)
        chain = f" of the chain {self._started}" if self._started else ""
        self.where = f"in the descriptor at 0x{pointer:08X}{chain}"
        self._configure(loaded["CONFIG"], self.where)
        for each, value in loaded.items():
            setattr(self, each, value)
        self.CURR_DESC_PTR = end
        self.IRQ_STATUS |= IrqStatus.DFETCH
        return Fetch(pointer, ndsize)

    def _configure(self, value: int, where: str) -> None:
        if value != self.CONFIG:
            self.config = DmaConfig.decode(value, f"{self.spec.name}_CONFIG", where)
            self.CONFIG = value
        check_config(self.spec, self.config, self.direction, where)

    @contextmanager
    def _flagging(self) -> Iterator[None]:
        """Stop the channel and set DMA_ERR if an error passes through."""
        try:
            yield
        except MmrError:
            self.stop()
            self.IRQ_STATUS |= IrqStatus.DMA_ERR
            raise


def check_pair(source: DmaChannel, destination: DmaChannel) -> None:
    """Raise MmrError unless both halves of a memory stream are about to move the same number of words of the same size."""
    for each in (source, destination):
        if not each.unit:  # the other half would wait for ever
            refuse(f"{each.spec.name}_CONFIG: DMAEN must be 1 where the stream begins, not 0", each.where)
    assert source.unit
    assert destination.unit
    names = f"{source.spec.name} and {destination.spec.name}"
    from_bytes, to_bytes = source.unit.word_bytes, destination.unit.word_bytes
    if from_bytes != to_bytes:
        refuse(
            f"{names} must have the same WDSIZE, not {8 * from_bytes} and {8 * to_bytes} bits",
            destination.where,
        )
    if source.unit.words != destination.unit.words:
        refuse(
            f"{names} must move the same number of words, not {source.unit.words} and {destination.unit.words}",
            destination.where,
        )


def _at(verb: str, place: str) -> str:
    return f"{verb} at {place}" if place else ""
