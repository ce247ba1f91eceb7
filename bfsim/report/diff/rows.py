"""The contributions that have a row: the largest, those that contain them, and the sum of all others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from collections.abc import Set as AbstractSet

from bfsim.report.diff.contributions import walk
from bfsim.report.diff.difference import Contribution, ContributionKind, Difference
from bfsim.report.diff.sentences import largest
from bfsim.report.wording.units import others_row


def shown(difference: Difference, top: int) -> list[tuple[int, Contribution]]:
    """Return the `top` largest contributions without parts, and those that contain them, with their depths.

    The first is the contribution that the sentences name: the largest part of the largest. Stages, kernels and lines
    that are not shown share a row, so that parts sum to their whole. Waits that follow from the rest are the last row.
    """
    rows = list(walk(each for each in difference.stages if each.kind is not ContributionKind.FOLLOWS))
    leaves = [each for _, each in rows if not each.parts and each.cclk]
    told = [id(each) for each in largest(difference.stages)]
    leaves.sort(key=lambda each: (id(each) not in told, -abs(each.cclk)))
    wanted = {id(each) for each in leaves[:top]}
    own, waits = _apart(difference.stages, lambda each: each.kind is not ContributionKind.FOLLOWS)
    return [*_chosen(own, wanted, 0), *((0, each) for each in waits)]


def _chosen(
    parts: Sequence[Contribution], wanted: AbstractSet[int], depth: int
) -> Iterator[tuple[int, Contribution]]:
    """Yield the contributions whose ids are wanted, or that contain such ones; then the others, as one."""
    found, others = _apart(parts, lambda each: not wanted.isdisjoint(_ids(each)))
    for each in found:
        yield depth, each
        yield from _chosen(each.parts, wanted, depth + 1)
    if any(each.cclk for each in others) and all(each.kind is not ContributionKind.CAUSE for each in parts):
        yield depth, others[0] if len(others) == 1 else _together(others)


def _apart(
    parts: Iterable[Contribution], is_so: Callable[[Contribution], bool]
) -> tuple[list[Contribution], list[Contribution]]:
    """Return the contributions for which `is_so` holds, and the others."""
    found: tuple[list[Contribution], list[Contribution]] = [], []
    for each in parts:
        found[not is_so(each)].append(each)
    return found


def _together(others: Sequence[Contribution]) -> Contribution:
    """Return several contributions as one."""
    return Contribution(
        kind=ContributionKind.OTHER,
        name=others_row(len(others)),
        place="",
        before_cclk=sum(each.before_cclk or 0 for each in others),
        after_cclk=sum(each.after_cclk or 0 for each in others),
        cclk=sum(each.cclk for each in others),
    )


def _ids(contribution: Contribution) -> Iterable[int]:
    return (id(each) for _, each in walk([contribution]))
