"""The statistics of the budget, against numbers worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings

from bfsim.report.budget.budget import FRAME, budget_of
from bfsim.report.budget.spread import Spread
from bfsim.report.budget.times import frame_rate_hz, latency_cclk, milliseconds
from bfsim.trace import REST, BudgetRow, RunRecord, StallReason
from tests.report.records import core_frame, cost, edge_run, frame, run_of, runs


def test_spread_of_an_even_count_takes_ranks_that_occurred() -> None:
    """Median and p95 are nearest-rank: ranks 10 and 19 of twenty values."""
    spread = Spread.of([value * 10 for value in range(20, 0, -1)])
    assert (spread.minimum, spread.median, spread.p95, spread.maximum, spread.total) == (
        10,
        100,
        190,
        200,
        2100,
    )


def test_spread_of_one_value_is_that_value() -> None:
    """A single frame is its own minimum, median, p95 and maximum."""
    assert Spread.of([7]) == Spread(minimum=7, median=7, p95=7, maximum=7, total=7)


def test_p95_of_a_hundred_and_one_values_rounds_its_rank_up() -> None:
    """0.95 · 101 = 95.95, so the rank is 96."""
    assert Spread.of(range(1, 102)).p95 == 96


def test_rows_carry_the_split_and_the_reference() -> None:
    """Issue, stalls by reason and idle are added over frames; the reference's numbers stand beside and are summed."""
    stalls = {StallReason.RING_EMPTY: 30, StallReason.SDRAM_PAGE_MISS: 20}
    first = core_frame("A", 0, cost("Edge detection", 100, stalls), cost(REST, 5, idle_cclk=45))
    second = core_frame("A", 200, cost("Edge detection", 110, {StallReason.RING_EMPTY: 10}))
    (core,) = budget_of(run_of([frame(0, first), frame(1, second)])).cores
    edge, closing, rest = core.rows
    assert [row.name for row in core.rows] == ["Edge detection", "Open & closing", REST]
    assert (edge.issue_cclk, edge.idle_cclk, edge.elapsed_cclk.total) == (210, 0, 270)
    assert edge.stall_cclk == {StallReason.RING_EMPTY: 40, StallReason.SDRAM_PAGE_MISS: 20}
    assert (closing.elapsed_cclk.maximum, rest.elapsed_cclk.minimum, rest.elapsed_cclk.maximum) == (0, 0, 50)
    assert (edge.reference_ms, rest.reference_ms, core.frame.reference_ms) == (87.0, None, 113.0)
    assert core.share(edge) == 270 / 320


def test_stage_that_no_row_declares_is_still_listed_before_the_rest() -> None:
    """A stage of the firmware without a budget row does not vanish into another row."""
    run = run_of([frame(0, core_frame("A", 0, cost(REST, 1), cost("Rectification", 2)))])
    names = [row.name for row in budget_of(run).cores[0].rows]
    assert names == ["Edge detection", "Open & closing", "Rectification", REST]


def test_a_part_is_a_row_of_its_own_and_in_the_row_of_its_stage() -> None:
    """A part's cycles count in its stage, frame by frame, and once in the frame."""
    part = BudgetRow(stage="Rectification", within="Edge detection")
    stall = {StallReason.RING_EMPTY: 3}
    first = core_frame("A", 0, cost("Edge detection", 100), cost("Rectification", 7, stall))
    second = core_frame("A", 110, cost("Edge detection", 50), cost("Rectification", 20))
    run = run_of([frame(0, first), frame(1, second)])
    (core,) = budget_of(replace(run, rows=(*run.rows, part))).cores
    rows = {row.name: row for row in core.rows}
    edge, rectification = rows["Edge detection"], rows["Rectification"]
    assert (edge.within, rectification.within) == (None, "Edge detection")
    assert (edge.elapsed_cclk.minimum, edge.elapsed_cclk.maximum) == (70, 110)
    assert (rectification.elapsed_cclk.minimum, rectification.elapsed_cclk.maximum) == (10, 20)
    assert (edge.issue_cclk, edge.stall_cclk) == (177, stall)
    assert core.frame.elapsed_cclk.total == 180


def test_firmware_that_waits_for_every_picture_is_no_faster_than_they_come() -> None:
    """A picture every 1,000 cycles; the first frame's work takes 60 more than the second one's, and so ends nearer to that."""
    first = core_frame("A", 0, cost("Edge detection", 160), cost(REST, 0, idle_cclk=1_000))
    second = core_frame("A", 1_160, cost("Edge detection", 100), cost(REST, 0, idle_cclk=840))
    waiting = [frame(0, first, latency_cclk=160), frame(1, second, latency_cclk=100)]
    assert frame_rate_hz(waiting, 1_000_000) == 1_000
    other = core_frame("B", 1_160, cost("Edge detection", 940))  # one core is never without work
    begun = core_frame("B", 0, cost("Edge detection", 1_160))
    busy = [frame(0, first, begun, latency_cclk=160), frame(1, second, other, latency_cclk=600)]
    assert frame_rate_hz(busy, 1_000_000) == 1_000_000 / 940


def test_firmware_is_no_faster_than_pictures_can_come() -> None:
    """Behind a long first frame two pictures are there; the frames after it end 40 cycles apart, and no two pictures come so near."""
    first = core_frame("A", 0, cost("Edge detection", 400), cost(REST, 0, idle_cclk=100))
    short = [core_frame("A", 500 + 40 * each, cost("Edge detection", 40)) for each in range(2)]
    frames = [
        frame(0, first, latency_cclk=400),
        *(frame(1 + each, short[each], latency_cclk=340 - 60 * each) for each in range(2)),
    ]
    assert [each.last_line_cclk for each in frames] == [100, 200, 300]
    assert frame_rate_hz(frames, 1_000_000) == 1_000_000 / 100


def test_frame_rate_runs_from_frame_end_to_frame_end() -> None:
    """The start-up in the first frame does not count; the last core to end does."""
    run = edge_run(9_950, 950, 950)
    assert frame_rate_hz(run.frames, 1_000_000) == 2 / (2_000 / 1_000_000)


def test_frame_rate_of_one_frame_is_one_over_its_duration() -> None:
    """With one frame there is no distance between ends."""
    assert frame_rate_hz(edge_run(950).frames, 1_000_000) == 1_000


def test_latency_runs_from_last_line_in_to_result_out() -> None:
    """The frame factory lets the result out ten cycles after the last line."""
    run = edge_run(100, 200)
    assert [latency_cclk(each) for each in run.frames] == [10, 10]
    assert budget_of(run).latency_cclk.total == 20


def test_milliseconds_follow_the_core_clock() -> None:
    """600 000 cycles at 600 MHz are one millisecond."""
    assert milliseconds(600_000, 600e6) == pytest.approx(1.0)


@given(runs())
@settings(max_examples=50)
def test_rows_sum_to_the_frame_and_the_split_to_the_row(run: RunRecord) -> None:
    """Nothing is lost or counted twice: to the cycle, per row and per core, on any run."""
    for core in budget_of(run).cores:
        assert core.frame.name == FRAME
        assert sum(row.elapsed_cclk.total for row in core.rows) == core.frame.elapsed_cclk.total
        assert sum(core.share(row) for row in core.rows) == pytest.approx(1)
        for row in core.all_rows:
            split = row.issue_cclk + sum(row.stall_cclk.values()) + row.idle_cclk
            assert split == row.elapsed_cclk.total
            assert row.elapsed_cclk.minimum <= row.elapsed_cclk.median <= row.elapsed_cclk.p95
            assert row.elapsed_cclk.p95 <= row.elapsed_cclk.maximum
