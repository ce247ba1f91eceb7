"""Plans of DMA transfers: their direction, their steps, whose pace they follow, and their time per word."""

from __future__ import annotations

from fractions import Fraction

from bfsim.chip.dma_registers import ELEMENT_BYTES
from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import INTERNAL
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.bus.transfer_plans import Pace, TransferPlan, Walk
from bfsim.machine.memories import Memories

ONE_TICK = Fraction(1)


class Planner:
    """Plans the transfers of one board's DMAs. `owners` says who owns its memory."""

    def __init__(self, board: BoardSpec, memories: Memories, owners: MemoryOwners) -> None:
        self._chip = board.chip
        self._clocks = board.clocks
        self._memories = memories
        self._owners = owners

    def copy(
        self, master: int, source: Walk, destination: Walk, count: int, *, element_bytes: int, setup: int, name: str = ""
    ) -> TransferPlan:  # fmt: skip
        """Plan to move `count` elements by a memory DMA that takes `setup` ticks to start. `name` says what, for people."""
        mode = self._mode_of_copy(master, source.offset, destination.offset)
        word = self._on_chip_ticks(master) if mode in (w.ON_CHIP, w.THROUGH_L2_PORT) else ONE_TICK
        pace = Pace(0, 1, word, ONE_TICK)
        return self._plan(master, mode, source, destination, count, element_bytes, pace, setup, name)

    def fetch(self, master: int, offset: int, elements: int, setup: int) -> TransferPlan:
        """Plan to fetch a descriptor of 16-bit `elements` into the registers of a channel, which takes another `setup` ticks."""
        memory, registers = (
            Walk(first, elements, ELEMENT_BYTES, ELEMENT_BYTES)
            for first in (offset, self._memories.registers)
        )
        return self.copy(
            master, memory, registers, elements, element_bytes=ELEMENT_BYTES, setup=setup, name="descriptor"
        )

    def receive(
        self, master: int, source: Walk, destination: Walk, count: int, *, element_bytes: int, pace: Pace, name: str = ""
    ) -> TransferPlan:  # fmt: skip
        """Plan to write `count` elements as a device delivers them. `name` says what, for people."""
        return self._plan(master, w.PACED_IN, source, destination, count, element_bytes, pace, 0, name)

    def send(
        self, master: int, source: Walk, destination: Walk, count: int, *, element_bytes: int, pace: Pace, name: str = ""
    ) -> TransferPlan:  # fmt: skip
        """Plan to read `count` elements as a device takes them. `name` says what, for people."""
        return self._plan(master, w.PACED_OUT, source, destination, count, element_bytes, pace, 0, name)

    def _mode_of_copy(self, master: int, source: int, destination: int) -> int:
        sdram_end, l2_end = self._memories.sdram_end, self._memories.l2_end
        if source < sdram_end:
            return w.BOTH if destination < sdram_end else w.READ
        if destination < sdram_end:
            return w.WRITE
        is_in_l2 = source < l2_end or destination < l2_end
        return w.THROUGH_L2_PORT if master in INTERNAL and is_in_l2 else w.ON_CHIP

    def _on_chip_ticks(self, master: int) -> Fraction:
        dma = self._chip.dma
        if master in INTERNAL:
            return Fraction(dma.imdma_word_cclk * self._clocks.cclk_ticks)
        return dma.on_chip_word_sclk * self._clocks.sclk_ticks

    def _plan(
        self, master: int, mode: int, source: Walk, destination: Walk, count: int, element_bytes: int, pace: Pace,
        setup: int, name: str,
    ) -> TransferPlan:  # fmt: skip
        return TransferPlan(
            master=master,
            mode=mode,
            source=source,
            destination=destination,
            count=count,
            element_bytes=element_bytes,
            setup=setup,
            pace=pace,
            owners=(self._owners.of(source.offset), self._owners.of(destination.offset)),
            name=name,
        )
