"""A sweep on one screen: the best settings, those on the Pareto front, and what failed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median_low

from rich.console import RenderableType
from rich.text import Text

from bfsim.errors import cut
from bfsim.report.sweep.figures import FRAME_RATE, FRAME_TIME, LATENCY, MISSED, ON_CHIP, WORST_FRAME
from bfsim.report.sweep.front import front
from bfsim.report.sweep.table import Row
from bfsim.report.tables.table import new_table, stacked
from bfsim.report.wording.units import KIB

FAILURES_SHOWN = 5
NAMES_SHOWN = 3
ON_FRONT = "*"
RATE_SHARE = 0.002
"""Rates of firmware that waits for pictures differ by up to so much: by where in a few frames its waits begin and end."""


ONE_FRAME = "Hz of a run of one frame has the wait for its picture in it, frame has not: run two or more."


@dataclass(frozen=True, slots=True)
class Shown:
    """A point: what the setting is called that it is shown as a part of, what it is called, and its row of the table."""

    setting: str
    name: str
    row: Row


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A setting over its recordings: the least frame rate, the median of medians, the most of the rest, all frames missed."""

    name: str
    recordings: int
    frame_rate_hz: float
    frame_ms: float
    worst_ms: float
    latency_ms: float
    on_chip_bytes: float
    missed: float


def sweep_report(points: Sequence[Shown], files: Sequence[Path], kept: int, top: int) -> RenderableType:
    """Return what came out of a sweep, and in which files all of it is; so many points were `kept` from before."""
    done = [each for each in points if FRAME_RATE in each.row]
    errors = [(each.name, str(each.row["error"])) for each in points if each.row["error"]]
    number = f"{len(points):,} point{'s' if len(points) != 1 else ''}"
    counts = [f"{number}: {len(done):,} done" + (f" ({kept:,} of them before)" if kept else "")]
    counts += [f"{len(errors):,} failed"] if errors else []
    rest = len(points) - len(done) - len(errors)
    counts += [f"{rest:,} not yet"] if rest else []
    warned = sum(bool(each.row["warnings"]) for each in done)
    parts: list[RenderableType] = [Text(f"{', '.join(counts)}.")]
    parts += best_table(lines_of(done), top) if done else []
    parts += [Text(failures(errors))] if errors else []
    told = [ONE_FRAME] if any(each.row["frames"] == 1 for each in done) else []
    told += [f"{warned:,} of the points come with warnings: see the column of that name."] if warned else []
    if files:
        told.append(f"All figures of all points: {', '.join(map(str, files))}")
    return stacked(*parts, Text("\n".join(told)))


def point_list(points: Sequence[tuple[str, int, str]]) -> RenderableType:
    """Return names of points with their frames, 0 where nobody knows, and how it stands with them."""
    table = new_table("", "Point", "Frames", "")
    table.columns[0].no_wrap, table.columns[0].overflow = False, "fold"
    table.columns[-1].justify = "left"
    for name, frames, state in points:
        table.add_row(name, str(frames or ""), state)
    return table


def lines_of(points: Iterable[Shown]) -> list[Line]:
    """Return a line for each setting of points that are done; the fastest one first, of those as fast the one with the shortest frames."""
    by_name = defaultdict[str, list[Row]](list)
    for each in points:
        by_name[each.setting].append(each.row)
    lines = [
        Line(
            name=name,
            recordings=len(group),
            frame_rate_hz=min(_numbers(group, FRAME_RATE)),
            frame_ms=median_low(_numbers(group, FRAME_TIME)),
            worst_ms=max(_numbers(group, WORST_FRAME)),
            latency_ms=median_low(_numbers(group, LATENCY)),
            on_chip_bytes=max(_numbers(group, ON_CHIP)),
            missed=sum(_numbers(group, MISSED)),
        )
        for name, group in by_name.items()
    ]
    return list(_ranked(sorted(lines, key=lambda each: -each.frame_rate_hz)))


def _ranked(lines: Sequence[Line]) -> Iterator[Line]:
    """Yield lines that are sorted by their rates with those first that do less, where rates differ no more than by how pictures come."""
    rest = list(lines)
    while rest:
        alike = [each for each in rest if each.frame_rate_hz >= (1 - RATE_SHARE) * rest[0].frame_rate_hz]
        yield from sorted(alike, key=lambda each: each.frame_ms)
        rest = rest[len(alike) :]


def _numbers(rows: Iterable[Row], column: str) -> list[float]:
    return [float(row[column] or 0) for row in rows]


def best_table(lines: Sequence[Line], top: int) -> Iterator[RenderableType]:
    """Yield the `top` lines as a table; a star marks what is on the front of frame time against memory on the chip."""
    starred = {lines[each].name for each in front([(each.frame_ms, each.on_chip_bytes) for each in lines])}
    several = any(each.recordings > 1 for each in lines)
    title = "Least Hz, median and max of frames over all recordings" if several else "Best points"
    heads = ("Hz", "frame", "max", "latency", "KB", "missed", *(("runs",) if several else ()))
    table = new_table(f"{title}; times in ms, KB on the chip", "", *heads)
    table.columns[0].no_wrap = False
    table.columns[0].overflow = "fold"
    for each in lines[:top]:
        table.add_row(
            f"{ON_FRONT if each.name in starred else ' '} {each.name}",
            f"{each.frame_rate_hz:.2f}",
            f"{each.frame_ms:.2f}",
            f"{each.worst_ms:.2f}",
            f"{each.latency_ms:.2f}",
            f"{each.on_chip_bytes / KIB:.1f}",
            f"{each.missed:.0f}",
            *((f"{each.recordings}",) if several else ()),
        )
    notes = [f"{ON_FRONT} nothing else is faster with as little memory on the chip."]
    if len(lines) > top:
        notes.append(f"{len(lines) - top} more are in the table; --top N shows N.")
    yield table
    yield Text("\n".join(notes))


def failures(errors: Iterable[tuple[str, str]]) -> str:
    """Return what failed, given names and errors: each error once, with some of the names."""
    by_error = defaultdict[str, list[str]](list)
    for name, error in errors:
        by_error[error].append(name)
    ranked = sorted(by_error.items(), key=lambda each: -len(each[1]))
    said = [_failure(error, names) for error, names in ranked[:FAILURES_SHOWN]]
    if len(ranked) > FAILURES_SHOWN:
        said.append(f"{len(ranked) - FAILURES_SHOWN} more mistakes are in the table, column error.")
    return "\n".join(said)


def _failure(error: str, names: Sequence[str]) -> str:
    listed = ", ".join(cut(each) for each in names[:NAMES_SHOWN]) + (
        ", …" if len(names) > NAMES_SHOWN else ""
    )
    count = f"{len(names)} points" if len(names) > 1 else "1 point"
    return f"{count} failed ({listed}): {error}"
