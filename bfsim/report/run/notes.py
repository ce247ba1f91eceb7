"""What to know about the numbers of a run, in one grid: its warnings, its frames, what ran, and where to look next."""

from __future__ import annotations

from collections.abc import Iterator

from rich.table import Table

from bfsim.report.budget.bound import Bound
from bfsim.report.budget.budget import Budget, CoreBudget
from bfsim.report.budget.spread import FRAMES_FOR_P95, Spread, has_p95
from bfsim.report.budget.start_up import start_up_cclk
from bfsim.report.budget.target import Target, target_words
from bfsim.report.budget.times import latency_cclk, milliseconds
from bfsim.report.run.warnings import missed_frames, warnings_of
from bfsim.report.tables.table import notes_table
from bfsim.report.what_ran.in_brief import what_ran
from bfsim.trace import FrameRecord, RunRecord

REASONS_TOLD = 3
REMARKS_TOLD = 3
MUCH_STALL = 0.1
"""From this share of a frame on, a reader should look at the memories first."""


def notes(run: RunRecord, budget: Budget, bound: Bound, target: Target | None) -> Table:
    """Return the warnings, and what to know about the numbers, in one grid."""
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
    """Yield the firmware's first remarks about frames, each once."""
    frames = frames_by_remark(run)
    for text, said in list(frames.items())[:REMARKS_TOLD]:
        yield "Remark", f"frame {said[0]}: {text}"
    if len(frames) > REMARKS_TOLD:
        yield "", f"{len(frames) - REMARKS_TOLD:,} others: bfsim run --full"


def frames_by_remark(run: RunRecord) -> dict[str, list[int]]:
    """Return the indices of the frames with each of the firmware's remarks, sorted by their first frames."""
    frames: dict[str, list[int]] = {}
    for frame in run.frames:
        for text in frame.remarks:
            frames.setdefault(text, []).append(frame.index)
    return frames


def _frames(run: RunRecord, core: CoreBudget) -> str:
    """Say how many frames there were, how long they took, and how much of the first was the start-up."""
    hz, first = run.identity.cclk_hz, run.frames[0]
    few = 1 < len(run.frames) < FRAMES_FOR_P95
    why = f" (a p95 needs {FRAMES_FOR_P95} frames)" if few else ""
    parts = [
        f"{len(run.frames):,} done, {missed_frames(run)} missed; {_spread(run, core.frame.elapsed_cclk)}{why}."
    ]
    if run.interrupted:
        parts.append("Interrupted: these are the frames done until then.")
    start_up = milliseconds(start_up_cclk(run), hz)
    if len(run.frames) == 1 and core.frame.idle_cclk:
        wait = f"{milliseconds(core.frame.idle_cclk, hz):.2f} ms"
        parts.append(f"All numbers include the {wait} until the first picture came: run more frames.")
    elif start_up:
        parts.append(
            f"Frame {first.index} took {start_up:.2f} ms more, until the first picture came; this is left out."
        )
    return " ".join(parts)


def _spread(run: RunRecord, spread: Spread) -> str:
    """Return median and maximum, and a p95 if there are enough frames; of one frame, its number."""
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
    """Return how long a picture was there before the cores had finished the frame before."""
    return min(max(0, frame.begin_cclk - frame.last_line_cclk), latency_cclk(frame))


def _next(bound: Bound) -> Iterator[tuple[str, str]]:
    """Yield where to look next."""
    yield "Next", "bfsim profile     which kernels and source lines take the time"
    frame = bound.core.frame
    if frame.stalled_cclk > MUCH_STALL * frame.elapsed_cclk.total:
        yield "", "bfsim ldf         where the buffers lie: much of the frame is stall"
    yield "", "bfsim run --full  every table: stalls, cycles, frames, results, digests"
