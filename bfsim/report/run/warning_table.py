"""The warnings about a run as a table."""

from __future__ import annotations

from collections.abc import Iterator

from rich.table import Table

from bfsim.report.run.warnings import warnings_of
from bfsim.report.tables.table import new_table
from bfsim.trace import RunRecord


def warning_table(run: RunRecord) -> Iterator[Table]:
    """Yield the warnings, if there are any, in the colour of warnings."""
    warnings = warnings_of(run)
    if warnings:
        table = new_table("Warnings", "About")
        table.title_style, table.style = "bold not italic yellow", "yellow"
        table.add_column("", overflow="fold")
        for each in warnings:
            table.add_row(each.kind, each.text)
        yield table
