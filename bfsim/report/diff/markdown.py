"""The difference of two runs as Markdown, for a comment on a pull request."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from bfsim.report.diff.cells import all_row, cells, frame_heads, frame_rows, in_short, labelled, listed
from bfsim.report.diff.difference import Change, Difference
from bfsim.report.diff.rows import shown
from bfsim.report.diff.scope import frames_compared, scope, seen_lines
from bfsim.report.diff.sentences import verdict, why
from bfsim.report.diff.tables import RESULTS_LISTED
from bfsim.report.wording.markdown import escaped
from bfsim.report.wording.units import others_row

INDENT = "&emsp;"
TEXT, NUMBER = "---", "---:"
"""Alignment of columns of words, and of numbers."""


def diff_markdown(difference: Difference, top: int) -> str:
    """Return the difference with its `top` largest contributions."""
    return "\n".join(_lines(difference, top)) + "\n"


def _lines(difference: Difference, top: int) -> Iterator[str]:
    yield f"**{verdict(difference)}**"
    for each in (*why(difference), *scope(difference)):
        yield f"\n{escaped(each)}"
    yield from _changes("Configuration", [*in_short(difference.configuration)])
    yield from contribution_rows(difference, top)
    if difference.changed_frames:
        title, _, *heads = frame_heads(difference)
        yield from _table((title, *heads), NUMBER, frame_rows(difference))
    yield from _changes("Published numbers, all frames together", difference.results, RESULTS_LISTED)
    for each in seen_lines(difference):
        yield f"- {escaped(each)}"


def contribution_rows(difference: Difference, top: int) -> Iterator[str]:
    """Yield the `top` contributions as a table, if there are any."""
    contributions = shown(difference, top)
    if contributions:
        heads = f"Cycles of all cores in {frames_compared(difference)}", "before", "after", "difference"
        rows = ((INDENT * depth + labelled(each), *cells(each)) for depth, each in contributions)
        yield from _table(heads, NUMBER, (*rows, all_row(difference)))


def _changes(title: str, changes: Sequence[Change], most: int | None = None) -> Iterator[str]:
    """Yield the changes as a table, if there are any: the first ones, and how many others."""
    if changes:
        rows = [(each.what, listed(each.before), listed(each.after)) for each in changes[:most]]
        others = len(changes) - len(rows)
        more = [(others_row(others), "", "")] if others else []
        yield from _table((title, "before", "after"), TEXT, [*rows, *more])


def _table(heads: Sequence[str], column: str, rows: Iterable[Sequence[str]]) -> Iterator[str]:
    yield ""
    yield f"| {' | '.join(map(escaped, heads))} |"
    yield f"| {' | '.join([TEXT, *[column] * (len(heads) - 1)])} |"
    for row in rows:
        yield f"| {' | '.join(map(escaped, row))} |"
    yield ""
