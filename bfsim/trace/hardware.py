"""Where things were, and what moved: buffers, code and memories, traffic on the buses, messages of peripherals."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BufferRecord:
    """A buffer of the firmware, and where it lies. `core` is the core that declares it, or "shared".

    `buffer` is its name in other records: its own, followed by that of the core if both declare one.
    """

    buffer: str
    core: str
    memory: str
    address: int
    nbytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class TrafficRecord:
    """What one master moved to and from one buffer over a bus in the whole run, without a core's accesses to L1.

    `memory` is where the buffer lies; `buffer` is empty for anything outside buffers, such as code and semaphores. `master`
    is a core, an MDMA stream or a PPI; a DMA transfer counts for the buffers that it begins in. The page counts are
    zero for memories without pages. `busy_cclk` is how long it held the memory's bus, in CCLK cycles.
    """

    memory: str
    buffer: str
    master: str
    read_bytes: int
    written_bytes: int
    page_hits: int
    page_misses: int
    page_conflicts: int
    busy_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeRecord:
    """Code of one core's kernels in one segment of the LDF: the number of kernels, their bytes, and the segment's free bytes.

    Without `in_l1`, fetches take cycles beyond the kernels' own costs.
    """

    core: str
    segment: str
    in_l1: bool
    kernels: int
    nbytes: int
    free_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MemoryRecord:
    """One memory of the chip, such as L2 or COREA_L1_DATA_A: its size, and the bytes used by code, buffers and reserves."""

    memory: str
    nbytes: int
    used_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageRecord:
    """One message over a peripheral, such as SPI. `direction` is out or in, seen from the board; cycles are of core A's clock.

    `type` is the device's name for it, followed by "(cut short)" if the firmware's buffer had no room for all of it.
    """

    over: str
    direction: str
    type: str
    nbytes: int
    begin_cclk: int
    end_cclk: int
