"""What parts can lie where, and what they cost there before anything is measured: closed forms from the board's numbers."""

from __future__ import annotations

import pytest

from bfsim.machine.code import SECTION
from bfsim.placing.latencies import CONFLICTS, FULL, Latencies
from bfsim.placing.measured import Accesses, Measured
from bfsim.placing.model import Model, Part
from bfsim.placing.stretches import Level
from tests.placing.made_models import BOARD, model

L2_READ_CCLK, L2_NEXT_CCLK = 9, 2
SYNC, CL, RP_RCD = 5, BOARD.sdram.nCL, BOARD.sdram.nRP + BOARD.sdram.nRCD
CCLK_A_SCLK = 5  # 600 and 120 MHz


def levels(placed: Model, part: Part, measured: Measured | None = None) -> list[Level]:
    """Where a part can lie, in its order, each level once."""
    known = measured or Measured(accesses={(core, part.name): Accesses(1, 1) for core in "AB"})
    return list(dict.fromkeys(placed.stretches[each].level for each in placed.possible(part, known)))


def test_a_read_waits_for_its_memory() -> None:
    """Less its own cycle; half of the reads of SDRAM find another page open."""
    latencies = Latencies(BOARD)
    assert latencies.data_cclk(Level.L1, 100, 100) == 0
    assert latencies.data_cclk(Level.L2, 100, 0) == 100 * (L2_READ_CCLK - 1)
    assert latencies.data_cclk(Level.L2, 0, 100) == 100 * FULL * L2_NEXT_CCLK
    hit = CCLK_A_SCLK * (SYNC + CL) - 1
    assert latencies.data_cclk(Level.SDRAM, 100, 0) == 100 * (hit + CONFLICTS * RP_RCD * CCLK_A_SCLK)
    cached = latencies.data_cclk(Level.SDRAM, 100, 0, is_cached=True)
    assert cached == pytest.approx(latencies.data_cclk(Level.SDRAM, 100, 0) / 8)  # 8 words in a line
    assert latencies.code_cclk(Level.L1_CODE, 1000, is_cached=False) == 0
    assert latencies.code_cclk(Level.SDRAM, 1000, is_cached=True) == 0


def test_what_was_measured_counts() -> None:
    """A stall that a run has seen in a memory is taken for that memory, and for no other."""
    placed = model("thesis", ("row", "L1_data_a", 64, "p0"))
    (part,) = placed.parts
    measured = Measured(accesses={("A", "row"): Accesses(10, 0)}, stalls={(("A", "row"), Level.L2): 123.0})
    by_level = {each.level: number for number, each in enumerate(placed.stretches)}
    assert placed.cclk(part, by_level[Level.L2], measured) == {"A": 123.0}
    assert placed.cclk(part, by_level[Level.SDRAM], measured) == {
        "A": Latencies(BOARD).data_cclk(Level.SDRAM, 10, 0)
    }


def test_who_reaches_what() -> None:
    """Own L1 and scratchpad, then what both reach; L1 for nobody else's; what DMA moves, or nobody uses, in no scratchpad."""
    placed = model("thesis", ("row", "L1_data_a", 64, "p1"), ("common", "l2_shared", 64, None))
    row, common = placed.parts
    assert levels(placed, row) == [Level.L1, Level.SDRAM, Level.L2, Level.SCRATCH]
    assert {placed.stretches[each].owner for each in placed.possible(row, Measured())} == {"B", "shared"}
    assert levels(placed, row, Measured()) == [Level.L1, Level.SDRAM, Level.L2]
    streamed = Measured(accesses={("B", "row"): Accesses(1, 1)}, streamed=frozenset({"row"}))
    assert Level.SCRATCH not in levels(placed, row, streamed)
    assert levels(placed, common) == [Level.L2, Level.SDRAM]


def test_a_core_goes_to_its_own_bank_first() -> None:
    """Of the four banks: core B's own bank, not that of a camera."""
    placed = model("thesis", ("row", "L1_data_a", 64, "p1"))
    order = [placed.stretches[each].segment.name for each in placed.possible(placed.parts[0], Measured())]
    assert order[1] == "MEM_SDRAM_BANK3"


def test_nothing_becomes_stale_behind_a_data_cache() -> None:
    """With data caches, what both cores or a DMA use does not move into SDRAM; a core's own buffer may."""
    placed = model("cache", ("row", "L1_data_a", 64, "p0"), ("common", "l2_shared", 64, None))
    row, common = placed.parts
    assert levels(placed, common) == [Level.L2]
    assert Level.SDRAM in levels(placed, row)
    streamed = Measured(accesses={("A", "row"): Accesses(1, 1)}, streamed=frozenset({"row"}))
    assert Level.SDRAM not in levels(placed, row, streamed)


def test_code_is_placed_where_some_is_outside_l1() -> None:
    """33 KB of core A's kernels do not fit in its L1: all of them are parts, L1 first; core B's stay."""
    kernels = [(f"kernel{number}", SECTION, 3000, "p0") for number in range(11)]
    placed = model("thesis", *kernels, ("other", SECTION, 3000, "p1"))
    assert [part.owner for part in placed.parts] == ["A"] * 11
    assert {levels(placed, part)[0] for part in placed.parts} == {Level.L1_CODE}
