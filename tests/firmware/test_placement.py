"""The same firmware with its rows elsewhere: what an LDF costs, beside its closed form."""

from __future__ import annotations

import pytest

from bfsim.chip.bf561 import BF561
from bfsim.run import simulate
from bfsim.shipped import LDF_FOLDER
from bfsim.trace import StallReason

SEMAPHORES_OF_FIRST_FRAME = (
    3  # each core posts one and takes one; before it, core A posts that orders are taken
)


@pytest.mark.exhaustive
def test_rows_in_l2_stall_for_every_read() -> None:
    """Pixels and issue cycles stay; each read of a kernel waits the latency of L2, less the cycle of its own.

    Of estimated code: of object code, functions that get arrays of several memories count a half of their reads for each.
    """
    assert BF561.l2
    at_home = simulate(frames=1, profile="vdsp-O2")
    moved = simulate(frames=1, ldf=LDF_FOLDER / "l2.ldf", profile="vdsp-O2")
    assert moved.frames[0].results == at_home.frames[0].results
    memory_of = {each.buffer: each.memory for each in moved.buffers}
    for core, home in zip(moved.frames[0].cores, at_home.frames[0].cores, strict=True):
        mine = [
            each for each in moved.accesses if each.core == core.core and memory_of.get(each.buffer) == "L2"
        ]
        reads = sum(each.reads for each in mine)
        stalls = sum(each.stall_cclk.get(StallReason.L2_LATENCY, 0) for each in core.stages)
        assert reads > 1_000_000
        testset_cclk = BF561.l2.read_cclk + BF561.l2.next_cclk
        assert stalls == reads * (BF561.l2.read_cclk - 1) + SEMAPHORES_OF_FIRST_FRAME * testset_cclk
        assert [each.issue_cclk for each in core.stages] == [each.issue_cclk for each in home.stages]


@pytest.mark.exhaustive
def test_rows_in_sdram_stall_more_than_in_l2() -> None:
    """SDRAM is the slowest place, and its reasons are told apart: pages, and the bus that both cores want."""
    l2, sdram = (simulate(frames=1, ldf=LDF_FOLDER / name) for name in ("l2.ldf", "sdram.ldf"))
    assert sdram.frames[0].results == l2.frames[0].results
    assert sdram.frames[0].result_cclk > 2 * l2.frames[0].result_cclk
    met = {reason for core in sdram.frames[0].cores for each in core.stages for reason in each.stall_cclk}
    assert {
        StallReason.SDRAM_PAGE_HIT,
        StallReason.SDRAM_PAGE_CONFLICT,
        StallReason.EBIU_ARBITRATION,
    } <= met
