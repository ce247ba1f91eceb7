"""The difference of two runs as Markdown, for a comment on a pull request."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from bfsim.report.diff.difference import Difference
from bfsim.report.diff.sentences import clock, reason, verdict, work
from bfsim.report.diff.tables import cells, frames_compared, labelled, seen_lines, shown
from bfsim.report.markdown import escaped

INDENT = "&emsp;"


def diff_markdown(difference: Difference, top: int) -> str:
    """Return the difference with its `top` largest contributions."""
    return "\n".join(_lines(difference, top)) + "\n"


def _lines(difference: Difference, top: int) -> Iterator[str]:
    yield f"**{verdict(difference)}**"
    for why in (clock(difference), work(difference), reason(difference)):
        if why:
            yield f"\n{escaped(why)}"
    if difference.configuration:
        rows = ((each.what, each.before, each.after) for each in difference.configuration)
        yield from _table(("Configuration", "before", "after"), rows)
    yield from contribution_rows(difference, top)
    for each in seen_lines(difference):
        yield f"- {escaped(each)}"


def contribution_rows(difference: Difference, top: int) -> Iterator[str]:
    """Yield the `top` contributions as a table, if there are any."""
    contributions = shown(difference, top)
    if contributions:
        heads = f"Cycles of both cores in {frames_compared(difference)}", "before", "after", "difference"
        yield from _table(
            heads, ((INDENT * depth + labelled(each), *cells(each)) for depth, each in contributions)
        )


def _table(heads: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    yield ""
    yield f"| {' | '.join(heads)} |"
    yield f"| --- |{' ---: |' * (len(heads) - 1)}"
    for row in rows:
        yield f"| {' | '.join(escaped(each) for each in row)} |"
    yield ""
