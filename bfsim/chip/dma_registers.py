"""Registers of a DMA channel of the Blackfin: their widths, the meaning of their bits, and how a descriptor fills them.

Names are the manual's. Which channels a chip has is in `dma_channels`.
Sources: Linux arch/blackfin/mach-bf561/include/mach/defBF561.h for the bits; GNU sim/bfin/dv-bfin_dma.c
for the order of a descriptor's elements and the NDSIZE that each FLOW allows; other sources are named where they apply.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, IntFlag


@dataclass(frozen=True, slots=True)
class Register:
    """One register of a channel: `bits` wide, two's complement if `signed`."""

    bits: int
    signed: bool = False

    @property
    def lowest(self) -> int:
        """The least value that it holds."""
        return -(1 << self.bits - 1) if self.signed else 0

    @property
    def highest(self) -> int:
        """The greatest value that it holds."""
        return self.lowest + (1 << self.bits) - 1


REGISTERS = {
    "NEXT_DESC_PTR": Register(32),
    "START_ADDR": Register(32),
    "CONFIG": Register(16),
    "X_COUNT": Register(16),
    "X_MODIFY": Register(16, signed=True),
    "Y_COUNT": Register(16),
    "Y_MODIFY": Register(16, signed=True),
    "CURR_DESC_PTR": Register(32),
    "CURR_ADDR": Register(32),
    "IRQ_STATUS": Register(16),
    "PERIPHERAL_MAP": Register(16),
    "CURR_X_COUNT": Register(16),
    "CURR_Y_COUNT": Register(16),
}

COUNT_OF_ZERO = 0x1_0000
"""What X_COUNT = 0 and Y_COUNT = 0 mean: HRM of the ADSP-BF537, chapter 5."""


class Flow(IntEnum):
    """CONFIG.FLOW: what the channel does after a work unit. 2, 3 and 5 are reserved."""

    STOP = 0
    AUTO = 1
    ARRAY = 4
    SMALL = 6
    LARGE = 7


class WdSize(IntEnum):
    """CONFIG.WDSIZE: how wide a word is. 3 is reserved."""

    WDSIZE_8 = 0
    WDSIZE_16 = 1
    WDSIZE_32 = 2

    @property
    def word_bytes(self) -> int:
        """Bytes of a word."""
        return 1 << self


# Bits of CONFIG: the flags by position, the fields as (position, bits). Bit 15 is reserved and 0.
CONFIG_FLAGS = {"DMAEN": 0, "WNR": 1, "DMA2D": 4, "RESTART": 5, "DI_SEL": 6, "DI_EN": 7}
WDSIZE_FIELD = (2, 2)
NDSIZE_FIELD = (8, 4)
FLOW_FIELD = (12, 3)

NDSIZE_LIMITS = {
    Flow.STOP: (0, 0),
    Flow.AUTO: (0, 0),
    Flow.ARRAY: (1, 7),
    Flow.SMALL: (1, 8),
    Flow.LARGE: (1, 9),
}
"""Least and greatest NDSIZE, in 16-bit elements, by FLOW."""

ELEMENTS = {
    "NDPL": ("NEXT_DESC_PTR", 0),
    "NDPH": ("NEXT_DESC_PTR", 16),
    "SAL": ("START_ADDR", 0),
    "SAH": ("START_ADDR", 16),
    "CONFIG": ("CONFIG", 0),
    "X_COUNT": ("X_COUNT", 0),
    "X_MODIFY": ("X_MODIFY", 0),
    "Y_COUNT": ("Y_COUNT", 0),
    "Y_MODIFY": ("Y_MODIFY", 0),
}
"""16-bit elements of a large-list descriptor in their order: which register they fill, from which bit on."""

ELEMENT_BYTES = 2

DESCRIPTOR_ELEMENTS = {
    Flow.ARRAY: tuple(ELEMENTS)[2:],
    Flow.SMALL: ("NDPL", *tuple(ELEMENTS)[2:]),
    Flow.LARGE: tuple(ELEMENTS),
}
"""The elements that a descriptor may have, by FLOW: an array's has no pointer, a small list's only half of one."""


class IrqStatus(IntFlag):
    """Bits of IRQ_STATUS. That DMA_DONE needs CONFIG.DI_EN is [assumed], from the HRM as recalled."""

    DMA_DONE = 0x1  # a row or a work unit has asked for its interrupt; write 1 to clear
    DMA_ERR = 0x2  # the channel has stopped over an error; write 1 to clear
    DFETCH = 0x4  # a descriptor is on its way
    DMA_RUN = 0x8  # the channel is at work, or its FIFO not yet empty


IRQ_WRITE_1_TO_CLEAR = IrqStatus.DMA_DONE | IrqStatus.DMA_ERR

COPY_READS, COPY_WRITES = 1, 5
"""[ours] For a line that a ring copies: IRQ_STATUS is read and cleared, START_ADDR and CONFIG of both channels are written."""
