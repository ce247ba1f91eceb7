"""The tree of contributions: stage, then kernel or wait, then source line, then cause."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath

from bfsim.report.diff.alignment import aligned
from bfsim.report.diff.difference import Contribution, Kind
from bfsim.report.diff.line_causes import line_causes
from bfsim.report.result_file import Result
from bfsim.trace import KernelRecord, LineCost, RunRecord

WAITS = "waits for the other core and the cameras"


@dataclass(frozen=True, slots=True)
class _Owner:
    """What cycles are compared by: a kernel by its symbol, anything else by its name; what follows from the rest apart."""

    stage: str
    name: str
    symbol: str
    follows: bool = False


def stage_contributions(
    before: Result, after: Result, frames: Iterable[int], *, has_lines: bool
) -> tuple[Contribution, ...]:
    """Return what each stage contributes to the difference of two runs in these frames, the largest first."""
    chosen = set(frames)
    old, new = _costs(before, chosen), _costs(after, chosen)
    kernels = _Kernels(before.run, after.run) if has_lines else None
    parts: defaultdict[str, list[Contribution]] = defaultdict(list)
    for owner in dict.fromkeys([*old, *new]):
        parts[owner.stage].append(_owner(owner, old[owner], new[owner], kernels))
    return _by_size(_sum(Kind.STAGE, stage, each) for stage, each in parts.items())


def _costs(result: Result, chosen: set[int]) -> Counter[_Owner]:
    """Return the cycles of each owner on all cores."""
    found: Counter[_Owner] = Counter()
    places = [place for place, frame in enumerate(result.run.frames) if frame.index in chosen]
    for each in result.owners:
        waiting = sum(each.waiting_cclk[place] for place in places)
        elapsed = sum(each.elapsed_cclk[place] for place in places)
        found[_Owner(each.stage, each.owner, each.symbol)] += elapsed - waiting
        found[_Owner(each.stage, WAITS, "", follows=True)] += waiting
    return found


def _owner(owner: _Owner, before: int, after: int, kernels: _Kernels | None) -> Contribution:
    kind = Kind.FOLLOWS if owner.follows else Kind.KERNEL if owner.symbol else Kind.OTHER
    place, lines = "", tuple[Contribution, ...]()
    if kernels is not None and owner.symbol:
        place, lines = kernels.place(owner), kernels.lines(owner)
    missing = after - before - sum(each.cclk for each in lines)
    if lines and missing:
        lines = (*lines, _contribution(Kind.OTHER, "not of a line", "", None, None, missing))
    return _contribution(kind, owner.name, place, before, after, after - before, _by_size(lines))


class _Kernels:
    """The source lines of both runs' kernels."""

    def __init__(self, before: RunRecord, after: RunRecord) -> None:
        self._old, self._new = _records(before.kernels), _records(after.kernels)

    def place(self, owner: _Owner) -> str:
        record = (self._new.get(owner) or self._old[owner])[0]
        return f"{PurePath(record.file).name}:{record.first_line}"

    def lines(self, owner: _Owner) -> tuple[Contribution, ...]:
        """Return what the kernel's lines contribute; lines are the same where their text is."""
        old, new = self._old.get(owner, []), self._new.get(owner, [])
        olds, news = _line_costs(old), _line_costs(new)
        found = []
        for pair in aligned(old[0].text if old else (), new[0].text if new else ()):
            before = olds.get(pair.old + old[0].first_line) if pair.old is not None else None
            after = news.get(pair.new + new[0].first_line) if pair.new is not None else None
            causes = line_causes(before, after)
            if causes:
                found.append(_line(new or old, before, after, causes))
        return tuple(found)


def _line(
    records: Sequence[KernelRecord],
    before: LineCost | None,
    after: LineCost | None,
    causes: tuple[Contribution, ...],
) -> Contribution:
    shown = after or before
    assert shown is not None  # or there would be no causes
    first = records[0]
    text = dict(enumerate(first.text, start=first.first_line)).get(shown.line, "").strip()
    old, new = (each.elapsed_cclk if each else 0 for each in (before, after))
    place = f"{PurePath(first.file).name}:{shown.line}"
    return _contribution(Kind.LINE, text, place, old, new, new - old, causes)


def _records(kernels: Iterable[KernelRecord]) -> Mapping[_Owner, list[KernelRecord]]:
    found: defaultdict[_Owner, list[KernelRecord]] = defaultdict(list)
    for each in kernels:
        found[_Owner(each.stage, each.kernel, each.symbol)].append(each)
    return dict(found)


def _line_costs(records: Iterable[KernelRecord]) -> dict[int, LineCost]:
    """Add up the lines of one kernel on different cores."""
    found: dict[int, LineCost] = {}
    for line in (line for record in records for line in record.lines):
        other = found.get(line.line)
        found[line.line] = line if other is None else _added(line, other)
    return found


def _added(one: LineCost, other: LineCost) -> LineCost:
    return LineCost(
        line=one.line,
        executions=one.executions + other.executions,
        issue_cclk=one.issue_cclk + other.issue_cclk,
        stall_cclk=Counter(one.stall_cclk) + Counter(other.stall_cclk),
    )


def _sum(kind: Kind, name: str, parts: Sequence[Contribution]) -> Contribution:
    before = sum(each.before_cclk or 0 for each in parts)
    after = sum(each.after_cclk or 0 for each in parts)
    changed = _by_size(each for each in parts if each.cclk)
    return _contribution(kind, name, "", before, after, after - before, changed)


def _by_size(parts: Iterable[Contribution]) -> tuple[Contribution, ...]:
    return tuple(sorted(parts, key=lambda each: (-abs(each.cclk), each.name)))


def _contribution(
    kind: Kind,
    name: str,
    place: str,
    before_cclk: int | None,
    after_cclk: int | None,
    cclk: int,
    parts: tuple[Contribution, ...] = (),
) -> Contribution:
    return Contribution(
        kind=kind,
        name=name,
        place=place,
        before_cclk=before_cclk,
        after_cclk=after_cclk,
        cclk=cclk,
        parts=parts,
    )


def walk(contributions: Iterable[Contribution], depth: int = 0) -> Iterator[tuple[int, Contribution]]:
    """Yield each contribution with its depth, parts after their whole."""
    for each in contributions:
        yield depth, each
        yield from walk(each.parts, depth + 1)
