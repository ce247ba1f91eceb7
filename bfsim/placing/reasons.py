"""Why each part lies where it does, in a few words, for the comments of the LDF."""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.placing.measured import Accesses, Measured
from bfsim.placing.model import SHARED, Model, Part
from bfsim.placing.placed import Placed
from bfsim.placing.stretches import Level
from bfsim.report.wording.units import mhz

LEAST_MS = 0.0005
"""Shorter times are not mentioned."""


def reason(model: Model, part: Part, stretch: int, measured: Measured) -> str:
    """Return how large a part is, how often it is used and by whom, and its cost in other memories."""
    words = [
        f"{part.symbol.nbytes:,} B",
        *_uses(model, part, measured),
        *_elsewhere(model, part, stretch, measured),
    ]
    return "; ".join(words)


def accesses_of(model: Model, part: Part, measured: Measured) -> Accesses:
    """Return the accesses of all cores to a part in a frame."""
    found = [measured.accesses.get((core, part.name), Accesses()) for core in model.board.chip.cores]
    return Accesses(sum(each.reads for each in found), sum(each.writes for each in found))


def cost_ms(model: Model, part: Part, stretch: int, measured: Measured) -> float:
    """Return how long all cores together wait for a part in a stretch in a frame."""
    return sum(model.cclk(part, stretch, measured).values()) * 1000 / float(model.board.clocks.cclk_hz)


def _uses(model: Model, part: Part, measured: Measured) -> list[str]:
    """Say how a part is used, and how often."""
    if part.is_code:
        issue_cclk = measured.issue_cclk.get((part.owner, part.name), 0.0)
        return [f"{issue_cclk:,.0f} issue cycles" if issue_cclk else "not run in the frames measured"]
    made = accesses_of(model, part, measured)
    words = []
    if made.reads or made.writes:
        words.append(f"{made.reads:,.0f} reads, {made.writes:,.0f} writes")
    if part.name in measured.streamed:
        words.append("DMA")
    return words or ["not used in the frames measured"]


def _elsewhere(model: Model, part: Part, stretch: int, measured: Measured) -> list[str]:
    """Say how long the cores wait here and in the next slower memory, and why the part is in no faster one."""
    here, level = cost_ms(model, part, stretch, measured), model.stretches[stretch].level
    slower = [
        (cost_ms(model, part, number, measured), each.level)
        for number, each in enumerate(model.stretches)
        if each.takes(owner=part.owner, is_code=part.is_code)
    ]
    dearer = sorted((cost, other) for cost, other in slower if cost > here + LEAST_MS)
    waits = [f"{here:.3f} ms"] if here >= LEAST_MS else []
    waits += [f"in {other} {cost:.3f} ms" for cost, other in dearer[:1]]
    why = ["both cores: no L1"] if level in (Level.L2, Level.SDRAM) and part.owner == SHARED else []
    return [*([", ".join(waits)] if waits else []), *why]


def about(placed: Placed) -> Iterator[str]:
    """Yield the paragraphs at the top of the LDF: its purpose, its speed, and how to read it."""
    identity = placed.identity
    yield (
        f"Written by `bfsim place` for {identity.firmware}, pictures of {identity.width_px}x{identity.height_px}, "
        f"{identity.board} ({mhz(identity.cclk_hz)}, SCLK {mhz(identity.sclk_hz)}), {identity.compiler}; measured on "
        f"{placed.frames} frame{'' if placed.frames == 1 else 's'} of {identity.recording}. Its memories and reserves are those of {placed.start}."
    )
    first = "before" if placed.linked else "with what did not fit moved elsewhere"
    yield (
        f"A frame takes {placed.after_ms:.2f} ms in simulation: {placed.predicted_ms:.2f} were predicted, and it took "
        f"{placed.before_ms:.2f} {first}."
    )
    yield (
        "Each buffer has a line: its size, the cores' accesses in a frame, whether DMA moves it, and how long the cores wait for it in "
        "a frame, here and in the next slower memory. bfsim takes each buffer and each kernel as an object file of its own, NAME.doj."
    )
