"""What T §6.6 says of the robot's times beside Table 6.4, and what the firmware `thesis` makes of it.

`python -m benchmarks.robot.claims FOLDER`: a folder of recordings of `bfsim record render thesis FOLDER`. Needs mitsuba.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import correlation, linear_regression, mean

import click
from rich.table import Table

from benchmarks.robot.recordings import halve
from benchmarks.shape_balls import MOST_BALLS, scene_with
from benchmarks.table_6_4 import COLUMNS, FITTED, FRAME, ROWS, Times, robot_times, times
from bfsim.process.terminal import print_report
from bfsim.recording.scenes.studio import record_scene

PIXEL_ROWS, OTHER_ROWS = ROWS[:3], ROWS[3:]
AREA = [10, 20, 300, 200]
CAMERA_MS = 1000 / 30  # of a frame of the sensor

Claim = tuple[str, str, str]
"""What is claimed, of the robot, and found."""


def in_hz(ms: float) -> str:
    """Return the frame rate of a frame."""
    return f"{1000 / ms:.1f} Hz"


def of_smaller_pictures(whole: Times, smaller: Times) -> Iterator[Claim]:
    """Yield what pictures of 160x120 are worth."""
    robot = {row: mean(robot_times(cells)[row] for _, cells in COLUMNS.values()) for row in (*ROWS, FRAME)}
    yield (
        "160x120",
        "around 12 Hz, nearly 3 times as many",
        f"{in_hz(smaller[FRAME])}, {whole[FRAME] / smaller[FRAME]:.1f} times",
    )
    quarter = sum(robot[row] for row in PIXEL_ROWS) / 4 + sum(robot[row] for row in OTHER_ROWS)
    shares = ", ".join(f"{row.lower()} {smaller[row] / whole[row]:.2f}" for row in ROWS[:-1])
    yield (
        "if its first three rows shrink to a quarter and the others stay",
        in_hz(quarter),
        f"remaining share of each row: {shares}",
    )
    yield (
        "if its rows shrink like ours, and each picture is captured before it is processed",
        in_hz(sum(robot[row] * smaller[row] / whole[row] for row in ROWS) + CAMERA_MS),
        in_hz(smaller[FRAME] + CAMERA_MS),
    )


def of_an_area(whole: Times, area: Times) -> Iterator[Claim]:
    """Yield what an area of interest of 300x200 is worth, and what rates would be if nothing were captured meanwhile."""
    robot = mean(sum(cells) for _, cells in COLUMNS.values())
    gain = whole[FRAME] / area[FRAME]
    yield (
        "an area of 300x200",
        "above 5 Hz",
        f"{in_hz(area[FRAME])}, {gain:.2f} times; the robot's frame would be {in_hz(robot / gain)}",
    )
    yield (
        "320x240, and an area of 300x200, if each picture is captured before it is processed",
        "4.5 Hz, above 5 Hz",
        f"from the robot's frame {in_hz(robot + CAMERA_MS)}, {in_hz(robot / gain + CAMERA_MS)}",
    )


def of_balls(folder: Path) -> Claim:
    """Return what each ball more in the picture takes."""
    found = []
    for balls in range(1, MOST_BALLS + 1):
        path = folder / f"{balls}.mcap"
        record_scene(scene_with(balls), path)
        found.append(times(path, "thesis")["Shape detection"])
    numbers = range(1, MOST_BALLS + 1)
    slope, none = linear_regression(numbers, found)
    return (
        "shape detection rises linearly and significantly with the number of balls",
        "said",
        f"{none:.1f} ms and {slope:.2f} ms a ball, R² {correlation(numbers, found) ** 2:.3f} for 1 to {MOST_BALLS}",
    )


def of_content(columns: dict[str, Times]) -> Claim:
    """Return how rows differ between the scenes."""

    def spread(several: list[Times], row: str) -> str:
        of_row = [each[row] for each in several]
        return f"{row.lower()} {min(of_row):.0f} to {max(of_row):.0f}"

    robots = [robot_times(cells) for _, cells in COLUMNS.values()]
    return (
        "content mostly changes the time of lines and shapes",
        "; ".join(spread(robots, row) for row in ROWS[:-1]),
        "; ".join(spread(list(columns.values()), row) for row in ROWS[:-1]),
    )


def claims(folder: Path) -> Iterator[Claim]:
    """Yield each claim."""
    columns = {name: times(folder / f"{name}.mcap", "thesis") for name in COLUMNS}
    whole, recording = columns[FITTED], folder / f"{FITTED}.mcap"
    with tempfile.TemporaryDirectory() as name:
        temporary = Path(name)
        halve(recording, temporary / "smaller.mcap")
        yield from of_smaller_pictures(whole, times(temporary / "smaller.mcap", "thesis"))
        script = temporary / "area.json"
        script.write_text(json.dumps({"send": [{"mode": {"area": AREA}}]}))
        yield from of_an_area(whole, times(recording, "thesis", script=script))
        yield of_balls(temporary)
    yield of_content(columns)


@click.command(help=__doc__)
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
def main(folder: Path) -> None:
    """Print the table."""
    table = Table("T §6.6", "robot", "`thesis`", box=None)
    for each in claims(folder):
        table.add_row(*each)
    print_report(table)


if __name__ == "__main__":
    main()
