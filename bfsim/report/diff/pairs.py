"""Which owners of cycles, and which stages, of two runs correspond, even if they were renamed."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from itertools import product
from typing import TypeVar

from bfsim.report.diff.side import Owner, Side, Source

SMALL = "what is too small to be kept"
"""All owners of a stage, or lines of a kernel, that a baseline does not have."""
ALIKE = 0.5
"""Kernels of two names are one if a larger share of their lines is the same, and stages if that of their kernels is."""

Pair = tuple[Owner | None, Owner | None]
Renamed = TypeVar("Renamed", bound=Hashable)


def with_stages_alike(before: Side, after: Side) -> tuple[Side, Side]:
    """Return two sides with stages of the same names, and without owners that one side did not keep.

    A renamed stage is called `before → after`.
    """
    names = _renamed_stages(_kept_alike(before, after), _kept_alike(after, before))
    both = {old: f"{old} → {new}" for old, new in names.items()}
    before = before.with_stages(both)
    after = after.with_stages({new: both[old] for old, new in names.items()})
    return _kept_alike(before, after), _kept_alike(after, before)


def _renamed_stages(before: Side, after: Side) -> dict[str, str]:
    """Return the stages that were renamed: those with more than half of their kernels' names in common, the most first."""
    olds, news = _kernels_by_stage(before), _kernels_by_stage(after)
    gone, come = [each for each in olds if each not in news], [each for each in news if each not in olds]
    return _most_alike(
        (2 * len(olds[old] & news[new]) / (len(olds[old]) + len(news[new])), old, new)
        for old, new in product(gone, come)
        if olds[old] or news[new]
    )


def _kernels_by_stage(side: Side) -> Mapping[str, set[str]]:
    """Return the names of each stage's kernels; there may be none."""
    found: dict[str, set[str]] = {}
    for owner in side.owners:
        found.setdefault(owner.stage, set()).update([owner.name] if owner.symbol else [])
    return found


def _kept_alike(side: Side, other: Side) -> Side:
    """Return a side without owners that the other side did not keep because they are small."""
    if not other.least_cclk:
        return side
    owners = Counter[Owner]()
    known = {(each.stage, each.name) for each in other.owners}
    for owner, cclk in side.owners.items():
        is_small = cclk < other.least_cclk and (owner.stage, owner.name) not in known
        owners[Owner(owner.stage, SMALL, "") if is_small else owner] += cclk
    return side.with_owners(owners)


def pairs_of(before: Side, after: Side) -> Iterator[Pair]:
    """Pair the owners of two runs: those that are the same, and those that now have another symbol or name."""
    known = before.owners.keys() & after.owners.keys()
    gone = [each for each in before.owners if each not in known]
    come = [each for each in after.owners if each not in known]
    same = _same_name(gone, come)
    left = [each for each in gone if each not in same], [each for each in come if each not in same.values()]
    same |= _same_text(*left, before.sources, after.sources)
    for owner in before.owners:
        yield owner, owner if owner in known else same.get(owner)
    yield from ((None, owner) for owner in come if owner not in same.values())


def _same_name(gone: Sequence[Owner], come: Sequence[Owner]) -> dict[Owner, Owner]:
    """Return owners with unique names in each run: a kernel's symbol contains its file's name, which may change."""
    olds, news = _by_name(gone), _by_name(come)
    return {
        each[0]: news[name][0]
        for name, each in olds.items()
        if len(each) == 1 and len(news.get(name, [])) == 1
    }


def _same_text(
    gone: Sequence[Owner],
    come: Sequence[Owner],
    olds: Mapping[Owner, Source],
    news: Mapping[Owner, Source],
) -> dict[Owner, Owner]:
    """Return the renamed kernels of a stage: those with more than half of their lines in common, the most first."""
    return _most_alike(
        (_likeness(olds[old], news[new]), old, new)
        for old, new in product(gone, come)
        if old.stage == new.stage and old in olds and new in news
    )


def _most_alike(pairs: Iterable[tuple[float, Renamed, Renamed]]) -> dict[Renamed, Renamed]:
    """Return which names correspond, from pairs with their likeness: each once, the most alike first, then in order."""
    same: dict[Renamed, Renamed] = {}
    for likeness, old, new in sorted(pairs, key=lambda each: -each[0]):
        if likeness > ALIKE and old not in same and new not in same.values():
            same[old] = new
    return same


def _likeness(old: Source, new: Source) -> float:
    before, after = [each.text for each in old.lines], [each.text for each in new.lines]
    return SequenceMatcher(None, before, after, autojunk=False).ratio()


def _by_name(owners: Iterable[Owner]) -> Mapping[tuple[str, str], list[Owner]]:
    found: defaultdict[tuple[str, str], list[Owner]] = defaultdict(list)
    for each in owners:
        found[each.stage, each.name].append(each)
    return found
