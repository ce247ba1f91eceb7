"""How near the robot any fit could come: the best of all settings of its grid, with all columns seen.

`python -m benchmarks.robot.reach FOLDER`: a folder of recordings of `bfsim record render thesis FOLDER`. Some five minutes.

A fit sees one column and predicts the others. If no setting has the others as near as they are wanted, none that a fit may choose has.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from benchmarks.table_6_4 import (
    COLUMNS,
    FITTED,
    FRAME,
    GRID,
    ROWS,
    Setting,
    Times,
    in_words,
    robot_times,
    times,
)
from bfsim.process.terminal import progress_bar

PREDICTED = tuple(each for each in COLUMNS if each != FITTED)


@dataclass(frozen=True, slots=True)
class Reach:
    """What the rows of `PREDICTED` are by the robot's, without object detection, and the frames, at a setting."""

    setting: Setting
    rows: tuple[float, ...]
    frames: tuple[float, ...]

    @classmethod
    def of(cls, setting: Setting, found: dict[str, Times]) -> Reach:
        """Return it from the times of each column."""
        by_robot = {
            name: {row: each / robot[row] for row, each in found[name].items()}
            for name, robot in ((name, robot_times(COLUMNS[name][1])) for name in PREDICTED)
        }
        rows = tuple(each[row] for each in by_robot.values() for row in ROWS[:-1])
        return cls(setting, rows, tuple(each[FRAME] for each in by_robot.values()))

    @property
    def farthest_row(self) -> float:
        """How far the worst row is off, of one."""
        return max(abs(each - 1) for each in self.rows)

    @property
    def farthest_frame(self) -> float:
        """How far the worse frame is off, of one."""
        return max(abs(each - 1) for each in self.frames)


def reaches(folder: Path) -> list[Reach]:
    """Return that of every setting of the grid."""
    found = []
    with progress_bar("simulating") as show:
        for number, setting in enumerate(GRID):
            columns = {name: times(folder / f"{name}.mcap", "thesis", setting) for name in PREDICTED}
            found.append(Reach.of(setting, columns))
            show(number + 1, len(GRID))
    return found


def in_a_sentence(found: list[Reach]) -> str:
    """Say what is nearest in its rows, and in its frames."""
    by_rows, by_frames = (
        min(found, key=lambda each: each.farthest_row),
        min(found, key=lambda each: each.farthest_frame),
    )
    return (
        f"Of the {len(found)} settings, {in_words(by_rows.setting)} comes closest in the rows of the other two columns: the worst is "
        f"{by_rows.farthest_row:.0%} off, and the frames are {' and '.join(f'{each:.2f}' for each in by_rows.frames)} of the robot's. "
        f"The closest frames, {' and '.join(f'{each:.2f}' for each in by_frames.frames)}, come with a row that is {by_frames.farthest_row:.0%} off."
    )


@click.command(help=__doc__)
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
def main(folder: Path) -> None:
    """Print the sentence."""
    click.echo(in_a_sentence(reaches(folder)))


if __name__ == "__main__":
    main()
