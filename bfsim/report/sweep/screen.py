"""A sweep on one screen: the best settings, those on the Pareto front, and what failed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from rich.console import RenderableType
from rich.text import Text

from bfsim.errors import cut
from bfsim.report.sweep.figures import FRAME_RATE
from bfsim.report.sweep.front import front
from bfsim.report.sweep.lines import Line, Shown, lines_of
from bfsim.report.tables.table import new_table, stacked
from bfsim.report.wording.units import KIB

FAILURES_SHOWN = 5
NAMES_SHOWN = 3
ON_FRONT = "*"

ONE_FRAME = "With one frame, Hz includes the wait for its picture, and frame does not: run two or more."


def sweep_report(points: Sequence[Shown], files: Sequence[Path], kept: int, top: int) -> RenderableType:
    """Return the results of a sweep, and the files that hold all of them; `kept` points come from earlier."""
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
    """Return names of points with their frames, 0 if unknown, and their states."""
    table = new_table("", "Point", "Frames", "")
    table.columns[0].no_wrap, table.columns[0].overflow = False, "fold"
    table.columns[-1].justify = "left"
    for name, frames, state in points:
        table.add_row(name, str(frames or ""), state)
    return table


def best_table(lines: Sequence[Line], top: int) -> Iterator[RenderableType]:
    """Yield the `top` lines as a table; a star marks those on the front of frame time against memory on the chip."""
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
    """Return the failures, given names and errors: each error once, with some of the names."""
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
