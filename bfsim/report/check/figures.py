"""The figures of a run that can be limited, by name, each with its values, one per frame if it has them.

Stages and frames are counted without waits for pictures and for the other core: these are no work, and grow when
something becomes faster. Time outside of stages counts only in the frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from math import hypot
from typing import Any

from bfsim.report.budget.rows import budget_rows, costs_of
from bfsim.report.budget.spread import Spread
from bfsim.report.budget.times import frame_rate_hz, latency_cclk
from bfsim.report.budget.waits import busy_cclk
from bfsim.report.results.result import Result
from bfsim.report.results.seen_json import name_of_object
from bfsim.trace import REST, RunRecord

Name = tuple[str, ...]
"""Such as ("frame_rate",), ("Thinning", "A") or ("memory", "L2"): the parts of a dotted key of TOML."""

FRAME_RATE, MISSED, LATENCY, FRAME = ("frame_rate",), ("missed",), ("latency",), ("frame",)
OF_THE_RUN = FRAME_RATE, MISSED, LATENCY, FRAME
"""Figures that every run has, whatever its firmware."""
MEMORY, RESULTS, OBJECTS, DISTANCES = "memory", "results", "objects", "distance_mm"
SEEN = {OBJECTS, DISTANCES}
"""What the firmware sees: how many objects of a kind, and how far away the nearest is."""
COUNTS = {RESULTS, *SEEN}
"""Figures with a whole number for each frame: what the firmware publishes, and what it sees."""


class Unit(Enum):
    """The unit of a figure."""

    HZ = "Hz"
    CCLK = "cycles"
    BYTES = "B"
    COUNT = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One thing that was measured: a value per frame, or one for the whole run. `whole`: the size of a memory."""

    values: tuple[float, ...]
    unit: Unit
    whole: float = 0


STATISTICS = ("min", "median", "max", "total")


def statistic(figure: Figure, name: str) -> float:
    """Return one of the STATISTICS of a figure; the median is nearest-rank, as in the budget."""
    if name == "total":
        return sum(figure.values)
    if name == "median" and len(figure.values) > 1:
        return Spread.of([int(each) for each in figure.values]).median
    return min(figure.values) if name == "min" else max(figure.values)


def unit_of(name: Name) -> Unit:
    """Return the unit of the figure of that name."""
    if name == FRAME_RATE:
        return Unit.HZ
    if name == MISSED or name[0] in COUNTS:
        return Unit.COUNT
    return Unit.BYTES if name[0] == MEMORY else Unit.CCLK


def is_of_a_stage(name: Name) -> bool:
    """Whether the figure of that name is the time of a stage."""
    return name not in OF_THE_RUN and name[0] not in {MEMORY, *COUNTS}


def figures_of(result: Result) -> dict[Name, Figure]:
    """Return every figure of a run of at least one frame.

    A stage has a figure for each core, and one without a core: in each frame, the longer of them.
    """
    run = result.run
    figures: dict[Name, Figure] = {
        FRAME_RATE: _figure(FRAME_RATE, frame_rate_hz(run.frames, run.identity.cclk_hz)),
        MISSED: _figure(MISSED, len(run.missed)),
        LATENCY: _figure(LATENCY, *(latency_cclk(frame) for frame in run.frames)),
        FRAME: _figure(FRAME, *(max(busy_cclk(core.stages) for core in frame.cores) for frame in run.frames)),
    }
    figures |= {name: _figure(name, *values) for name, values in _stages(run)}
    for memory in run.memories:
        name = (MEMORY, memory.memory)
        figures[name] = Figure(values=(memory.used_bytes,), unit=Unit.BYTES, whole=memory.nbytes)
    results = dict.fromkeys(each for frame in run.frames for each in frame.results)
    for each in results:
        figures[RESULTS, each] = _figure(
            (RESULTS, each), *(frame.results.get(each, 0) for frame in run.frames)
        )
    figures |= {name: _figure(name, *values) for name, values in _seen(result)}
    return figures


def _seen(result: Result) -> Iterator[tuple[Name, list[int]]]:
    """Yield how many objects of each kind each frame shows, and how far away the nearest is, 0 for none."""
    indexes = [frame.index for frame in result.run.frames if frame.index in result.seen]
    far: list[dict[str, list[int]]] = []
    for index in indexes:
        far.append({})
        for each in result.seen[index]["objects"]:
            far[-1].setdefault(name_of_object(each), []).append(_distance_mm(each))
    for kind in dict.fromkeys(kind for each in far for kind in each):
        yield (OBJECTS, kind), [len(each.get(kind, ())) for each in far]
        distances = [min(each.get(kind, (0,))) for each in far]
        if any(distances):
            yield (DISTANCES, kind), distances


def _distance_mm(seen: Mapping[str, Any]) -> int:
    """Return how far an object is from the left camera; 0 if only its direction is known."""
    return 0 if seen["is_direction"] else round(hypot(*seen["place_mm"]))


def _figure(name: Name, *values: float) -> Figure:
    return Figure(values=values, unit=unit_of(name))


def _stages(run: RunRecord) -> Iterator[tuple[Name, tuple[int, ...]]]:
    rows = budget_rows(run)
    for row in rows:
        if row.stage == REST:
            continue
        by_core = [
            tuple(busy_cclk(costs_of(core, row, rows)) for core in cores)
            for cores in zip(*(frame.cores for frame in run.frames), strict=True)
        ]
        yield (row.stage,), tuple(map(max, zip(*by_core, strict=True)))
        for core, values in zip(run.frames[0].cores, by_core, strict=True):
            if any(values):
                yield (row.stage, core.core), values
