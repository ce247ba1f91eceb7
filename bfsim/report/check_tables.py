"""The outcome of a check as text and rich tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.check import Check, Quantity, Verdict
from bfsim.report.tables import new_table, stacked, warning_table
from bfsim.trace import RunRecord


def check_report(check: Check, run: RunRecord) -> RenderableType:
    """Return what the check of a run found: the broken limits first, then what became better, then the run's warnings."""
    broken = [verdict for verdict in check.verdicts if verdict.broken]
    better = [verdict for verdict in check.verdicts if verdict.better]
    return stacked(
        Text("\n".join(_lines(check, broken, better))), *_tables(broken, better), *warning_table(run)
    )


def _lines(check: Check, broken: Sequence[Verdict], better: Sequence[Verdict]) -> Iterator[str]:
    if broken:
        yield f"FAILED: {len(broken)} of {len(check.verdicts)} limits broken."
    else:
        yield f"Passed: all {len(check.verdicts)} limits kept."
    if better:
        yield f"{len(better)} better than the baseline; --update makes them the new limits."
    yield from check.notes


def _tables(broken: Sequence[Verdict], better: Sequence[Verdict]) -> Iterator[Table]:
    if broken:
        yield _verdict_table(
            "Broken limits (rows in cycles)", "Limit", [(each, each.limit) for each in broken]
        )
    if better:
        yield _verdict_table(
            "Better than the baseline (rows in cycles)",
            "Baseline",
            [(each, each.baseline) for each in better],
        )


def _verdict_table(title: str, reference: str, verdicts: Sequence[tuple[Verdict, float]]) -> Table:
    table = new_table(title, "Core", "Row", "What", reference, "Measured", "By", "%")
    table.columns[1].justify = table.columns[2].justify = "left"
    for verdict, value in verdicts:
        digits = ".6f" if verdict.quantity is Quantity.FRAME_RATE else ".0f"
        difference = verdict.measured - value
        table.add_row(
            verdict.core,
            verdict.row,
            verdict.quantity,
            f"{value:,{digits}}",
            f"{verdict.measured:,{digits}}",
            f"{difference:+,{digits}}",
            f"{100 * difference / value:+.2f}" if value else "",
        )
    return table
