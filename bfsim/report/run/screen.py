"""The single screen of `bfsim run`: the verdict, one budget for all cores, and what to know about it."""

from __future__ import annotations

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.budget.bound import Bound, Cause, bound_of
from bfsim.report.budget.budget import Budget, CoreBudget, StageRow, budget_of
from bfsim.report.budget.start_up import of_one_frame, without_start_up
from bfsim.report.budget.target import Target
from bfsim.report.budget.times import frame_rate_hz, milliseconds, waits_for_pictures
from bfsim.report.run.budget_tables import named
from bfsim.report.run.notes import notes
from bfsim.report.tables.bars import IDLE, STALL, WORK, bar_of
from bfsim.report.tables.table import new_table, percent, stacked
from bfsim.trace import REST, RunRecord

BAR = 20
"""The length of a bar for a whole frame, in characters."""
SLIVER = "▏"


def screen(run: RunRecord, target: Target | None = None) -> RenderableType:
    """Return the report of a run of at least one frame on one screen, beside a target if there is one.

    Its medians and shares do not include the start-up.
    """
    budget = budget_of(without_start_up(run))
    bound = bound_of(budget)
    return stacked(_verdict(run, bound), _table(run, budget, bound), notes(run, budget, bound, target))


def verdict(run: RunRecord) -> Text:
    """Return the frame rate of a run of at least one frame, and what bounds it, in one sentence."""
    return _verdict(run, bound_of(budget_of(without_start_up(run))))


def _verdict(run: RunRecord, bound: Bound) -> Text:
    core = bound.core
    share, idle = (
        f"{100 * cclk / core.frame.elapsed_cclk.total:.0f}" for cclk in (bound.cclk, core.frame.idle_cclk)
    )
    is_paced = idle != "0" and waits_for_pictures(run.frames)
    waits = f", and it waits for each picture ({idle} %)" if is_paced else ""
    by = {
        Cause.STAGE: f"core {core.core}'s {_stage(bound.row)} ({share} %){waits}",
        Cause.PICTURES: f"the pictures, core {core.core} waits for them ({share} %)",
        Cause.OTHER_CORE: f"the cores' turns, core {core.core} waits for its own ({share} %)",
    }[bound.cause]
    rate_hz = frame_rate_hz(run.frames, run.identity.cclk_hz)
    return Text(
        f"{rate_hz:.2f} frames/s, {1000 / rate_hz:.2f} ms a frame{of_one_frame(run)}: bound by {by}.",
        style="bold",
    )


def _stage(row: StageRow | None) -> str:
    if row is None or row.name == REST:
        return "work outside of stages"
    return row.name


def _table(run: RunRecord, budget: Budget, bound: Bound) -> Table:
    """Return a row for each stage that took time: median ms and stall of each core, and its share of the bounding core."""
    hz, core = run.identity.cclk_hz, bound.core
    beside = () if run.reference is None else (run.reference.name,)
    names = [head for each in budget.cores for head in (f"{each.core} ms", "stall%")]
    table = new_table("", "Stage", *names, *beside, f"% of {core.core}")
    table.title = None
    key = Text.assemble(WORK, " work ", STALL, " stall ", IDLE, " idle")
    table.add_column(key, no_wrap=True, min_width=BAR)
    for rows in zip(*(each.all_rows for each in budget.cores), strict=True):
        row = next(each for each in rows if each in core.all_rows)
        is_frame = row is core.frame
        if is_frame:
            table.add_section()
        if any(each.elapsed_cclk.total for each in rows):
            table.add_row(
                named(row),
                *(cell for each in rows for cell in _cells(each, hz)),
                *("" if row.reference_ms is None else f"{row.reference_ms:g}" for _ in beside),
                percent(core.share(row), 1),
                bar(row, core),
                style="bold" if is_frame else None,
            )
    return table


def _cells(row: StageRow, hz: float) -> tuple[str, str]:
    return f"{milliseconds(row.elapsed_cclk.median, hz):.2f}", percent(
        row.stalled_cclk, row.elapsed_cclk.total
    )


def bar(row: StageRow, core: CoreBudget) -> Text:
    """Return a row's work, stalls and idling as parts of a frame, `BAR` characters long; less than one is a sliver."""
    text = bar_of(row, core.frame.elapsed_cclk.total, BAR)
    if row.elapsed_cclk.total and not text:
        parts = (row.issue_cclk, WORK), (row.stalled_cclk, STALL), (row.idle_cclk, IDLE)
        text.append(SLIVER, max(parts)[1][1])
    return text
