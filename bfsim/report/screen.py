"""What `bfsim run` says on one screen: the verdict, one budget for all cores, and what to know about it."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.bars import IDLE, STALL, WORK, bar_of
from bfsim.report.bound import Bound, Cause, bound_of
from bfsim.report.budget import (
    FRAMES_FOR_P95,
    Budget,
    CoreBudget,
    Spread,
    StageRow,
    budget_of,
    has_p95,
    latency_cclk,
    milliseconds,
)
from bfsim.report.run_tables import missed, named
from bfsim.report.start_up import of_one_frame, start_up_cclk, without_start_up
from bfsim.report.tables import new_table, notes_table, percent, stacked
from bfsim.report.target import Target, target_words
from bfsim.report.warnings import warnings_of
from bfsim.report.what_ran import what_ran
from bfsim.trace import REST, FrameRecord, RunRecord

BAR = 20
"""Characters that stand for a whole frame."""
SLIVER = "▏"
REASONS_TOLD = 3
REMARKS_TOLD = 3
MUCH_STALL = 0.1
"""From this share of a frame on, a reader should look at the memories first."""


def screen(run: RunRecord, target: Target | None = None) -> RenderableType:
    """Return the report of a run of at least one frame on one screen, beside a target if there is one.

    Its medians and shares are without the start-up.
    """
    budget = budget_of(without_start_up(run))
    bound = bound_of(budget)
    return stacked(verdict(run), _table(run, budget, bound), _notes(run, budget, bound, target))


def verdict(run: RunRecord) -> Text:
    """Return the frame rate of a run of at least one frame, and what bounds it, in one sentence."""
    budget = budget_of(without_start_up(run))
    bound = bound_of(budget)
    core = bound.core
    share = f"{100 * bound.cclk / core.frame.elapsed_cclk.total:.0f}"
    by = {
        Cause.STAGE: f"core {core.core}'s {_stage(bound.row)} ({share} %)",
        Cause.PICTURES: f"the pictures, core {core.core} waits for them ({share} %)",
        Cause.OTHER_CORE: f"the cores' turns, core {core.core} waits for its own ({share} %)",
    }[bound.cause]
    rate_hz = budget_of(run).frame_rate_hz
    return Text(
        f"{rate_hz:.2f} frames/s, {1000 / rate_hz:.2f} ms a frame{of_one_frame(run)}: bound by {by}.",
        style="bold",
    )


def _stage(row: StageRow | None) -> str:
    if row is None or row.name == REST:
        return "work outside of stages"
    return row.name


def _table(run: RunRecord, budget: Budget, bound: Bound) -> Table:
    """Return one row a stage that took any time: median ms and stall of each core, and its share of the core that bounds."""
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
        sum(row.stall_cclk.values()), row.elapsed_cclk.total
    )


def bar(row: StageRow, core: CoreBudget) -> Text:
    """Return a row's work, stalls and idling as parts of a frame, `BAR` characters long; a sliver if it is less than one."""
    text = bar_of(row, core.frame.elapsed_cclk.total, BAR)
    if row.elapsed_cclk.total and not text:
        parts = (row.issue_cclk, WORK), (sum(row.stall_cclk.values()), STALL), (row.idle_cclk, IDLE)
        text.append(SLIVER, max(parts)[1][1])
    return text


def _notes(run: RunRecord, budget: Budget, bound: Bound, target: Target | None) -> Table:
    """Return the warnings, and what to know beside the numbers, in one grid."""
    table = notes_table()
    for each in warnings_of(run):
        table.add_row("Warning", f"{each.kind}: {each.text}", style="yellow")
    if target is not None:
        table.add_row("Target", target_words(run, target))
    for name, text in _facts(run, budget, bound):
        table.add_row(name, text)
    for name, text in _next(bound):
        table.add_row(name, text)
    return table


def _facts(run: RunRecord, budget: Budget, bound: Bound) -> Iterator[tuple[str, str]]:
    hz = run.identity.cclk_hz
    yield "Frames", _frames(run, bound.core)
    yield "Latency", _latency(run, budget)
    stalls = sorted(bound.core.frame.stall_cclk.items(), key=lambda each: -each[1])
    if stalls:
        told = ", ".join(
            f"{reason} {milliseconds(cclk, hz) / len(run.frames):.2f}"
            for reason, cclk in stalls[:REASONS_TOLD]
        )
        yield (
            "Stalls",
            f"core {bound.core.core}, ms/frame: {told}{', …' if len(stalls) > REASONS_TOLD else ''}",
        )
    if run.reference is not None:
        yield run.reference.name, run.reference.about
    yield from _remarks(run)
    if run.geometry:
        yield "Cameras", run.geometry
    yield from what_ran(run)


def _remarks(run: RunRecord) -> Iterator[tuple[str, str]]:
    """Yield the first sentences that the firmware said about frames, each once."""
    firsts: dict[str, int] = {}
    for frame in run.frames:
        for text in frame.remarks:
            firsts.setdefault(text, frame.index)
    for text, index in list(firsts.items())[:REMARKS_TOLD]:
        yield "Remark", f"frame {index}: {text}"
    if len(firsts) > REMARKS_TOLD:
        yield "", f"{len(firsts) - REMARKS_TOLD:,} others: bfsim run --full"


def _frames(run: RunRecord, core: CoreBudget) -> str:
    """Say how many there were, how long they took, and how much of the first was the start-up."""
    hz, first = run.identity.cclk_hz, run.frames[0]
    few = 1 < len(run.frames) < FRAMES_FOR_P95
    why = f" (a p95 from {FRAMES_FOR_P95} frames on: of fewer it is the max)" if few else ""
    parts = [f"{len(run.frames):,} done, {missed(run)} missed; {_spread(run, core.frame.elapsed_cclk)}{why}."]
    if run.interrupted:
        parts.append("Interrupted: these are the frames done until then.")
    start_up = milliseconds(start_up_cclk(run), hz)
    if len(run.frames) == 1 and core.frame.idle_cclk:
        wait = f"{milliseconds(core.frame.idle_cclk, hz):.2f} ms"
        parts.append(f"The {wait} until the first picture came are in all numbers: run more frames.")
    elif start_up:
        parts.append(
            f"Frame {first.index} took {start_up:.2f} ms more, until the first picture came: left out."
        )
    return " ".join(parts)


def _spread(run: RunRecord, spread: Spread) -> str:
    """Return median and maximum, and a p95 where there are frames enough for one; of one frame its number."""
    if len(run.frames) == 1:
        return f"{milliseconds(spread.maximum, run.identity.cclk_hz):.2f} ms"
    p95 = {"p95": spread.p95} if has_p95(run) else {}
    numbers = {"median": spread.median, **p95, "max": spread.maximum}
    told = (f"{name} {milliseconds(cclk, run.identity.cclk_hz):.2f}" for name, cclk in numbers.items())
    return f"{', '.join(told)} ms"


def _latency(run: RunRecord, budget: Budget) -> str:
    hz = run.identity.cclk_hz
    text = f"{_spread(run, budget.latency_cclk)} from last line in to result out"
    wait_cclk = Spread.of([_wait_cclk(frame) for frame in run.frames]).median
    if not wait_cclk:
        return f"{text}."
    return f"{text}; {milliseconds(wait_cclk, hz):.2f} of the median are the wait for the frame before."


def _wait_cclk(frame: FrameRecord) -> int:
    """Return how long a picture was there before the cores were done with the frame before."""
    free_cclk = min(core.begin_cclk for core in frame.cores)
    return min(max(0, free_cclk - frame.last_line_cclk), latency_cclk(frame))


def _next(bound: Bound) -> Iterator[tuple[str, str]]:
    """Yield where to look next."""
    yield "Next", "bfsim profile     which kernels and source lines take the time"
    frame = bound.core.frame
    if sum(frame.stall_cclk.values()) > MUCH_STALL * frame.elapsed_cclk.total:
        yield "", "bfsim ldf         where the buffers lie: much of the frame is stall"
    yield "", "bfsim run --full  every table: stalls, cycles, frames, results, digests"
