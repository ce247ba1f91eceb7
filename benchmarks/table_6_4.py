"""T Table 6.4, the time of each stage: the robot, the firmware `thesis` and today's, on the scenes of its columns. Nothing is fitted.

`python -m benchmarks.table_6_4 FOLDER`: a folder of recordings of `bfsim record render thesis FOLDER`. The range is that of the clocks
that the robot's module is known to have been run with (HARDWARE: CM-BF561 from 500/100 to 600/133 MHz); the default is 600/120 MHz.
Shape detection is not the thesis's: see docs/tinyphoon.md for what the firmware `thesis` shares with the built-in one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from statistics import mean, median

import click
from rich.table import Table

from bfsim.report.tables import new_table
from bfsim.run import simulate
from bfsim.terminal import print_report, progress_bar

# T Table 6.4 in ms: the recordings of its columns, and the rows
ROWS = (
    "Edge detection",
    "Open & closing",
    "Blob detection",
    "Line detection",
    "Shape detection",
    "Object detection",
)
COLUMNS: Mapping[str, tuple[str, tuple[float, ...], float]] = {
    "ball-beside-goal": ("Figure 6.7", (89, 26, 70, 20, 19, 1), 225),
    "hidden-ball": ("Figure 6.10, top row", (89, 26, 75, 22, 18, 1), 231),
    "ball-too-close": ("Figure 6.13", (85, 27, 60, 15, 18, 1), 206),
}
DEFAULT = "cm-bf561"
OTHERS = ("cm-bf561-ratings", "cm-bf561-500-125", "cm-bf561-550-110", "cm-bf561-500-100")
FRAME = "Frame"

Times = dict[str, float]


def times(recording: Path, firmware: str, board: str, frames: int) -> Times:
    """Return core A's median ms of each row, and of the frame without the wait for the first picture."""
    run = simulate(recording, firmware=firmware, board=board, frames=frames)
    per_ms = run.identity.cclk_hz / 1e3
    of_frames = [
        {each.stage: each.elapsed_cclk / per_ms for each in frame.cores[0].stages} for frame in run.frames
    ]
    found = {row: median(each[row] for each in of_frames) for row in ROWS}
    return {**found, FRAME: sum(found.values())}


def table_of(title: str, robot: Times, by_board: Mapping[str, Times], today: Times) -> Table:
    """Return one column of the thesis's table as a table."""
    table = new_table(title, "ms of core A")
    for name in ("robot", "thesis", "from", "to", "thesis / robot", "tinyphoon", "robot / tinyphoon"):
        table.add_column(name, justify="right")
    for row in (*ROWS, FRAME):
        default = by_board[DEFAULT][row]
        ends = [each[row] for each in by_board.values()]
        table.add_row(
            row,
            f"{robot[row]:.0f}",
            f"{default:.1f}",
            f"{min(ends):.1f}",
            f"{max(ends):.1f}",
            f"{default / robot[row]:.2f}",
            f"{today[row]:.1f}",
            f"{robot[row] / today[row]:.1f}",
        )
    return table


def mean_of(several: list[Times]) -> Times:
    """Return the mean of each row."""
    return {row: mean(each[row] for each in several) for row in several[0]}


def measured(folder: Path, frames: int) -> Iterator[tuple[str, Times, dict[str, Times], Times]]:
    """Yield of each column its title, the robot's times, those of the firmware `thesis` by board, and today's."""
    boards = (DEFAULT, *OTHERS)
    done, total = 0, len(COLUMNS) * (len(boards) + 1)
    with progress_bar("simulating") as tell:
        for name, (title, cells, frame) in COLUMNS.items():
            recording = folder / f"{name}.mcap"
            by_board: dict[str, Times] = {}
            for board in boards:
                by_board[board] = times(recording, "thesis", board, frames)
                done += 1
                tell(done, total)
            today = times(recording, "tinyphoon", DEFAULT, frames)
            done += 1
            tell(done, total)
            yield title, {**dict(zip(ROWS, cells, strict=True)), FRAME: frame}, by_board, today


@click.command(help=__doc__)
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--frames", type=click.IntRange(min=1), default=3, show_default=True, help="Of each scene.")
def main(folder: Path, frames: int) -> None:
    """Print the tables."""
    columns = list(measured(folder, frames))
    tables = [table_of(*each) for each in columns]
    robots, by_boards, todays = ([each[part] for each in columns] for part in (1, 2, 3))
    average = {board: mean_of([each[board] for each in by_boards]) for board in by_boards[0]}
    tables.append(table_of("Average", mean_of(robots), average, mean_of(todays)))
    for each in tables:
        print_report(each)


if __name__ == "__main__":
    main()
