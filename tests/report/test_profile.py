"""The breakdown by stage, kernel, source line and memory."""

from __future__ import annotations

from dataclasses import replace

from bfsim.report.profile import profile_of
from bfsim.trace import LineCost, RunRecord
from tests.report.records import access, buffer, edge_run, kernel, traffic


def two_core_run() -> RunRecord:
    """Sobel on both cores, a Gauss on core A, an erosion in the next stage; the run takes 1000 cycles."""
    lines = (
        LineCost(line=10, executions=5, issue_cclk=10, stall_cclk={}),
        LineCost(line=11, executions=4, issue_cclk=40, stall_cclk={}),
    )
    return replace(
        edge_run(450, 450),
        kernels=(
            kernel("Edge detection", "sobel_row", *lines),
            kernel("Edge detection", "sobel_row", *lines, core="B"),
            kernel(
                "Edge detection", "gauss_row", LineCost(line=11, executions=9, issue_cclk=300, stall_cclk={})
            ),
            kernel(
                "Open & closing", "erode_row", LineCost(line=10, executions=1, issue_cclk=7, stall_cclk={})
            ),
        ),
        buffers=(buffer("row", "L1_DATA_A"), buffer("table", "L2")),
        accesses=(
            access("Edge detection", "sobel_row", "row", 4, 1),
            access("Edge detection", "sobel_row", "row", 4, 2, core="B"),
            access("Edge detection", "sobel_row", "table", 1, 0, core="B"),
        ),
        traffic=(traffic("SDRAM", "MDMA1", 250),),
    )


def test_stages_come_in_firmware_order_and_kernels_by_cost() -> None:
    """The dearest kernel of a stage is first; the same kernel on two cores is one entry."""
    profile = profile_of(two_core_run())
    edge, closing = profile.stages
    assert (edge.stage, closing.stage) == ("Edge detection", "Open & closing")
    assert [(each.kernel, each.issue_cclk, each.calls) for each in edge.kernels] == [
        ("gauss_row", 300, 1),
        ("sobel_row", 100, 2),
    ]
    assert (profile.issue_cclk, edge.issue_cclk, closing.issue_cclk) == (407, 400, 7)


def test_lines_add_up_over_cores_and_carry_their_source() -> None:
    """Line 11 ran four times on either core; its text comes from the record."""
    sobel = profile_of(two_core_run()).stages[0].kernels[1]
    assert [(each.line, each.executions, each.issue_cclk) for each in sobel.lines] == [
        (10, 10, 20),
        (11, 8, 80),
    ]
    assert sobel.lines[1].text == "    total += row[x]"


def test_one_core_alone() -> None:
    """With a core given, only its kernels count; the memories still show all masters."""
    profile = profile_of(two_core_run(), core="B")
    assert [kernel.kernel for stage in profile.stages for kernel in stage.kernels] == ["sobel_row"]
    assert profile.issue_cclk == 50
    assert len(profile.traffic) == 1


def test_memories_show_accesses_by_stage_and_bus_time() -> None:
    """Reads and writes add up per memory and stage; busy time is taken of the whole run."""
    profile = profile_of(two_core_run())
    assert [(each.memory, each.stage, each.reads, each.writes) for each in profile.accesses] == [
        ("L1_DATA_A", "Edge detection", 8, 3),
        ("L2", "Edge detection", 1, 0),
    ]
    assert profile.traffic[0].busy_share == 0.25
