"""A DMA channel on its own, with a memory for its descriptors."""

from __future__ import annotations

from bfsim.chip.dma_channels import BF561_CHANNELS
from bfsim.chip.memory_map import CM_BF561_REGIONS, KIB, Region
from bfsim.machine.dma.channel import DmaChannel
from bfsim.machine.dma.checks import DmaSpace

SDRAM, L1_A, L2, SCRATCH = 0x0000_1000, 0xFF80_0000, 0xFEB0_0000, 0xFFB0_0000
DESCRIPTORS = 0xFF90_0000
PLACE = "firmware/core_a.py:41"

UPPER_HALF_OF_A = Region("L1_DATA_A", "A", 0xFF80_4000, 16 * KIB)


class Memory:
    """16-bit words by byte address; what was never written is not there."""

    def __init__(self) -> None:
        self.words: dict[int, int] = {}

    def put(self, address: int, words: list[int]) -> None:
        self.words.update({address + 2 * number: word for number, word in enumerate(words)})


def channel_on(memory: Memory, name: str = "DMA1_0", cached: tuple[Region, ...] = ()) -> DmaChannel:
    """A channel of the CM-BF561 that reads its descriptors from `memory`."""
    return DmaChannel(BF561_CHANNELS[name], DmaSpace(CM_BF561_REGIONS, cached), memory.words.__getitem__)


def program(channel: DmaChannel, **registers: int) -> DmaChannel:
    """Write registers; by default 160 32-bit words in a row from the start of SDRAM's second page on."""
    defaults = {"START_ADDR": SDRAM, "X_COUNT": 160, "X_MODIFY": 4}
    for register, value in (defaults | registers).items():
        channel.write(register, value)
    return channel
