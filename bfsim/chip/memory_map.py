"""The memories of each chip by address: what lies where, how large it is, and which core reaches it.

Latencies and banks are not here; nor are the memory-mapped registers, where nothing can be placed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from bfsim.errors import ConfigError

KIB = 1024
MIB = 1024 * KIB

# Both chips: Linux mem_map.h, L1_DATA_A_LENGTH, L1_DATA_B_LENGTH and L1_CODE_LENGTH with and without caches
CACHE_NBYTES = 16 * KIB
"""What a data bank or the code memory gives up to be cache."""

Owner = Literal["A", "B", "shared"]


@dataclass(frozen=True, slots=True)
class Region:
    """One memory: `nbytes` from byte address `start`, reached by its owner's loads and stores alone.

    Its last `cache_nbytes` can be cache instead.
    """

    memory: str
    owner: Owner
    start: int
    nbytes: int
    cache_nbytes: int = 0

    @property
    def name(self) -> str:
        """Name of the region on the whole chip, such as COREA_L1_DATA_A, or L2 where both cores share it."""
        return self.memory if self.owner == "shared" else f"CORE{self.owner}_{self.memory}"

    def holds(self, address: int, nbytes: int) -> bool:
        """Return whether all `nbytes` from `address` lie in this region."""
        return self.start <= address and address + nbytes <= self.start + self.nbytes


# Addresses and sizes: Linux arch/blackfin/mach-bf561/include/mach/mem_map.h; GNU sim/bfin/machs.c
# bf561_mem[]; the memory map in the comments of the VisualDSP++ 5.0 default LDF of the ADSP-BF561.
BF561_REGIONS = (
    Region("L1_CODE", "A", 0xFFA0_0000, 16 * KIB),
    Region("L1_CODE_CACHE", "A", 0xFFA1_0000, 16 * KIB, CACHE_NBYTES),
    Region("L1_DATA_A", "A", 0xFF80_0000, 32 * KIB, CACHE_NBYTES),
    Region("L1_DATA_B", "A", 0xFF90_0000, 32 * KIB, CACHE_NBYTES),
    Region("SCRATCH", "A", 0xFFB0_0000, 4 * KIB),  # no DMA
    Region("L1_CODE", "B", 0xFF60_0000, 16 * KIB),
    Region("L1_CODE_CACHE", "B", 0xFF61_0000, 16 * KIB, CACHE_NBYTES),
    Region("L1_DATA_A", "B", 0xFF40_0000, 32 * KIB, CACHE_NBYTES),
    Region("L1_DATA_B", "B", 0xFF50_0000, 32 * KIB, CACHE_NBYTES),
    Region("SCRATCH", "B", 0xFF70_0000, 4 * KIB),
    Region("L2", "shared", 0xFEB0_0000, 128 * KIB),
    Region("ASYNC0", "shared", 0x2000_0000, 64 * MIB),
    Region("ASYNC1", "shared", 0x2400_0000, 64 * MIB),
    Region("ASYNC2", "shared", 0x2800_0000, 64 * MIB),
    Region("ASYNC3", "shared", 0x2C00_0000, 64 * MIB),
)

# Addresses and sizes: Linux arch/blackfin/mach-bf533/include/mach/mem_map.h
BF533_REGIONS = (
    Region("L1_CODE", "A", 0xFFA0_0000, 64 * KIB),
    Region("L1_CODE_CACHE", "A", 0xFFA1_0000, 16 * KIB, CACHE_NBYTES),
    Region("L1_DATA_A", "A", 0xFF80_0000, 32 * KIB, CACHE_NBYTES),
    Region("L1_DATA_B", "A", 0xFF90_0000, 32 * KIB, CACHE_NBYTES),
    Region("SCRATCH", "A", 0xFFB0_0000, 4 * KIB),  # no DMA
    Region("ASYNC0", "shared", 0x2000_0000, 1 * MIB),
    Region("ASYNC1", "shared", 0x2010_0000, 1 * MIB),
    Region("ASYNC2", "shared", 0x2020_0000, 1 * MIB),
    Region("ASYNC3", "shared", 0x2030_0000, 1 * MIB),
)


def with_sdram(regions: Sequence[Region], sdram_nbytes: int) -> tuple[Region, ...]:
    """Return a chip's memories and a board's `sdram_nbytes` of SDRAM, which starts at address 0."""
    return (*regions, Region("SDRAM", "shared", 0x0000_0000, sdram_nbytes))


def bf561_regions(sdram_nbytes: int) -> tuple[Region, ...]:
    """Return the memories of a BF561 board with `sdram_nbytes` of SDRAM."""
    return with_sdram(BF561_REGIONS, sdram_nbytes)


# One MT48LC8M32B2: Linux arch/blackfin/configs/CM-BF561_defconfig of 2008-02..04, CONFIG_MEM_SIZE=32
CM_BF561_REGIONS = bf561_regions(sdram_nbytes=32 * MIB)


def regions_under(address: int, nbytes: int, regions: Sequence[Region]) -> tuple[Region, ...]:
    """Return the memories under `nbytes` from `address`: one, or neighbours of one owner, such as SRAM and cache.

    Raises ConfigError as `region_of` does.
    """
    first = next((region for region in regions if region.holds(address, 1)), None)
    found = [first] if first else []
    while found and found[-1].start + found[-1].nbytes < address + nbytes:
        end = found[-1].start + found[-1].nbytes
        after = next((each for each in regions if (each.start, each.owner) == (end, found[0].owner)), None)
        if after is None:
            break
        found.append(after)
    else:
        if found:
            return tuple(found)
    return (region_of(address, nbytes, regions),)


def region_of(address: int, nbytes: int, regions: Sequence[Region] = CM_BF561_REGIONS) -> Region:
    """Return the region that holds all `nbytes` from `address`; raise ConfigError if no single one does."""
    for region in regions:
        if region.holds(address, nbytes):
            return region
    problem = "at an address where there is none"
    below = max(
        (each for each in regions if each.start <= address), key=lambda each: each.start, default=None
    )
    if below:
        end = f"the end of {below.name}, 0x{below.start + below.nbytes - 1:08X}"
        problem = f"beyond {end}" if below.holds(address, 1) else f"{problem}, above {end}"
    raise ConfigError(f"{nbytes} bytes at 0x{address:08X} must lie inside one memory, not {problem}")
