"""What tables of reports have in common: their looks, how they are stacked, and shares in percent."""

from __future__ import annotations

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.tables.split_table import SplitTable


def stacked(*parts: RenderableType) -> RenderableType:
    """Return the parts one under the other, with an empty line after each."""
    return Group(*(each for part in parts for each in (part, Text())))


def new_table(title: str, first: str, *numbers: str) -> Table:
    """Return an empty table: a column of names on the left, columns of numbers to the right of it."""
    table = SplitTable(
        title=title,
        title_style="bold not italic",
        title_justify="left",
        min_width=len(title),
        box=box.HORIZONTALS,
        show_edge=False,
        pad_edge=False,
        padding=0,
    )
    table.add_column(first, no_wrap=True, overflow="ellipsis")
    for number in numbers:
        table.add_column(number, justify="right", overflow="ellipsis", min_width=6, vertical="top")
    return table


def notes_table() -> Table:
    """Return a table for names, each with a sentence or two beside it."""
    table = Table.grid(padding=(0, 2))
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    return table


def percent(part: float, whole: float) -> str:
    """Return a share in percent, with one decimal; 0 of 0 is 0."""
    return f"{100 * part / whole:.1f}" if whole else "0.0"
