"""T Table 6.4, the time of each stage: the robot, the firmware `thesis` and today's, on the scenes of its columns.

`python -m benchmarks.table_6_4 FOLDER`: a folder of recordings of `bfsim record render thesis FOLDER`.

First nothing is fitted: the default is the board cm-bf561, and low and high are what the ranges of HARDWARE make of
each row: the least and the most with any clocks that such modules are known to have been run with, and every latency at
the end of its range. Then three numbers are fitted to the column of Figure 6.7 alone: the clocks, the way of a core's
read to the SDRAM and back, and what it takes to open a row there. What they make of the other columns is a prediction.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import count, product
from math import log
from pathlib import Path
from statistics import mean, median
from typing import Any, TypeVar

import click

from bfsim.api import Firmware
from bfsim.process.terminal import print_report, progress_bar
from bfsim.report.tables.table import new_table
from bfsim.run import simulate

# T Table 6.4 in ms: the recordings of its columns, and the rows
ROWS = (
    "Edge detection",
    "Open & closing",
    "Blob detection",
    "Line detection",
    "Shape detection",
    "Object detection",
)
COLUMNS: Mapping[str, tuple[str, tuple[float, ...]]] = {
    "ball-beside-goal": ("Figure 6.7", (89, 26, 70, 20, 19, 1)),
    "ball-beside-robot": ("Figure 6.10, top row", (89, 26, 75, 22, 18, 1)),
    "ball-too-close": ("Figure 6.13", (85, 27, 60, 15, 18, 1)),
}
FITTED = "ball-beside-goal"
FRAME = "Frame"

COMPILER = "vdsp-O2"
"""An estimate of what compiled the robot's firmware: VisualDSP (T 5.1.3)."""
DEFAULT = "cm-bf561"
CLOCKS = (DEFAULT, "cm-bf561-525-131", "cm-bf561-500-125", "cm-bf561-550-110", "cm-bf561-500-100")
"""Boards that differ by their clocks: HARDWARE 2.1."""

FASTEST, SLOWEST = CLOCKS[:2], CLOCKS[-1:]
"""Those of them that no other one is faster than, or slower than, in both clocks."""

LATENCIES: Mapping[str, tuple[int, int]] = {
    "chip.external.core_sync_sclk": (4, 7),
    "chip.external.store_buffer": (8, 4),
    "chip.l2.read_cclk": (7, 11),
    "chip.l2.next_cclk": (1, 2),
    "chip.dma.fifo_words": (8, 4),
    "chip.dma.startup_sclk": (10, 20),
    "chip.events.mmr_read_cclk": (10, 30),
    "sdram.nRCD": (2, 3),  # the board's boot code, and that of the EZ-KIT
    "sdram.nRP": (2, 3),
}
"""The fast and the slow end of the ranges of HARDWARE 0 and 2.3."""

LEAST_FRAMES = 3
"""Of a scene, for one to be `timed`."""

Times = dict[str, float]
Tell = Callable[[], None]
Frame = TypeVar("Frame")


@dataclass(frozen=True, slots=True)
class Setting:
    """A board and numbers to change in it."""

    board: str
    numbers: Mapping[str, int]


FAST, SLOW = ({path: ends[end] for path, ends in LATENCIES.items()} for end in (0, 1))
LOW = tuple(Setting(board, FAST) for board in FASTEST)
HIGH = tuple(Setting(board, SLOW) for board in SLOWEST)
PLAIN = Setting(DEFAULT, {})
GRID = tuple(
    Setting(board, {"chip.external.core_sync_sclk": sync, "sdram.nRCD": opening, "sdram.nRP": opening})
    for board, sync, opening in product(CLOCKS, range(4, 8), (2, 3))
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """A column of the table: the robot's times, those of the firmware `thesis` within its range, today's, and what the fit makes."""

    title: str
    robot: Times
    low: Times
    default: Times
    high: Times
    fitted: Times
    today: Times


PREDICTED = (
    "robot",
    "low",
    "`thesis`",
    "high",
    "/ robot",
    "fitted",
    "/ robot",
    "`tinyphoon`",
    "robot / `tinyphoon`",
)
"""Titles of `cells`."""


def timed(frames: Sequence[Frame]) -> Sequence[Frame]:
    """Return the frames to be timed: not the first, which knows no objects yet, nor the last, beside which no next picture comes in.

    Of fewer than three, all.
    """
    return frames[1:-1] or frames


def times(
    recording: Path | None,
    firmware: Firmware | str,
    setting: Setting = PLAIN,
    frames: int | None = LEAST_FRAMES,
    **options: Any,
) -> Times:
    """Return core A's median ms of each row in the frames that are `timed`, and the sum of these."""
    board, numbers = setting.board, setting.numbers
    run = simulate(
        recording,
        firmware=firmware,
        board=board,
        settings=numbers,
        frames=frames,
        **{"profile": COMPILER, **options},
    )
    per_ms = run.identity.cclk_hz / 1e3
    row_of = {each.stage: each.within or each.stage for each in run.rows}
    measured = timed(run.frames)
    found: dict[str, list[float]] = {row: [0.0] * len(measured) for row in ROWS}
    for number, frame in enumerate(measured):
        for each in frame.cores[0].stages:
            if each.stage in row_of:
                found[row_of[each.stage]][number] += each.elapsed_cclk / per_ms
    medians = {row: median(each) for row, each in found.items()}
    return {**medians, FRAME: sum(medians.values())}


def robot_times(cells: Sequence[float]) -> Times:
    """Return a column of the thesis; the frame is the sum of its rows there, too."""
    return {**dict(zip(ROWS, cells, strict=True)), FRAME: sum(cells)}


def error(found: Times, robot: Times) -> float:
    """Return what the fit makes least: the squares of the logarithms of the rows by the robot's, but for the object detection."""
    return sum(log(found[row] / robot[row]) ** 2 for row in ROWS[:-1])


def fit(folder: Path, tell: Tell) -> Setting:
    """Return the setting of `GRID` that fits the column of `FITTED` best."""
    robot = robot_times(COLUMNS[FITTED][1])
    errors = []
    for setting in GRID:
        errors.append(error(times(folder / f"{FITTED}.mcap", "thesis", setting), robot))
        tell()
    return GRID[errors.index(min(errors))]


def ends(several: Sequence[Times], end: Callable[[Iterable[float]], float]) -> Times:
    """Return the least, the most or the mean of each row."""
    return {row: end(each[row] for each in several) for row in several[0]}


def column(folder: Path, name: str, fitted: Setting, frames: int, tell: Tell) -> Column:
    """Return one column."""

    def measured(firmware: str, setting: Setting) -> Times:
        found = times(folder / f"{name}.mcap", firmware, setting, frames)
        tell()
        return found

    title, cells = COLUMNS[name]
    return Column(
        title=title,
        robot=robot_times(cells),
        low=ends([measured("thesis", each) for each in LOW], min),
        default=measured("thesis", PLAIN),
        high=ends([measured("thesis", each) for each in HIGH], max),
        fitted=measured("thesis", fitted),
        today=measured("tinyphoon", PLAIN),
    )


def average(columns: Sequence[Column]) -> Column:
    """Return the mean of columns."""
    parts = (each.name for each in fields(Column) if each.name != "title")
    return Column(
        title="Average",
        **{part: ends([getattr(each, part) for each in columns], mean) for part in parts},
    )


def cells(each: Column, row: str) -> tuple[str, ...]:
    """Return a row of a column's table."""
    robot, default, fitted, today = (
        times[row] for times in (each.robot, each.default, each.fitted, each.today)
    )
    return (
        f"{robot:.0f}",
        f"{each.low[row]:.1f}",
        f"{default:.1f}",
        f"{each.high[row]:.1f}",
        f"{default / robot:.2f}",
        f"{fitted:.1f}",
        f"{fitted / robot:.2f}",
        f"{today:.1f}",
        f"{robot / today:.1f}",
    )


def in_words(setting: Setting) -> str:
    """Return a fitted setting."""
    return f"{setting.board}, {', '.join(f'{path} {value}' for path, value in setting.numbers.items())}"


def measured_columns(folder: Path, frames: int) -> tuple[Setting, list[Column]]:
    """Return the fitted setting, and all columns, their mean last."""
    total = len(GRID) + len(COLUMNS) * (len(LOW) + len(HIGH) + 3)
    with progress_bar("simulating") as show:
        done = count(1)

        def tell() -> None:
            show(next(done), total)

        setting = fit(folder, tell)
        columns = [column(folder, name, setting, frames, tell) for name in COLUMNS]
    return setting, [*columns, average(columns)]


@click.command(help=__doc__)
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option(
    "--frames",
    type=click.IntRange(min=LEAST_FRAMES),
    default=LEAST_FRAMES,
    show_default=True,
    help="Of each scene.",
)
def main(folder: Path, frames: int) -> None:
    """Print the tables."""
    setting, columns = measured_columns(folder, frames)
    for each in columns:
        table = new_table(each.title, "ms of core A", *(title.replace("`", "") for title in PREDICTED))
        for row in (*ROWS, FRAME):
            table.add_row(row, *cells(each, row))
        print_report(table)
    print_report(f"Fitted to Figure 6.7 alone: {in_words(setting)}")


if __name__ == "__main__":
    main()
