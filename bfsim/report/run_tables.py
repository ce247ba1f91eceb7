"""The report of a run as rich tables that fit 80 columns: budget, stalls, cycles, frames, configuration."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.budget import (
    FRAME,
    FRAMES_FOR_P95,
    Budget,
    CoreBudget,
    Spread,
    StageRow,
    budget_of,
    budget_rows,
    costs_of,
    elapsed_cclk,
    has_p95,
    latency_cclk,
    milliseconds,
)
from bfsim.report.code import TRUST
from bfsim.report.configuration import configuration_of
from bfsim.report.start_up import of_one_frame
from bfsim.report.tables import new_table, notes_table, percent, stacked
from bfsim.report.target import Target, target_words
from bfsim.report.warnings import MISSED_LISTED, warnings_of
from bfsim.trace import REST, BudgetRow, FrameRecord, RunRecord, StallReason

SHOWN_AT_EACH_END = 4
"""Frames listed at the beginning and at the end of a long run."""

REMARKS_LISTED = 20
"""Different remarks that are listed."""


def run_report(run: RunRecord, target: Target | None = None) -> RenderableType:
    """Return the report of a run of at least one frame, the most wanted numbers first, beside a target if there is one."""
    budget = budget_of(run)
    hz = run.identity.cclk_hz
    return stacked(
        headline(run, budget),
        *([] if target is None else [Text(f"Target {target_words(run, target)}")]),
        *(_budget_table(run, core) for core in budget.cores),
        *_p95_note(run),
        *_reference_note(run),
        *_start_up_note(run, budget),
        *_stall_table(budget, len(run.frames), hz),
        *(_cycle_table(run, core) for core in budget.cores),
        _frame_table(run),
        *_results_table(run),
        *_remarks(run),
        configuration(run),
        *warning_table(run),
    )


def headline(run: RunRecord, budget: Budget) -> Text:
    """Return frame rate, frame time, latency, and what went missing."""
    latency, hz = budget.latency_cclk, run.identity.cclk_hz
    median, maximum = milliseconds(latency.median, hz), milliseconds(latency.maximum, hz)
    lines = [
        f"{budget.frame_rate_hz:.2f} frames/s, {1000 / budget.frame_rate_hz:.2f} ms a frame{of_one_frame(run)}",
        f"Latency from last line in to result out: median {median:.2f} ms, max {maximum:.2f} ms",
        f"Frames done: {len(run.frames)}, missed: {missed(run)}",
    ]
    if run.interrupted:
        lines.append("Interrupted: this is the report of the frames done until then.")
    return Text("\n".join(lines))


def missed(run: RunRecord) -> str:
    """Return how many frames were missed, and which."""
    if not run.missed:
        return "0"
    listed = ", ".join(str(index) for index in run.missed[:MISSED_LISTED])
    return f"{len(run.missed)} ({listed}{', …' if len(run.missed) > MISSED_LISTED else ''})"


def _budget_table(run: RunRecord, core: CoreBudget) -> Table:
    hz, beside = run.identity.cclk_hz, () if run.reference is None else (run.reference,)
    columns = (*_heads(run), *(each.name for each in beside), "share", "issue", "stall", "idle")
    table = new_table(
        f"Core {core.core}: ms per frame; share, issue, stall and idle in %",
        "Stage",
        *columns,
    )
    for row in core.all_rows:
        table.add_row(
            named(row),
            *(f"{milliseconds(cclk, hz):.2f}" for cclk in _columns(run, row.elapsed_cclk)),
            *("" if row.reference_ms is None else f"{row.reference_ms:g}" for _ in beside),
            percent(core.share(row), 1),
            *(percent(part, row.elapsed_cclk.total) for part in _split(row)),
            end_section=row is core.rows[-1],
            style="bold" if row is core.frame else None,
        )
    return table


def named(row: StageRow) -> str:
    """Return the name of a row, indented if the row is a part of the one above."""
    return row.name if row.within is None else f"  {row.name}"


def _heads(run: RunRecord) -> tuple[str, ...]:
    """Return the heads of `_columns`."""
    return ("min", "median", "p95", "max") if has_p95(run) else ("min", "median", "max")


def _columns(run: RunRecord, spread: Spread) -> tuple[int, ...]:
    p95 = (spread.p95,) if has_p95(run) else ()
    return spread.minimum, spread.median, *p95, spread.maximum


def _split(row: StageRow) -> tuple[int, int, int]:
    return row.issue_cclk, sum(row.stall_cclk.values()), row.idle_cclk


def _p95_note(run: RunRecord) -> Iterator[Text]:
    """Say why there is no p95, if there is none."""
    if not has_p95(run):
        yield Text(f"A p95 is told from {FRAMES_FOR_P95} frames on: of fewer it is the max.")


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


def _stall_table(budget: Budget, frames: int, hz: float) -> Iterator[Table]:
    """Yield the stalls by row and reason, if there were any."""
    columns = [f"{core.core} {unit}" for core in budget.cores for unit in ("ms", "%")]
    table = new_table("Stalls: mean ms per frame, % of the frame", "Stage", "Reason", *columns)
    table.columns[1].justify = "left"
    table.columns[1].no_wrap = True
    for rows in zip(*(core.all_rows for core in budget.cores), strict=True):
        reasons = [reason for reason in StallReason if any(reason in row.stall_cclk for row in rows)]
        for reason in reasons:
            cells = [
                _stall_cells(core, row, reason, frames, hz)
                for core, row in zip(budget.cores, rows, strict=True)
            ]
            name = named(rows[0]) if reason is reasons[0] else ""
            table.add_row(name, reason, *sum(cells, ()), end_section=reason is reasons[-1])
    if table.row_count:
        yield table


def _stall_cells(
    core: CoreBudget, row: StageRow, reason: StallReason, frames: int, hz: float
) -> tuple[str, str]:
    cclk = row.stall_cclk.get(reason, 0)
    return f"{milliseconds(cclk, hz) / frames:.2f}", percent(cclk, core.frame.elapsed_cclk.total)


def _cycle_table(run: RunRecord, core: CoreBudget) -> Table:
    table = new_table(f"Core {core.core}: CCLK cycles per frame", "Stage", *_heads(run), "all frames")
    for row in core.all_rows:
        cells = [f"{cclk:,}" for cclk in (*_columns(run, row.elapsed_cclk), row.elapsed_cclk.total)]
        table.add_row(named(row), *cells, end_section=row is core.rows[-1])
    return table


def _frame_table(run: RunRecord) -> Table:
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


def _results_table(run: RunRecord) -> Iterator[Table]:
    """Yield what the firmware published, if it did."""
    names = dict.fromkeys(name for frame in run.frames for name in frame.results)
    if names:
        table = new_table("Results per frame", "Result", *_heads(run))
        for name in names:
            spread = Spread.of([frame.results[name] for frame in run.frames if name in frame.results])
            table.add_row(name, *(f"{value:,}" for value in _columns(run, spread)))
        yield table


def _remarks(run: RunRecord) -> Iterator[Table]:
    """Yield what the firmware said about frames, if it did: each sentence once."""
    frames: dict[str, list[int]] = {}
    for frame in run.frames:
        for text in frame.remarks:
            frames.setdefault(text, []).append(frame.index)
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


def warning_table(run: RunRecord) -> Iterator[Table]:
    """Yield the warnings, if there are any, in the colour of warnings."""
    warnings = warnings_of(run)
    if warnings:
        table = new_table("Warnings", "About")
        table.title_style, table.style = "bold not italic yellow", "yellow"
        table.add_column("", overflow="fold")
        for each in warnings:
            table.add_row(each.kind, each.text)
        yield table


def configuration(run: RunRecord) -> Table:
    """Return what was run on what, and the digests of it and of its cycles."""
    table = notes_table()
    table.title, table.title_style, table.title_justify = "Configuration", "bold not italic", "left"
    for name, text in (*configuration_of(run), TRUST):
        table.add_row(name, text)
    return table
