"""The cells of a difference's rows, on the screen, in Markdown and on a page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from bfsim.report.diff.difference import Change, Contribution, ContributionKind, Difference
from bfsim.report.diff.side import SEPARATOR
from bfsim.report.wording.units import counted

CHANGED_LISTED = 5
"""The number of frames that are listed, those that changed most."""

CHANGED_ALIKE = 3
"""The most changes between the same two values that have a row each."""

FILES_LISTED = 6
"""The number of files, or of a board's numbers, that are listed for each side."""


def in_short(changes: Sequence[Change]) -> Iterator[Change]:
    """Yield the changes; if many are between the same two values, such as buffers that moved, merge them into one."""
    alike: dict[tuple[str, str], list[Change]] = {}
    for each in changes:
        alike.setdefault((each.before, each.after), []).append(each)
    for same in alike.values():
        if len(same) <= CHANGED_ALIKE:
            yield from same
        else:
            yield replace(same[0], what=f"{same[0].what} and {len(same) - 1} others")


def listed(text: str) -> str:
    """Return a list with its first few words, and how many others there are; other text unchanged."""
    words = text.split(SEPARATOR)
    others = len(words) - FILES_LISTED
    return f"{SEPARATOR.join(words[:FILES_LISTED])} and {others} others" if others > 1 else text


def all_row(difference: Difference) -> tuple[str, str, str, str]:
    """Return the row of the sum of all contributions."""
    before, after = counted(difference.before_cclk), counted(difference.after_cclk)
    return "All", before, after, counted(difference.cclk, sign=True)


def labelled(contribution: Contribution) -> str:
    """Return the name of a contribution, with its place."""
    if contribution.kind is ContributionKind.LINE:
        return f"{contribution.place.rpartition(':')[2]}  {contribution.name}"
    return f"{contribution.name} ({contribution.place})" if contribution.place else contribution.name


def cells(contribution: Contribution) -> tuple[str, str, str]:
    """Return the cycles before, those after, and the increase."""
    before, after = (
        "" if each is None else counted(each) for each in (contribution.before_cclk, contribution.after_cclk)
    )
    return before, after, counted(contribution.cclk, sign=True)


def frame_heads(difference: Difference) -> tuple[str, ...]:
    """Return the title of a table of `frame_rows`, and the heads of its columns."""
    title = f"Frames that changed most, of {len(difference.changed_frames)} (cycles of the slower core)"
    return title, "Frame", "before", "after", "difference"


def frame_rows(difference: Difference) -> Iterator[tuple[str, str, str, str]]:
    """Yield the frames that changed most with their cycles before, after, and the increase."""
    for each in difference.changed_frames[:CHANGED_LISTED]:
        more = each.after_cclk - each.before_cclk
        yield str(each.index), f"{each.before_cclk:,}", f"{each.after_cclk:,}", f"{more:+,}"
