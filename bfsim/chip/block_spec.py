"""What is known about the blocks of a chip: its memories, its way to SDRAM, its DMA, its events. See `spec`."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class L1Spec:
    """L1 data memory: `subbank_bytes` that take one access a cycle. `conflict_cclk`: how long the second one waits."""

    subbank_bytes: int
    conflict_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CacheSpec:
    """A cache in L1: what it takes of each memory that can be cache, and how it is divided.

    `invalidate_cclk`: cycles for each line of the loop that invalidates lines of the data cache.
    """

    line_bytes: int
    data_ways: int
    data_bytes_per_bank: int
    code_ways: int
    code_bytes: int
    invalidate_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class L2Spec:
    """Shared L2: latency of a core's read, and how long each 64 bits hold the port that both cores share."""

    read_cclk: int
    next_cclk: int
    port_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalSpec:
    """A core's way to SDRAM through the EBIU.

    `core_sync_sclk`: what a read takes besides the SDRAM's own cycles, to the bus and back; a store is posted
    into a buffer of `store_buffer` words.
    """

    core_sync_sclk: int
    store_buffer: int


@dataclass(frozen=True, slots=True, kw_only=True)
class DmaSpec:
    """The DMA controllers. A work unit starts in `startup_sclk`; a descriptor takes `descriptor_sclk` an element, besides its memory.

    `word_bytes`: width of their buses, and the longest word; `mdma_streams`: streams of memory DMA, of all controllers
    together. `read_word_sclk`: memory DMA, cycles per word from SDRAM on an open page (to SDRAM it is one);
    `on_chip_word_sclk`: between L1 and L2; `imdma_word_cclk`: the internal DMA, 0 without one.
    """

    controllers: int
    mdma_streams: int
    word_bytes: int
    fifo_words: int
    startup_sclk: int
    descriptor_sclk: int
    read_word_sclk: Fraction
    on_chip_word_sclk: Fraction
    imdma_word_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class EventSpec:
    """Interrupts, registers and locks. Entry: from the request to the handler's first line; exit: the way back.

    `mmr_*_cclk`: an access to a register of a device. `testset_cclk`: TESTSET without its memory; `spin_cclk`: an
    iteration of a spin loop without its TESTSET.
    """

    interrupt_entry_cclk: int
    interrupt_exit_cclk: int
    mmr_read_cclk: int
    mmr_write_cclk: int
    testset_cclk: int
    spin_cclk: int
