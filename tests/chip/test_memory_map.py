"""The memories of both chips: sizes that the data sheet states, no overlap, and look-up by address."""

from __future__ import annotations

from itertools import pairwise

import pytest

from bfsim.chip.memory_map import (
    BF533_REGIONS,
    CM_BF561_REGIONS,
    KIB,
    MIB,
    Region,
    bf561_regions,
    region_of,
    with_sdram,
)
from bfsim.errors import ConfigError


def test_memories_do_not_overlap() -> None:
    """In order of address each memory ends before the next one starts, also with the largest SDRAM."""
    for regions in (CM_BF561_REGIONS, bf561_regions(512 * MIB), with_sdram(BF533_REGIONS, 128 * MIB)):
        ordered = sorted(regions, key=lambda region: region.start)
        assert all(low.start + low.nbytes <= high.start for low, high in pairwise(ordered))


@pytest.mark.parametrize("core", ["A", "B"])
def test_each_core_has_100_kb_of_its_own(core: str) -> None:
    """A core owns 32 KB of code, 64 KB of data and 4 KB of scratchpad; 328 KB are on the chip with L2."""
    assert sum(region.nbytes for region in CM_BF561_REGIONS if region.owner == core) == 100 * KIB


def test_core_b_lies_4_mb_below_core_a() -> None:
    """The two cores' memories are alike, 0x400000 apart."""
    b_start = {region.memory: region.start for region in CM_BF561_REGIONS if region.owner == "B"}
    for region in CM_BF561_REGIONS:
        if region.owner == "A":
            assert region.start - b_start[region.memory] == 0x40_0000


def test_bf533_is_core_a_with_48_kb_more_code_and_no_l2() -> None:
    """Data banks and scratchpad are core A's of the BF561, at the same addresses; code is 64 KB and 16 KB."""
    bf533 = {region.memory: region for region in BF533_REGIONS}
    core_a = {region.memory: region for region in CM_BF561_REGIONS if region.owner == "A"}
    assert {region.owner for region in BF533_REGIONS} == {"A", "shared"}
    assert {name for name in bf533 if not name.startswith("ASYNC")} == set(core_a)
    assert {name for name in core_a if bf533[name] != core_a[name]} == {"L1_CODE"}
    assert bf533["L1_CODE"] == Region("L1_CODE", "A", core_a["L1_CODE"].start, 64 * KIB)


@pytest.mark.parametrize("regions", [CM_BF561_REGIONS, BF533_REGIONS])
def test_what_can_be_cache(regions: tuple[Region, ...]) -> None:
    """The upper half of each data bank, and the code block that has its name from it: 48 KB of each core."""
    halves = {
        (region.memory, region.nbytes - region.cache_nbytes) for region in regions if region.cache_nbytes
    }
    assert halves == {("L1_DATA_A", 16 * KIB), ("L1_DATA_B", 16 * KIB), ("L1_CODE_CACHE", 0)}
    cores = {region.owner for region in regions} - {"shared"}
    assert sum(region.cache_nbytes for region in regions) == len(cores) * 48 * KIB


@pytest.mark.parametrize(
    ("address", "nbytes", "name", "owner"),
    [
        (0xFF80_0000, 32 * KIB, "COREA_L1_DATA_A", "A"),
        (0xFF90_7FFF, 1, "COREA_L1_DATA_B", "A"),
        (0xFF40_3FFE, 4, "COREB_L1_DATA_A", "B"),
        (0xFFA0_0000, 2, "COREA_L1_CODE", "A"),
        (0xFF61_0000, 2, "COREB_L1_CODE_CACHE", "B"),
        (0xFFB0_0FFF, 1, "COREA_SCRATCH", "A"),
        (0xFEB1_FFFF, 1, "L2", "shared"),
        (0x0000_0000, 32 * MIB, "SDRAM", "shared"),
        (0x2400_0000, 64 * MIB, "ASYNC1", "shared"),
    ],
)
def test_region_of_an_address(address: int, nbytes: int, name: str, owner: str) -> None:
    """First and last bytes belong to the memory they are in."""
    region = region_of(address, nbytes)
    assert (region.name, region.owner) == (name, owner)


@pytest.mark.parametrize(
    ("address", "nbytes", "problem"),
    [
        (0x0200_0000, 1, "at an address where there is none"),
        (0xFEAF_FFFF, 2, "at an address where there is none"),
        (0x01FF_FFFF, 2, "beyond the end of SDRAM, 0x01FFFFFF"),
        (0xFF80_0000, 33 * KIB, "beyond the end of COREA_L1_DATA_A, 0xFF807FFF"),
    ],
)
def test_what_lies_in_no_memory_is_an_error(address: int, nbytes: int, problem: str) -> None:
    """Bytes outside the memories, or across an end, have no region."""
    with pytest.raises(
        ConfigError, match=rf"{nbytes} bytes at 0x{address:08X} must lie inside one .*, not {problem}"
    ):
        region_of(address, nbytes)


def test_sdram_is_the_boards() -> None:
    """A board with 64 MB has an SDRAM twice as long, on either chip."""
    assert region_of(0x03FF_FFFF, 1, with_sdram(BF533_REGIONS, 64 * MIB)).nbytes == 64 * MIB
    assert region_of(0x03FF_FFFF, 1, bf561_regions(64 * MIB)).nbytes == 64 * MIB
