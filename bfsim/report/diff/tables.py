"""The difference of two runs as rich tables of 80 columns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.diff.difference import Change, Contribution, ContributionKind, Difference
from bfsim.report.diff.rows import shown
from bfsim.report.diff.sentences import verdict, why
from bfsim.report.diff.side import SEPARATOR
from bfsim.report.tables.table import new_table, stacked
from bfsim.report.wording.units import counted, others_row

CHANGED_LISTED = 5
"""Frames that changed most which are listed."""

RESULTS_LISTED = 10
"""Published numbers that changed which are listed."""

CHANGED_ALIKE = 3
"""So many things that went from the same to the same have a row each."""

FILES_LISTED = 6
"""So many files, or numbers of a board, are listed of each side."""


def diff_report(difference: Difference, top: int) -> RenderableType:
    """Return the difference: what it is, what was compared, the `top` contributions, frames, results and what was seen."""
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


def scope(difference: Difference) -> Iterator[str]:
    """Yield what is to be known of frames that are not the same."""
    if difference.measured_frames != len(difference.frames):
        yield (
            f"The first side is of {difference.measured_frames} frames, the second of {len(difference.frames)}: cycles of "
            "the first are in proportion."
        )
    if not difference.has_lines:
        yield (
            f"The runs do not have the same frames: {len(difference.frames)} are in both, and cycles are of these, "
            "without source lines."
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


def in_short(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes; more than a few from the same to the same, as of buffers that lie elsewhere, as one."""
    alike: dict[tuple[str, str], list[Change]] = {}
    for each in changes:
        alike.setdefault((each.before, each.after), []).append(each)
    for same in alike.values():
        if len(same) <= CHANGED_ALIKE:
            yield from same
        else:
            yield replace(same[0], what=f"{same[0].what} and {len(same) - 1} others")


def listed(text: str) -> str:
    """Return a list with its first few words, and how many others there are; other text as it is."""
    words = text.split(SEPARATOR)
    others = len(words) - FILES_LISTED
    return f"{SEPARATOR.join(words[:FILES_LISTED])} and {others} others" if others > 1 else text


def contribution_table(difference: Difference, top: int) -> Iterator[Table]:
    """Yield the `top` contributions as a table, if there are any."""
    rows = shown(difference, top)
    if not rows:
        return
    title = f"Cycles of both cores in {frames_compared(difference)}, the largest difference first"
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
    # where room is short the source text gives way, never a number
    table.expand, table.columns[0].ratio = True, 1
    yield table


def all_row(difference: Difference) -> tuple[str, str, str, str]:
    """Return what all contributions sum to."""
    before, after = counted(difference.before_cclk), counted(difference.after_cclk)
    return "All", before, after, counted(difference.cclk, sign=True)


def frames_compared(difference: Difference) -> str:
    """Return how many frames are compared."""
    count = len(difference.frames)
    return f"{count} frame{'s' if count > 1 else ''}"


def labelled(contribution: Contribution) -> str:
    """Return what a contribution is called, with its place."""
    if contribution.kind is ContributionKind.LINE:
        return f"{contribution.place.rpartition(':')[2]}  {contribution.name}"
    return f"{contribution.name} ({contribution.place})" if contribution.place else contribution.name


def cells(contribution: Contribution) -> tuple[str, str, str]:
    """Return the cycles before, after, and more than before."""
    before, after = (
        "" if each is None else counted(each) for each in (contribution.before_cclk, contribution.after_cclk)
    )
    return before, after, counted(contribution.cclk, sign=True)


def _frame_table(difference: Difference) -> Iterator[Table]:
    if difference.changed_frames:
        table = new_table(*frame_heads(difference))
        for row in frame_rows(difference):
            table.add_row(*row)
        yield table


def frame_heads(difference: Difference) -> tuple[str, ...]:
    """Return the title of a table of `frame_rows`, and the heads of its columns."""
    title = f"Frames that changed most, of {len(difference.changed_frames)} (cycles of the slower core)"
    return title, "Frame", "before", "after", "difference"


def frame_rows(difference: Difference) -> Iterator[tuple[str, str, str, str]]:
    """Yield the frames that changed most with their cycles before, after, and more than before."""
    for each in difference.changed_frames[:CHANGED_LISTED]:
        more = each.after_cclk - each.before_cclk
        yield str(each.index), f"{each.before_cclk:,}", f"{each.after_cclk:,}", f"{more:+,}"


def _seen(difference: Difference) -> Iterator[Text]:
    if difference.seen:
        yield Text("\n".join(seen_lines(difference)))


def seen_lines(difference: Difference) -> Iterator[str]:
    """Yield sentences about what only one of the runs saw."""
    for each in difference.seen:
        frames = f"{each.frames} frame{'s' if each.frames > 1 else ''}, first in {each.first}"
        yield f"{each.name}: {'seen before, not any more' if each.gone else 'seen now, not before'}, in {frames}"
