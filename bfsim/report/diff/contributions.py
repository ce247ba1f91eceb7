"""The tree of contributions: stage, then kernel, source line and cause; at the end the waits that follow from these."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence

from bfsim.report.diff.alignment import LinePair, aligned, with_moved
from bfsim.report.diff.difference import Contribution, ContributionKind
from bfsim.report.diff.line_causes import line_causes
from bfsim.report.diff.pairs import SMALL, pairs_of, with_stages_alike
from bfsim.report.diff.side import Line, Owner, Side, Source

WAITS = "waits for other cores and the cameras"
NO_LINE = "not of a line"


def contributions_of(before: Side, after: Side) -> tuple[Contribution, ...]:
    """Return what each stage contributes to the difference of two runs, the largest first, then the waits.

    They sum to the difference, and the parts of each sum to their whole.
    """
    parts: defaultdict[str, list[Contribution]] = defaultdict(list)
    before, after = with_stages_alike(before, after)
    for old, new in pairs_of(before, after):
        owner = new or old
        assert owner is not None
        parts[owner.stage].append(_of_owner(old, new, before, after))
    stages = _by_size(_sum(ContributionKind.STAGE, stage, each) for stage, each in parts.items())
    waits = [
        _contribution(
            ContributionKind.FOLLOWS, stage, "", before.waits.get(stage, 0), after.waits.get(stage, 0)
        )
        for stage in dict.fromkeys([*before.waits, *after.waits])
    ]
    return (*stages, _sum(ContributionKind.FOLLOWS, WAITS, waits))


def walk(contributions: Iterable[Contribution], depth: int = 0) -> Iterator[tuple[int, Contribution]]:
    """Yield each contribution with its depth, parts after their whole."""
    for each in contributions:
        yield depth, each
        yield from walk(each.parts, depth + 1)


def _of_owner(old: Owner | None, new: Owner | None, before: Side, after: Side) -> Contribution:
    olds, news = before.sources.get(old) if old else None, after.sources.get(new) if new else None
    was, now = before.owners[old] if old else 0, after.owners[new] if new else 0
    shown, source = new or old, news or olds
    assert shown is not None
    lines = tuple(_lines(olds, news, before, after)) if source else ()
    missing = now - was - sum(each.cclk for each in lines)
    if lines and missing:
        is_cut = before.least_cclk or after.least_cclk
        lines = (
            *lines,
            _contribution(ContributionKind.OTHER, SMALL if is_cut else NO_LINE, "", None, None, cclk=missing),
        )
    name = f"{old.name} → {new.name}" if old and new and old.name != new.name else shown.name
    kind, place = (
        ContributionKind.KERNEL if shown.symbol else ContributionKind.OTHER,
        source.place if source else "",
    )
    return _contribution(kind, name, place, was, now, _by_size(lines))


def _lines(old: Source | None, new: Source | None, before: Side, after: Side) -> Iterator[Contribution]:
    """Yield what the lines of a kernel contribute; lines with the same text, or almost, are the same line."""
    olds, news = old.lines if old else (), new.lines if new else ()
    texts = [each.text for each in olds], [each.text for each in news]
    for pair in with_moved(aligned(*texts), *texts):
        was, now = _at(pair, olds, news)
        if (was is None and now and now.cclk < before.least_cclk) or (
            now is None and was and was.cclk < after.least_cclk
        ):
            continue
        causes = line_causes(was, now, before.memories, after.memories)
        shown = now or was
        assert shown is not None
        if causes:
            file = (new or old).place.rpartition(":")[0]  # type: ignore[union-attr]  # one of them is there
            place = f"{file}:{shown.number}" if shown.number else file
            cclks = was.cclk if was else 0, now.cclk if now else 0
            yield _contribution(ContributionKind.LINE, shown.text, place, *cclks, causes)


def _at(pair: LinePair, olds: Sequence[Line], news: Sequence[Line]) -> tuple[Line | None, Line | None]:
    return (
        olds[pair.old] if pair.old is not None else None,
        news[pair.new] if pair.new is not None else None,
    )


def _sum(kind: ContributionKind, name: str, parts: Sequence[Contribution]) -> Contribution:
    before = sum(each.before_cclk or 0 for each in parts)
    after = sum(each.after_cclk or 0 for each in parts)
    return _contribution(kind, name, "", before, after, _by_size(each for each in parts if each.cclk))


def _by_size(parts: Iterable[Contribution]) -> tuple[Contribution, ...]:
    return tuple(sorted(parts, key=lambda each: (-abs(each.cclk), each.name)))


def _contribution(
    kind: ContributionKind,
    name: str,
    place: str,
    before_cclk: int | None,
    after_cclk: int | None,
    parts: tuple[Contribution, ...] = (),
    *,
    cclk: int | None = None,
) -> Contribution:
    return Contribution(
        kind=kind,
        name=name,
        place=place,
        before_cclk=before_cclk,
        after_cclk=after_cclk,
        cclk=(after_cclk or 0) - (before_cclk or 0) if cclk is None else cclk,
        parts=parts,
    )
