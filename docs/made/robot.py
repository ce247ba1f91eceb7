"""Put into the page beside the robot, and that of the accuracy, what the scripts of T Table 6.4 find: `python docs/made/robot.py FOLDER`, after a change of any cycle.

FOLDER: recordings of `bfsim record render thesis FOLDER`. Needs mitsuba, and some twenty-five minutes.
"""

from __future__ import annotations

import sys
from pathlib import Path

from blocks import DOCS, put, table

from benchmarks.robot.claims import claims
from benchmarks.robot.reach import in_a_sentence, reaches
from benchmarks.robot.readings import measured
from benchmarks.robot.unknowns import HEADS, unknowns
from benchmarks.robot.unknowns import cells as open_cells
from benchmarks.table_6_4 import (
    FRAME,
    LEAST_FRAMES,
    PREDICTED,
    ROWS,
    Column,
    cells,
    in_words,
    measured_columns,
)

PAGE, ACCURACY = DOCS / "robot.md", DOCS / "accuracy.md"


def of_column(column: Column) -> str:
    """Return the table of a column under its title."""
    rows = ([row, *cells(column, row)] for row in (*ROWS, FRAME))
    return f"**{column.title}**\n\n" + table(["row", *PREDICTED], rows)


def of_the_mean(column: Column) -> str:
    """Return what the page of the accuracy has: the mean of the scenes, nothing fitted and fitted."""
    rows = (
        (row, f"{found / column.robot[row]:.2f}", f"{column.fitted[row] / column.robot[row]:.2f}")
        for row, found in column.default.items()
    )
    return table(
        ["mean of three scenes, relative to the robot", "nothing fitted", "fitted to one of them"], rows
    )


def main(folder: Path) -> None:
    """Write all tables."""
    short = [row.split()[0] for row in (*ROWS, FRAME)]
    rows = ([title, *(f"{found[row]:.1f}" for row in (*ROWS, FRAME))] for title, found in measured(folder))
    put(PAGE, "readings", table(["", *short], rows))
    setting, columns = measured_columns(folder, LEAST_FRAMES)
    put(PAGE, "scenes", "\n\n".join(map(of_column, columns)))
    put(ACCURACY, "robot", of_the_mean(columns[-1]))
    put(PAGE, "fit", f"Fitted to Figure 6.7: {in_words(setting)}.")
    put(PAGE, "reach", in_a_sentence(reaches(folder)))
    variants = ([title, *open_cells(share, found)] for title, share, found in unknowns())
    put(PAGE, "unknowns", table(["", *HEADS], variants))
    put(PAGE, "claims", table(["", "robot", "`thesis`"], claims(folder)))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
