"""What a sweep keeps of a run: its figures under the names of `bfsim check`, and the waits of the cores."""

from __future__ import annotations

from bfsim.report.budget.budget import budget_of
from bfsim.report.budget.times import milliseconds
from bfsim.report.check.as_json import figures_by_name
from bfsim.report.check.figures import COUNTS, OBJECTS, figures_of, statistic
from bfsim.report.results.result import Result
from bfsim.trace import StallReason

FRAME_RATE, FRAME_TIME, WORST_FRAME = "frame_rate Hz", "frame.median ms", "frame.max ms"
LATENCY, MISSED, ON_CHIP = "latency.median ms", "missed", "on_chip B"
SEEN = f"{OBJECTS}."
"""Begins the names of figures that a run has only if it saw such an object."""
SDRAM = "SDRAM"

DIGITS = 6
"""After the point: finer than a cycle, in ms."""


def sweep_figures(result: Result) -> dict[str, int | float]:
    """Return the figures of a run of at least one frame, by names that end in the unit, such as Thinning.A.median ms.

    These are the figures of `figures_by_name`, the bytes used of all memories on the chip, for each core its share of
    idle time and its stalls by reason per frame, and the total and the median for each kind of object and each
    published number.
    """
    run, figures = result.run, figures_of(result)
    hz = run.identity.cclk_hz
    found: dict[str, int | float] = dict(figures_by_name(figures, hz))
    found[ON_CHIP] = sum(each.used_bytes for each in run.memories if each.memory != SDRAM)
    for core in budget_of(run).cores:
        idle = 100 * core.frame.idle_cclk / core.frame.elapsed_cclk.total
        found[f"idle.{core.core} %"] = round(idle, DIGITS)
        for reason in StallReason:
            cclk = core.frame.stall_cclk.get(reason, 0) / len(run.frames)
            found[f"stall.{core.core}.{reason.value} ms"] = round(milliseconds(cclk, hz), DIGITS)
    for name, figure in figures.items():
        if name[0] in COUNTS:
            found |= {".".join((*name, each)): statistic(figure, each) for each in ("total", "median")}
    return {name.replace('"', ""): value for name, value in found.items()}
