"""The report of a run as rich tables that fit 80 columns: budget, stalls, cycles, frames, configuration."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.budget.budget import Budget, budget_of
from bfsim.report.budget.rows import elapsed_cclk
from bfsim.report.budget.spread import FRAMES_FOR_P95, Spread, has_p95
from bfsim.report.budget.start_up import of_one_frame
from bfsim.report.budget.target import Target, target_words
from bfsim.report.budget.times import milliseconds
from bfsim.report.run.budget_tables import budget_table, cycle_table, spread_cells, spread_heads, stall_table
from bfsim.report.run.frame_table import frame_table
from bfsim.report.run.notes import frames_by_remark
from bfsim.report.run.warning_table import warning_table
from bfsim.report.run.warnings import missed_frames
from bfsim.report.tables.table import new_table, notes_table, stacked
from bfsim.report.what_ran.code import TRUST
from bfsim.report.what_ran.configuration import configuration_of
from bfsim.trace import REST, RunRecord

REMARKS_LISTED = 20
"""The number of distinct remarks that are listed."""


def run_report(run: RunRecord, target: Target | None = None) -> RenderableType:
    """Return the report of a run of at least one frame, the main numbers first, with a target if there is one."""
    budget = budget_of(run)
    hz = run.identity.cclk_hz
    return stacked(
        headline(run, budget),
        *([] if target is None else [Text(f"Target {target_words(run, target)}")]),
        *(budget_table(run, core) for core in budget.cores),
        *_p95_note(run),
        *_reference_note(run),
        *_start_up_note(run, budget),
        *stall_table(budget, len(run.frames), hz),
        *(cycle_table(run, core) for core in budget.cores),
        frame_table(run),
        *_results_table(run),
        *_remarks(run),
        configuration(run),
        *warning_table(run),
    )


def headline(run: RunRecord, budget: Budget) -> Text:
    """Return frame rate, frame time, latency, and losses."""
    latency, hz = budget.latency_cclk, run.identity.cclk_hz
    median, maximum = milliseconds(latency.median, hz), milliseconds(latency.maximum, hz)
    lines = [
        f"{budget.frame_rate_hz:.2f} frames/s, {1000 / budget.frame_rate_hz:.2f} ms a frame{of_one_frame(run)}",
        f"Latency from last line in to result out: median {median:.2f} ms, max {maximum:.2f} ms",
        f"Frames done: {len(run.frames)}, missed: {missed_frames(run)}",
    ]
    if run.interrupted:
        lines.append("Interrupted: this is the report of the frames done until then.")
    return Text("\n".join(lines))


def _p95_note(run: RunRecord) -> Iterator[Text]:
    """Say why there is no p95, if there is none."""
    if not has_p95(run):
        yield Text(f"There is no p95 of fewer than {FRAMES_FOR_P95} frames: it would be the max.")


def _reference_note(run: RunRecord) -> Iterator[Text]:
    """Say what the reference in the budget is, if there is one."""
    if run.reference is not None:
        yield Text(f"{run.reference.name}: {run.reference.about}")


def _start_up_note(run: RunRecord, budget: Budget) -> Iterator[Text]:
    """Say why the first frame stands out, if it does."""
    first = run.frames[0]
    medians = [row.elapsed_cclk.median for core in budget.cores for row in core.rows if row.name == REST]
    rests = [elapsed_cclk(each for each in core.stages if each.stage == REST) for core in first.cores]
    if any(rest > 2 * median for rest, median in zip(rests, medians, strict=True)):
        yield Text(f"{REST} of frame {first.index} holds the start-up too: the wait for the first picture.")


def _results_table(run: RunRecord) -> Iterator[Table]:
    """Yield the numbers that the firmware published, if any."""
    names = dict.fromkeys(name for frame in run.frames for name in frame.results)
    if names:
        table = new_table("Results per frame", "Result", *spread_heads(run))
        for name in names:
            spread = Spread.of([frame.results[name] for frame in run.frames if name in frame.results])
            table.add_row(name, *(f"{value:,}" for value in spread_cells(run, spread)))
        yield table


def _remarks(run: RunRecord) -> Iterator[Table]:
    """Yield the firmware's remarks about frames, if any: each sentence once."""
    frames = frames_by_remark(run)
    if not frames:
        return
    table = new_table("Remarks", "Frame")
    table.add_column("", overflow="fold")
    for text, said in list(frames.items())[:REMARKS_LISTED]:
        more = f" ({len(said):,} times, the last in frame {said[-1]})" if len(said) > 1 else ""
        table.add_row(str(said[0]), text + more)
    if len(frames) > REMARKS_LISTED:
        table.add_row("", f"({len(frames) - REMARKS_LISTED:,} others; the JSON has all)")
    yield table


def configuration(run: RunRecord) -> Table:
    """Return what ran on what, and the digests of it and of its cycles."""
    table = notes_table()
    table.title, table.title_style, table.title_justify = "Configuration", "bold not italic", "left"
    for name, text in (*configuration_of(run), TRUST):
        table.add_row(name, text)
    return table
