"""The same firmware with its rows elsewhere: what an LDF costs, beside its closed form."""

from __future__ import annotations

from pathlib import Path

from bfsim.chip.bf561 import BF561
from bfsim.run import THESIS_LDF, simulate
from bfsim.trace import StallReason

SEMAPHORES_PER_FRAME = 2  # each core posts one and takes one


def placed_in(segment: str, folder: Path) -> Path:
    """Write the thesis's LDF with the section L1_data_a of both cores in `segment`."""
    before, *rest = THESIS_LDF.read_text().split("INPUT_SECTIONS($OBJECTS(L1_data_a))")
    moved = [part.replace("MEM_A_L1_DATA_A", segment, 1) for part in rest[:1]]
    moved += [part.replace("MEM_B_L1_DATA_A", segment, 1) for part in rest[1:]]
    path = folder / f"{segment}.ldf"
    path.write_text("INPUT_SECTIONS($OBJECTS(L1_data_a))".join([before, *moved]))
    return path


def test_rows_in_l2_stall_for_every_read(tmp_path: Path) -> None:
    """Pixels and issue cycles stay; each read of a kernel waits the latency of L2, less the cycle of its own."""
    assert BF561.l2 is not None
    latency_cclk = BF561.l2.read_cclk
    at_home = simulate(frames=1)
    moved = simulate(frames=1, ldf=placed_in("MEM_L2_SRAM", tmp_path))
    assert moved.frames[0].results == at_home.frames[0].results
    for core, home in zip(moved.frames[0].cores, at_home.frames[0].cores, strict=True):
        reads = sum(each.accesses.get("L2", (0, 0))[0] for each in moved.kernels if each.core == core.core)
        stalls = sum(each.stall_cclk.get(StallReason.L2_LATENCY, 0) for each in core.stages)
        assert reads > 1_000_000
        assert stalls == reads * (latency_cclk - 1) + SEMAPHORES_PER_FRAME * latency_cclk
        assert [each.issue_cclk for each in core.stages] == [each.issue_cclk for each in home.stages]


def test_rows_in_sdram_stall_more_than_in_l2(tmp_path: Path) -> None:
    """SDRAM is the slowest place, and its reasons are told apart: pages, and the bus that both cores want."""
    l2, sdram = (
        simulate(frames=1, ldf=placed_in(segment, tmp_path)) for segment in ("MEM_L2_SRAM", "MEM_SDRAM_BANK2")
    )
    assert sdram.frames[0].results == l2.frames[0].results
    assert sdram.frames[0].result_cclk > 2 * l2.frames[0].result_cclk
    met = {reason for core in sdram.frames[0].cores for each in core.stages for reason in each.stall_cclk}
    assert {
        StallReason.SDRAM_PAGE_HIT,
        StallReason.SDRAM_PAGE_CONFLICT,
        StallReason.EBIU_ARBITRATION,
    } <= met
