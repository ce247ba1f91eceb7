"""Why a source line costs more or less than before: it runs more often, has other operations, or waits."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from bfsim.report.diff.difference import Contribution, ContributionKind
from bfsim.report.diff.side import Line, Operations, Stall
from bfsim.report.wording.operations import words
from bfsim.report.wording.units import counted

NAMED = 3
"""The number of operations that are named for a line that only one side has."""

MANY = 1000
"""From this average on, cycles have no decimals."""

Memories = Mapping[str, str]
"""The memory in which each buffer lies."""


@dataclass(frozen=True, slots=True)
class _Part:
    """What an operation contributes: by how much its count and its cycles have grown."""

    name: str
    more: float
    cclk: int


def line_causes(
    before: Line | None, after: Line | None, was: Memories, now: Memories
) -> tuple[Contribution, ...]:
    """Return the causes of a line's difference, the largest first; they sum to it. None if nothing differs.

    For a line that ran n times at c cycles and now runs n' times at c', (n' - n) · c is for running more often, and n'
    · (c' - c) is for its operations, one by one; but if the operations alone explain it with smaller numbers, as when a
    loop has become another kind of loop, they do.
    """
    old, new = (each if each and each.cclk else None for each in (before, after))
    if old and new:
        found = [*_operations(old, new), *_stalls(old.stalls, new.stalls, was, now)]
    else:
        found = [*_alone(old, new), *_stalls(old.stalls if old else {}, new.stalls if new else {}, was, now)]
    return tuple(sorted((each for each in found if each.cclk), key=lambda each: -abs(each.cclk)))


def _alone(old: Line | None, new: Line | None) -> Iterator[Contribution]:
    """Yield all operations of a line that only one side has, as one cause."""
    line = new or old
    if line is not None and line.issue_cclk:
        yield _cause(
            f"{'now' if new else 'was'} {line_text(line)}", line.issue_cclk if new else -line.issue_cclk
        )


def line_text(line: Line) -> str:
    """Say how often a line ran and how many cycles its operations take, and name the dearest."""
    costs = Counter(
        {name: cclk for name, (_, cclk) in _in_words(line.operations).items() if name != words("")}
    )
    dear = ", ".join(f"{name} {_each(cclk, line.times)}" for name, cclk in costs.most_common(NAMED))
    text = f"{counted(line.times)} times x {_each(line.issue_cclk, line.times)} cycles"
    return f"{text}: {dear}" if dear else text


def _operations(old: Line, new: Line) -> Iterator[Contribution]:
    """Yield the effect of running more often, and that of each operation."""
    was, now = _in_words(old.operations), _in_words(new.operations)
    plain = _parts(was, now, 0, 1)
    often, scaled = 0, plain
    if old.times and new.times != old.times:
        scaled = _parts(was, now, new.times - old.times, old.times)
        often = new.issue_cclk - old.issue_cclk - sum(each.cclk for each in scaled)
    if abs(often) + _size(scaled) > _size(plain):
        often, scaled = 0, plain
    if often:
        more = counted(new.times - old.times, sign=True)
        yield _cause(f"{more} times x {_each(old.issue_cclk, old.times)} cycles", often)
    for each in scaled:
        yield _cause(_told(each, was, now, new.times), each.cclk)


def _size(parts: Iterable[_Part]) -> int:
    return sum(abs(each.cclk) for each in parts)


def _in_words(operations: Operations) -> Operations:
    """Return operations by their names in words, which several kinds may share."""
    found: dict[str, tuple[int, int]] = {}
    for name, (count, cclk) in operations.items():
        had_count, had_cclk = found.get(words(name), (0, 0))
        found[words(name)] = had_count + count, had_cclk + cclk
    return found


def _parts(was: Operations, now: Operations, more: int, times: int) -> list[_Part]:
    """Return what each operation contributes apart from the effect of running `more` than `times` times."""
    parts = []
    for name in dict.fromkeys([*was, *now]):
        (old_count, old_cclk), (count, cclk) = was.get(name, (0, 0)), now.get(name, (0, 0))
        follows = round(old_cclk * more / times)
        parts.append(_Part(name, count - old_count * (1 + more / times), cclk - old_cclk - follows))
    return [each for each in parts if each.cclk]


def _told(part: _Part, was: Operations, now: Operations, times: int) -> str:
    """Say which operations have become more or fewer; per execution of the line, if that is a whole number."""
    name, (count, cclk), (old_count, old_cclk) = (
        part.name,
        now.get(part.name, (0, 0)),
        was.get(part.name, (0, 0)),
    )
    more = round(part.more)
    if not more:
        return f"{name}: {_each(old_cclk, old_count)} → {_each(cclk, count)} cycles x {counted(count)}"
    each = _each(cclk, count) if count else _each(old_cclk, old_count)
    if times and more % times == 0:
        return f"{name}: {more // times:+} x {counted(times)} x {each} cycles"
    return f"{name}: {counted(more, sign=True)} x {each} cycles"


def _stalls(
    old: Mapping[Stall, int], new: Mapping[Stall, int], was: Memories, now: Memories
) -> Iterator[Contribution]:
    for stall in dict.fromkeys([*new, *old]):
        text = f"stall: {stall.reason}"
        if stall.buffer:
            then, there = was.get(stall.buffer, ""), now.get(stall.buffer, "")
            moved = f", was in {then}" if then and there and then != there else ""
            text = f"{text}, {stall.buffer} in {there or then}{moved}"
        yield _cause(text, new.get(stall, 0) - old.get(stall, 0))


def _each(cclk: int, times: int) -> str:
    each = cclk / times if times else 0
    return f"{each:,.0f}" if each >= MANY else f"{each:.3g}"


def _cause(text: str, cclk: int) -> Contribution:
    return Contribution(
        kind=ContributionKind.CAUSE, name=text, place="", before_cclk=None, after_cclk=None, cclk=cclk
    )
