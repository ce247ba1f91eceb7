"""Reports as the lines that are printed of them."""

from __future__ import annotations

import io

from rich.console import Console, RenderableType


def printed(report: RenderableType, width: int = 100) -> list[str]:
    """The lines of a report as a file or a pipe gets them, without the blanks at their ends."""
    console = Console(file=io.StringIO(), width=width, markup=False, emoji=False, highlight=False)
    console.print(report)
    assert isinstance(console.file, io.StringIO)
    return [line.rstrip() for line in console.file.getvalue().splitlines()]


def row_of(lines: list[str], begin: str) -> str:
    """The first line that begins so."""
    return next(line for line in lines if line.startswith(begin))


def squeezed(line: str) -> str:
    """A line of a table with single blanks, so that tests do not depend on column widths."""
    return " ".join(line.split())
