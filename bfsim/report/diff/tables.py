"""The difference of two runs as rich tables of 80 columns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.diff.cells import all_row, cells, frame_heads, frame_rows, in_short, labelled, listed
from bfsim.report.diff.difference import Change, ContributionKind, Difference
from bfsim.report.diff.rows import shown
from bfsim.report.diff.scope import frames_compared, scope, seen_lines
from bfsim.report.diff.sentences import verdict, why
from bfsim.report.tables.table import new_table, stacked
from bfsim.report.wording.units import others_row

RESULTS_LISTED = 10
"""The number of changed results that are listed."""


def diff_report(difference: Difference, top: int) -> RenderableType:
    """Return the difference: its size, what was compared, the `top` contributions, frames, results and what was seen."""
    return stacked(
        Text("\n".join([verdict(difference), *why(difference), *scope(difference)])),
        *_change_table("What differs in the configuration", "What", [*in_short(difference.configuration)]),
        *contribution_table(difference, top),
        *_frame_table(difference),
        *_change_table(
            "Published numbers, all frames together", "Number", difference.results, RESULTS_LISTED
        ),
        *_seen(difference),
    )


def _change_table(
    title: str, first: str, changes: Sequence[Change], most: int | None = None
) -> Iterator[Table]:
    if changes:
        table = new_table(title, first, "before", "after")
        for column in table.columns[1:]:
            column.justify, column.overflow = "left", "fold"
        for each in changes[:most]:
            table.add_row(each.what, listed(each.before), listed(each.after))
        if most and len(changes) > most:
            table.add_row(others_row(len(changes) - most))
        yield table


def contribution_table(difference: Difference, top: int) -> Iterator[Table]:
    """Yield the `top` contributions as a table, if there are any."""
    rows = shown(difference, top)
    if not rows:
        return
    title = f"Cycles of all cores in {frames_compared(difference)}, the largest difference first"
    table = new_table(title, "Stage / kernel / line / cause", "before", "after", "difference")
    for depth, each in rows:
        bold = (
            "bold"
            if each.kind is ContributionKind.STAGE
            else "dim"
            if each.kind is ContributionKind.FOLLOWS
            else None
        )
        table.add_row("  " * depth + labelled(each), *cells(each), style=bold)
    table.add_section()
    table.add_row(*all_row(difference), style="bold")
    # in a narrow terminal the source text is cut, never a number
    table.expand, table.columns[0].ratio = True, 1
    yield table


def _frame_table(difference: Difference) -> Iterator[Table]:
    if difference.changed_frames:
        table = new_table(*frame_heads(difference))
        for row in frame_rows(difference):
            table.add_row(*row)
        yield table


def _seen(difference: Difference) -> Iterator[Text]:
    if difference.seen:
        yield Text("\n".join(seen_lines(difference)))
