"""A table that is printed in pieces, rather than without some of its columns, if the terminal is too narrow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.table import Column, Table

LEAST_NAME, LEAST_TEXT = 24, 12
"""The least width to which names may be cut, and texts folded, if that keeps a table together."""


class SplitTable(Table):
    """A rich table whose right-hand columns follow below if they do not fit; its first column is in every piece."""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the table, or its pieces with an empty line between them."""
        pieces = list(self._pieces(console, options))
        has_text = any(not column.no_wrap and column.justify != "right" for column in self.columns[1:])
        whole = sum(self._gap + _width(each, console, options) for each in self.columns) - self._gap
        if len(pieces) == 1 and (has_text or whole <= options.max_width):
            yield from super().__rich_console__(console, options)
            return
        for number, (name_width, columns) in enumerate(pieces):
            piece = self._piece(name_width, columns)
            piece.title = None if number else self.title
            piece.caption = self.caption if number == len(pieces) - 1 else None
            yield from ("", piece) if number else (piece,)

    @property
    def _gap(self) -> int:
        """Blanks between two columns."""
        _, right, _, left = self.padding
        return left + 1 + right

    def _pieces(self, console: Console, options: ConsoleOptions) -> Iterator[tuple[int, list[Column]]]:
        """Yield the columns of each piece, as many as fit beside the first one, and their width."""
        name = min(_width(self.columns[0], console, options), LEAST_NAME)
        taken: list[Column] = []
        left = options.max_width
        for column in self.columns[1:]:
            may_fold = not column.no_wrap and column.justify != "right"
            width = self._gap + (LEAST_TEXT if may_fold else _width(column, console, options))
            if taken and width > left - name:
                yield left, taken
                taken, left = [], options.max_width
            taken.append(column)
            left -= width
        yield max(left, 1), taken

    def _piece(self, name_width: int, columns: list[Column]) -> Table:
        piece = Table(box=self.box, show_edge=self.show_edge, pad_edge=self.pad_edge, padding=self.padding)
        piece.title_style, piece.title_justify, piece.style = self.title_style, self.title_justify, self.style
        piece.caption_justify = self.caption_justify
        piece.columns = [
            replace(each, _index=number) for number, each in enumerate((self.columns[0], *columns))
        ]
        piece.columns[0].max_width = name_width
        piece.rows = self.rows
        return piece


def _width(column: Column, console: Console, options: ConsoleOptions) -> int:
    """Return the width of a column that has room for all of its cells; a head may fold between words."""
    roomy = options.update(max_width=1000)
    cells = [Measurement.get(console, roomy, each).maximum for each in column.cells]
    return max(*cells, Measurement.get(console, roomy, column.header).minimum, column.min_width or 0, 0)
