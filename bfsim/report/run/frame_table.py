"""The time of each frame on each core, stage by stage, as a table."""

from __future__ import annotations

from rich.table import Table

from bfsim.report.budget.budget import FRAME
from bfsim.report.budget.rows import budget_rows, costs_of, elapsed_cclk
from bfsim.report.budget.times import latency_cclk, milliseconds
from bfsim.report.tables.table import new_table
from bfsim.trace import BudgetRow, FrameRecord, RunRecord

SHOWN_AT_EACH_END = 4
"""Frames listed at the beginning and at the end of a long run."""


def frame_table(run: RunRecord) -> Table:
    """Return the frames in ms, core by core; of a long run, the first and the last ones."""
    rows = budget_rows(run)
    names = [row.stage for row in rows if row.within is None]
    table = new_table("Frames: ms", "Frame", "Core", *names, FRAME, "Latency")
    table.columns[1].min_width = None
    table.columns[-1].no_wrap = True
    long = len(run.frames) > 2 * SHOWN_AT_EACH_END + 1
    head = run.frames[:SHOWN_AT_EACH_END] if long else run.frames
    tail = run.frames[-SHOWN_AT_EACH_END:] if long else ()
    _add_frames(table, head, rows, run.identity.cclk_hz)
    if long:
        table.add_row("…")
        table.caption = "--json has all of them."
        table.caption_justify = "left"
    _add_frames(table, tail, rows, run.identity.cclk_hz)
    return table


def _add_frames(
    table: Table, frames: tuple[FrameRecord, ...], rows: tuple[BudgetRow, ...], hz: float
) -> None:
    for frame in frames:
        for core in frame.cores:
            costs = [elapsed_cclk(costs_of(core, row, rows)) for row in rows if row.within is None]
            cclk = [*costs, core.end_cclk - core.begin_cclk]
            first = core is frame.cores[0]
            table.add_row(
                str(frame.index) if first else "",
                core.core,
                *(f"{milliseconds(each, hz):.2f}" for each in cclk),
                f"{milliseconds(latency_cclk(frame), hz):.2f}" if first else "",
            )
