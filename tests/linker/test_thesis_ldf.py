"""The shipped placement ldf/thesis.ldf: closed-form addresses, sizes of the memories, where things spill."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from bfsim.chip.memory_map import region_of
from bfsim.errors import LinkError
from bfsim.linker import LinkerScript, Symbol, link, parse_ldf

THESIS = Path(__file__).parents[2] / "ldf" / "thesis.ldf"
KIB = 1024
ANOMALY_BYTES = 76  # unused at the end of each L1 block
HEAP_BYTES, STACK_BYTES = 2 * KIB, 4 * KIB


@cache
def thesis() -> LinkerScript:
    """Parse the LDF once for all tests."""
    return parse_ldf(THESIS)


@pytest.mark.parametrize(
    ("processor", "section", "address"),
    [
        ("p0", "L1_code", 0xFFA00000),
        ("p0", "L1_data_a", 0xFF800000 + HEAP_BYTES),
        ("p0", "L1_data_b", 0xFF900000 + STACK_BYTES),
        ("p0", "L1_scratch", 0xFFB00000),
        ("p1", "L1_code", 0xFF600000),
        ("p1", "L1_data_a", 0xFF400000 + HEAP_BYTES),
        ("p1", "L1_data_b", 0xFF500000 + STACK_BYTES),
        ("p1", "L1_scratch", 0xFF700000),
        (None, "l2_shared", 0xFEB00000),
        ("p0", "sdram_bank0", 0x00000020),
        ("p1", "sdram_bank1", 0x00800000),
        ("p0", "sdram_bank2", 0x01000000),
        ("p1", "sdram_bank3", 0x01800000),
        (None, "sdram_bank0", 0x00000020),
        ("p0", "program", 0xFFA00000),
        ("p1", "program", 0xFF600000),
        ("p0", "data1", 0xFF800000 + HEAP_BYTES),
        ("p0", "constdata", 0xFF800000 + HEAP_BYTES),
        ("p1", "bsz", 0xFF400000 + HEAP_BYTES),
    ],
)
def test_sections_start_where_the_memory_map_says(processor: str | None, section: str, address: int) -> None:
    """The first symbol of each section starts its memory, behind heap, stack and address 0."""
    placed = link(thesis(), [Symbol("x", section, 100, processor=processor)])
    assert placed.find(processor, "x").address == address


@pytest.mark.parametrize(
    ("processor", "section", "largest"),
    [
        ("p0", "L1_data_a", 32 * KIB - HEAP_BYTES - ANOMALY_BYTES),
        ("p1", "L1_data_b", 32 * KIB - STACK_BYTES - ANOMALY_BYTES),
        ("p0", "L1_code", 16 * KIB - ANOMALY_BYTES),
        ("p1", "L1_scratch", 4 * KIB - ANOMALY_BYTES),
        (None, "l2_shared", 127 * KIB),
        ("p0", "sdram_bank0", 8 * KIB * KIB - 32),
        ("p1", "sdram_bank3", 8 * KIB * KIB),
    ],
)
def test_sections_hold_what_the_memory_holds(processor: str | None, section: str, largest: int) -> None:
    """A symbol as large as the memory less its reserves fits; four bytes more are out of memory."""
    assert link(thesis(), [Symbol("x", section, largest, processor=processor)]).placements
    with pytest.raises(LinkError, match=rf"\.ldfi:\d+: Out of memory .* {largest + 4} bytes"):
        link(thesis(), [Symbol("x", section, largest + 4, processor=processor)])


def test_default_sections_spill_from_l1_to_l2_to_sdram() -> None:
    """Data goes to bank A, bank B, L2, and last to the SDRAM bank of the core's own working images."""
    symbols = [Symbol(f"x{i}", "data1", 25 * KIB, processor="p1") for i in range(9)]
    memories = [region_of(p.address, p.symbol.nbytes).name for p in link(thesis(), symbols).placements]
    assert memories == ["COREB_L1_DATA_A", "COREB_L1_DATA_B", *["L2"] * 5, *["SDRAM"] * 2]
    assert link(thesis(), symbols).find("p1", "x8").segment == "MEM_SDRAM_BANK3"


def test_code_spills_over_both_l1_blocks() -> None:
    """Code fills the SRAM block, the block that could be cache, then L2; the rest is in core A's bank 2."""
    symbols = [Symbol(f"f{i}", "program", 12 * KIB, processor="p0") for i in range(13)]
    segments = [placed.segment for placed in link(thesis(), symbols).placements]
    assert segments == ["MEM_A_L1_CODE", "MEM_A_L1_CODE_CACHE", *["MEM_L2_SRAM"] * 10, "MEM_SDRAM_BANK2"]


@pytest.mark.parametrize("section", ["L1_data_a", "L1_data_b"])
def test_a_named_bank_does_not_spill(section: str) -> None:
    """A buffer that asks for a data bank gets that bank or none, and the error counts what is left there."""
    rings = [Symbol(f"ring{i}", section, 14 * KIB, processor="p0") for i in range(3)]
    with pytest.raises(
        LinkError, match=rf"'{section}' \[li1040\]: symbol 'ring[12]'.* of 32768 bytes free"
    ) as error:
        link(thesis(), rings)
    assert "nor in" not in str(error.value)


def test_camera_frames_lie_in_different_sdram_banks() -> None:
    """Frames of both cameras and the working images of both cores have an internal bank each."""
    homes = {"left": ("p0", 0), "right": ("p1", 1), "work_a": ("p0", 2), "work_b": ("p1", 3)}
    symbols = [
        Symbol(name, f"sdram_bank{bank}", 320 * 240 * 2, 4, core) for name, (core, bank) in homes.items()
    ]
    placed = link(thesis(), symbols)
    assert {p.symbol.name: p.address >> 23 for p in placed.placements} == {
        n: b for n, (_, b) in homes.items()
    }
    assert all(p.address % 32 == 0 for p in placed.placements)
