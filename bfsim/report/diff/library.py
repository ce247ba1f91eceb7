"""What routines of the compiler's library cost, as part of the lines that call them: object code has them as kernels of their own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from bfsim.report.diff.operations import WORDS
from bfsim.report.diff.side import Owner, Source, Stall

Owners = Mapping[Owner, int]
Sources = Mapping[Owner, Source]


@dataclass(frozen=True, slots=True)
class _Call:
    """So many `times` a line, by its place among those of its owner, called a routine."""

    caller: Owner
    place: int
    times: int


def with_callers(owners: Owners, sources: Sources) -> tuple[Owners, Sources]:
    """Return owners and their lines, where those that are routines of the library are part of the lines that call them.

    A line has as much of a routine, with what that calls in turn, as it has of the routine's calls. The sums stay what they are.
    """
    owners, sources = dict(owners), dict(sources)
    waiting = {routine: [*calls] for routine, calls in _calls(sources).items()}
    while done := next((each for each in waiting if not _calls_one(each, waiting)), None):
        calls, routine = waiting.pop(done), sources.pop(done)
        cclks = _split(owners.pop(done, 0), calls)
        for call, cclk, cost in zip(calls, cclks, _costs(routine, calls), strict=True):
            owners[call.caller] = owners.get(call.caller, 0) + cclk
            sources[call.caller] = _with_cost(sources[call.caller], call, done.name, cost)
    return owners, sources


def _calls(sources: Sources) -> Mapping[Owner, Sequence[_Call]]:
    """Return of each routine of the library that ran the calls of it: lines have them as operations of its name."""
    routines = {(each.stage, each.name): each for each in sources if each.name not in WORDS}
    found: dict[Owner, list[_Call]] = {}
    for caller, source in sources.items():
        for place, line in enumerate(source.lines):
            for name, (times, _) in line.operations.items():
                routine = routines.get((caller.stage, name))
                if routine and times:
                    found.setdefault(routine, []).append(_Call(caller, place, times))
    return found


def _calls_one(routine: Owner, calls: Mapping[Owner, Sequence[_Call]]) -> bool:
    return any(one.caller == routine for each in calls.values() for one in each)


def _split(total: int, calls: Sequence[_Call]) -> list[int]:
    """Return the part of a total that each call has: whole numbers that sum to it."""
    times, ends = 0, [0]
    for each in calls:
        times += each.times
        ends.append(times)
    return [end - begin for begin, end in pairwise(total * end // times for end in ends)]


def _costs(routine: Source, calls: Sequence[_Call]) -> Iterator[tuple[int, Counter[Stall]]]:
    """Yield the issue cycles and the stalls of a routine that each call has."""
    stalls = Counter[Stall]()
    for line in routine.lines:
        stalls.update(line.stalls)
    by_stall = {stall: _split(cclk, calls) for stall, cclk in stalls.items()}
    for number, issue_cclk in enumerate(_split(sum(each.issue_cclk for each in routine.lines), calls)):
        yield issue_cclk, Counter({stall: parts[number] for stall, parts in by_stall.items()})


def _with_cost(source: Source, call: _Call, name: str, cost: tuple[int, Counter[Stall]]) -> Source:
    """Return the lines of a caller, that of the call with what it has of the routine `name`."""
    lines, (more_cclk, stalls) = [*source.lines], cost
    line = lines[call.place]
    times, cclk = line.operations[name]
    stalls.update(line.stalls)
    operations = {**line.operations, name: (times, cclk + more_cclk)}
    lines[call.place] = replace(line, operations=operations, stalls=stalls)
    return replace(source, lines=tuple(lines))
