"""The DMA channels of the ADSP-BF561: whom each one serves, in order of priority, and which memories it reaches."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from bfsim.chip.dma_registers import REGISTERS


class Direction(Enum):
    """Which way a channel moves words: the WNR that its CONFIG must have."""

    FROM_MEMORY = 0
    TO_MEMORY = 1
    EITHER = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class DmaController:
    """A group of channels on the same buses. `reaches`: the memories, by their names in the memory map."""

    name: str
    reaches: frozenset[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelSpec:
    """One channel. `serves`: its peripheral, or memory if it is half of a stream.

    `widest_bytes`: its widest word. `direction`: EITHER if the peripheral decides (PPI_CONTROL, SPI_CTL).
    `peripheral_map`: what PERIPHERAL_MAP reads after reset.
    """

    name: str
    controller: DmaController
    serves: str
    direction: Direction
    widest_bytes: int
    peripheral_map: int
    lacks: frozenset[str] = frozenset()

    @property
    def registers(self) -> tuple[str, ...]:
        """Names of the registers that this channel has, without the channel's own name."""
        return tuple(each for each in REGISTERS if each not in self.lacks)


L1_AND_L2 = frozenset({"L1_CODE", "L1_CODE_CACHE", "L1_DATA_A", "L1_DATA_B", "L2"})
EXTERNAL = frozenset({"SDRAM", "ASYNC0", "ASYNC1", "ASYNC2", "ASYNC3"})

# No DMA reaches a scratchpad (VisualDSP++ default LDF), and the IMDMA no external memory (BF561 HRM chapter 9);
# that each of the three reaches the code memories of both cores, too, is [assumed]
DMA1 = DmaController(name="DMA1", reaches=L1_AND_L2 | EXTERNAL)
DMA2 = DmaController(name="DMA2", reaches=L1_AND_L2 | EXTERNAL)
IMDMA = DmaController(name="IMDMA", reaches=L1_AND_L2)

MDMA_CTYPE = 0x0040  # PERIPHERAL_MAP of a memory channel, defBF561.h and GNU sim/bfin/dv-bfin_dmac.c

# Who is on which channel: Linux mach-bf561 dma.h and GNU sim dv-bfin_dmac.c; a channel without a peripheral is spare
DMA1_SERVES = (
    ("PPI0", Direction.EITHER),
    ("PPI1", Direction.EITHER),
    *[("nothing", Direction.EITHER)] * 10,
)
DMA2_SERVES = (
    ("SPORT0 RX", Direction.TO_MEMORY),
    ("SPORT0 TX", Direction.FROM_MEMORY),
    ("SPORT1 RX", Direction.TO_MEMORY),
    ("SPORT1 TX", Direction.FROM_MEMORY),
    ("SPI", Direction.EITHER),
    ("UART RX", Direction.TO_MEMORY),
    ("UART TX", Direction.FROM_MEMORY),
    *[("nothing", Direction.EITHER)] * 5,
)


def _peripheral_channels(
    controller: DmaController, serves: tuple[tuple[str, Direction], ...], widest_bytes: int
) -> tuple[ChannelSpec, ...]:
    return tuple(
        ChannelSpec(
            name=f"{controller.name}_{number}",
            controller=controller,
            serves=peripheral,
            direction=direction,
            widest_bytes=widest_bytes,
            peripheral_map=number << 12,
        )
        for number, (peripheral, direction) in enumerate(serves)
    )


def _memory_channels(
    controller: DmaController, prefix: str, lacks: frozenset[str] = frozenset()
) -> tuple[ChannelSpec, ...]:
    """Return the channels of two streams; stream 0 goes first, and each is a destination and a source channel."""
    halves = (("D", Direction.TO_MEMORY), ("S", Direction.FROM_MEMORY))
    return tuple(
        ChannelSpec(
            name=f"{prefix}_{half}{stream}",
            controller=controller,
            serves="memory",
            direction=direction,
            widest_bytes=4,  # [assumed] for MDMA2; the BF561 HRM, chapter 9, for the others
            peripheral_map=MDMA_CTYPE,
            lacks=lacks,
        )
        for stream in (0, 1)
        for number, (half, direction) in enumerate(halves)
    )


# Order: within a controller the lower channel goes first, and all memory streams after
# the peripherals (HRM of the ADSP-BF537, 5-50); DMA1 before DMA2 on the external bus [assumed]. Widths: DMA1 32 and
# DMA2 16 bits (BF561 HRM chapter 9). The IMDMA has no PERIPHERAL_MAP (Linux mach-bf561 dma.h).
BF561_CHANNELS = {
    each.name: each
    for each in (
        *_peripheral_channels(DMA1, DMA1_SERVES, widest_bytes=4),
        *_memory_channels(DMA1, "MDMA1"),
        *_peripheral_channels(DMA2, DMA2_SERVES, widest_bytes=2),
        *_memory_channels(DMA2, "MDMA2"),
        *_memory_channels(IMDMA, "IMDMA", lacks=frozenset({"PERIPHERAL_MAP"})),
    )
}
