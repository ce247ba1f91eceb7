"""Put into the page beside the robot what the scripts of T Table 6.4 find: `python docs/made/robot.py FOLDER`, after a change of any cycle.

FOLDER: recordings of `bfsim record render thesis FOLDER`. Needs mitsuba, and some five minutes.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.robot.claims import claims
from benchmarks.robot.readings import measured
from benchmarks.table_6_4 import FRAME, PREDICTED, ROWS, Column, cells, in_words, measured_columns

PAGE = Path(__file__).parent.parent / "robot.md"
FRAMES = 2


def table(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table: names on the left, numbers to the right."""
    lines = [titles, ["---", *("--:" for _ in titles[1:])], *rows]
    return "\n".join(f"| {' | '.join(each)} |" for each in lines)


def of_column(column: Column) -> str:
    """Return the table of a column under its title."""
    rows = ([row, *cells(column, row)] for row in (*ROWS, FRAME))
    return f"**{column.title}**\n\n" + table(["row", *PREDICTED], rows)


def put(name: str, text: str) -> None:
    """Put a text into the page, between the comments of this name."""
    page, block = PAGE.read_text(), f"(<!-- {name}: made by docs/made/robot.py -->\n\n).*?(<!-- end -->)"
    changed, found = re.subn(block, lambda each: f"{each[1]}{text}\n\n{each[2]}", page, flags=re.DOTALL)
    assert found == 1
    PAGE.write_text(changed)


def main(folder: Path) -> None:
    """Write all tables."""
    short = [row.split()[0] for row in (*ROWS, FRAME)]
    rows = ([title, *(f"{found[row]:.1f}" for row in (*ROWS, FRAME))] for title, found in measured(folder))
    put("readings", table(["", *short], rows))
    setting, columns = measured_columns(folder, FRAMES)
    put("scenes", "\n\n".join(map(of_column, columns)))
    put("fit", f"Fitted to Figure 6.7: {in_words(setting)}.")
    put("claims", table(["", "robot", "`thesis`"], claims(folder)))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
