"""The shipped placement ldf/cm-bf533.ldf for one core: sizes of the memories, and where things spill without L2."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from bfsim.chip.boards import CM_BF533
from bfsim.chip.memory_map import KIB, MIB, region_of
from bfsim.errors import LinkError
from bfsim.linker import LinkerScript, LinkMap, Symbol, link, parse_ldf

LDF = Path(__file__).parents[2] / "ldf" / "cm-bf533.ldf"
ANOMALY_BYTES = 76  # unused at the end of L1's contiguous blocks
HEAP_BYTES, STACK_BYTES = 2 * KIB, 4 * KIB


@cache
def script() -> LinkerScript:
    """Parse the LDF once for all tests."""
    return parse_ldf(LDF)


def linked(*symbols: Symbol) -> LinkMap:
    """Place symbols of the one processor into the board's memories."""
    return link(script(), symbols, CM_BF533.chip.regions, chip=CM_BF533.chip.name)


@pytest.mark.parametrize(
    ("section", "address", "largest"),
    [
        ("L1_code", 0xFFA00000, 64 * KIB),
        ("L1_data_a", 0xFF800000 + HEAP_BYTES, 32 * KIB - HEAP_BYTES - ANOMALY_BYTES),
        ("L1_data_b", 0xFF900000 + STACK_BYTES, 32 * KIB - STACK_BYTES - ANOMALY_BYTES),
        ("L1_scratch", 0xFFB00000, 4 * KIB - ANOMALY_BYTES),
        ("sdram_bank0", 0x00000020, 8 * MIB - 32),
        ("sdram_bank1", 0x00800000, 8 * MIB),
        ("sdram_bank2", 0x01000000, 8 * MIB),
        ("sdram_bank3", 0x01800000, 8 * MIB),
        ("L2_sram", 0x00800000, 8 * MIB),
    ],
)
def test_sections_start_where_the_memory_is_and_hold_what_it_holds(
    section: str, address: int, largest: int
) -> None:
    """A symbol as large as the memory less its reserves fits; four bytes more are out of memory."""
    assert linked(Symbol("x", section, largest, processor="p0")).find("p0", "x").address == address
    with pytest.raises(LinkError, match=rf"cm-bf533\.ldf:\d+: Out of memory .* {largest + 4} bytes"):
        linked(Symbol("x", section, largest + 4, processor="p0"))


def test_spills_pass_from_l1_to_sdram() -> None:
    """There is no L2 between them."""
    data = [Symbol(f"x{i}", "data1", 25 * KIB, processor="p0") for i in range(3)]
    code = [Symbol(f"f{i}", "program", 15 * KIB, processor="p0") for i in range(6)]
    homes = [
        region_of(p.address, p.symbol.nbytes, CM_BF533.chip.regions).name for p in linked(*data).placements
    ]
    assert homes == ["COREA_L1_DATA_A", "COREA_L1_DATA_B", "SDRAM"]
    segments = [placed.segment for placed in linked(*code).placements]
    assert segments == [*["MEM_L1_CODE"] * 4, "MEM_L1_CODE_CACHE", "MEM_SDRAM_BANK1"]
