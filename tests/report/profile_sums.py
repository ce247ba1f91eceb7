"""What the tables of any profile must add up to."""

from __future__ import annotations

import pytest

from bfsim.report.budget.start_up import without_start_up
from bfsim.report.profile.buffers import buffers_of
from bfsim.report.profile.callers import callers_of
from bfsim.report.profile.costs import stages_in
from bfsim.report.profile.frames import worst_frames
from bfsim.report.profile.reason_tables import reasons_of
from bfsim.report.profile.tables import VIEWS
from bfsim.report.profile.view import View
from bfsim.trace import RunRecord, StallReason

NESTED = {"kernel", "reason"}
"""Views whose indented rows are parts of the row above; in the others each row stands for itself."""


def assert_profile_adds_up(run: RunRecord) -> None:
    """Of every core and of all, of every stage and of all: to the cycle in the records, and as printed."""
    stages = [None, *stages_in(run, None)]
    for core in (None, *(each.core for each in run.frames[0].cores)):
        for stage in stages:
            view = View.of(run, core, stage, 3)
            assert_cycles_add_up(view)
            for by in VIEWS:
                assert_rows_add_up(view, by)


def assert_cycles_add_up(view: View) -> None:
    """Stages are what the frames were; owners, lines, callers, buffers, reasons and frames are what the stages are."""
    run, core, stage, profile = view.run, view.core, view.stage, view.profile
    frames = [
        each for frame in without_start_up(run).frames for each in frame.cores if core in (None, each.core)
    ]
    parts = stages_in(run, stage)
    costs = [cost for each in frames for cost in each.stages if cost.stage in parts]
    assert profile.whole.elapsed_cclk == sum(each.end_cclk - each.begin_cclk for each in frames)
    assert profile.cost.elapsed_cclk == sum(each.elapsed_cclk for each in costs)
    assert profile.cost.issue_cclk == sum(each.issue_cclk for each in costs)
    assert profile.cost.idle_cclk == sum(each.idle_cclk for each in costs)
    kernels_cclk = 0
    for each in profile.stages:
        assert sum(owner.cost.elapsed_cclk for owner in each.owners) == each.cost.elapsed_cclk
        for owner in (owner for owner in each.owners if owner.symbol):
            kernels_cclk += owner.cost.elapsed_cclk
            assert sum(line.cost.elapsed_cclk for line in owner.lines) == owner.cost.elapsed_cclk
    assert sum(each.inclusive_cclk for each in callers_of(run, core, stage)) == kernels_cclk
    operations_cclk = profile.cost.issue_cclk + profile.cost.stall_cclk[StallReason.INTERLOCK]
    waited_cclk = sum(each.stalled_cclk for each in buffers_of(run, core, stage))
    no_kernel = view.of_no_kernel()
    assert (
        waited_cclk + operations_cclk + no_kernel.elapsed_cclk - no_kernel.issue_cclk
        == profile.cost.elapsed_cclk
    )
    reasons = reasons_of(view)
    assert sum(each.total() for each in reasons.values()) == profile.cost.elapsed_cclk
    for frame in worst_frames(run, core, stage)[1]:
        assert sum(cclk for _, cclk in frame.stages) == frame.difference_cclk
        assert sum(each.cclk for each in frame.owners) == frame.difference_cclk


def assert_rows_add_up(view: View, by: str) -> None:
    """The last row of a table is the sum of those above it, but for rounding."""
    table = next(iter(VIEWS[by](view)), None)
    if table is None:  # no frame took longer than the median one
        assert by == "frame"
        return
    names = [str(each) for each in table.columns[0].cells]
    rows = [number for number, name in enumerate(names) if by not in NESTED or not name.startswith(" ")]
    for column in table.columns[1:]:
        if column.header in ("ms", "%", "alone ms", "alone %") or by == "frame":
            cells = [str(each) for each in column.cells]
            *parts, whole = (float(cells[row]) for row in rows)
            half_a_digit = 0.5 / 10 ** len(cells[rows[-1]].partition(".")[2])
            rounding = half_a_digit * (len(parts) + 1.5)
            assert sum(parts) == pytest.approx(whole, abs=rounding), (by, column.header)
            if column.header in ("%", "alone %") and view.stage is None:
                assert whole == 100.0
