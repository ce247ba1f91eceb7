"""Boards as rich tables: all of them, one line each, and every number of one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from rich.console import RenderableType
from rich.table import Table

from bfsim.report.tables.table import new_table, stacked

Rows = Sequence[Mapping[str, str]]
"""Rows of one table, cells by column names, the same in all rows. An empty first name: no heads at all."""


def boards_report(boards: Rows) -> RenderableType:
    """Return the table of all boards; the last column is text."""
    table = _table("Boards", boards)
    table.padding = (0, 1, 0, 0)
    table.columns[-1].justify = "left"
    table.columns[-1].overflow = "fold"
    return stacked(table)


def board_report(title: str, blocks: Iterable[tuple[str, Rows]]) -> RenderableType:
    """Return a table for each block of a board under the board's title."""
    return stacked(title, *(_table(name, rows) for name, rows in blocks))


def _table(title: str, rows: Rows) -> Table:
    first, *others = rows[0]
    table = new_table(title, first, *others)
    table.show_header = bool(first)
    for row in rows:
        table.add_row(*row.values())
    return table
