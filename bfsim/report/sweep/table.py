"""The table of a sweep: a row for each point, as CSV and Parquet."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

from bfsim.errors import legible
from bfsim.files.save import growing_file, writing

Cell = str | int | float | None
Row = Mapping[str, Cell]
"""The cells of a point by their columns; a missing one is empty."""
MOST_BITS = 63
"""[Parquet] Bits of a whole number, without its sign."""


def columns_of(rows: Sequence[Row]) -> dict[str, list[Cell]]:
    """Return the columns of all rows in order of appearance; each holds either numbers or text."""
    names = dict.fromkeys(name for row in rows for name in row)
    columns = {name: [row.get(name) for row in rows] for name in names}
    return {name: _of_one_type(cells) for name, cells in columns.items()}


def _of_one_type(cells: list[Cell]) -> list[Cell]:
    """Return cells as whole numbers, floats or text; whole numbers that do not fit into 64 bits make it text."""
    there = [each for each in cells if each is not None]
    kinds = {type(each) for each in there}
    if any(isinstance(each, int) and each.bit_length() > MOST_BITS for each in there):
        kinds.add(str)
    if str in kinds:
        return [None if each is None else legible(str(each)) for each in cells]
    return [None if each is None else float(each) for each in cells] if float in kinds else cells


def csv_of(rows: Sequence[Row]) -> str:
    """Return the table as CSV with a line of names."""
    columns, text = columns_of(rows), io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return text.getvalue()


def write_parquet(path: Path, rows: Sequence[Row]) -> None:
    """Write the table as Parquet. Raises ImportError if pyarrow is not installed."""
    import pyarrow as pa
    from pyarrow import parquet

    table = pa.table(columns_of(rows))
    with growing_file(path) as stream, writing(path):
        parquet.write_table(table, stream)
