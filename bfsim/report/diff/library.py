"""The cost of routines of the compiler's library, as part of the lines that call them, on one side of a comparison."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from bfsim.report.diff.side import Owner, Source, Stall
from bfsim.report.profile.library import Call, calls_of_routines, split

Owners = Mapping[Owner, int]
Sources = Mapping[Owner, Source]


def with_callers(owners: Owners, sources: Sources) -> tuple[Owners, Sources]:
    """Return owners and their lines, with routines of the library merged into the lines that call them.

    A line gets the same share of a routine, including what the routine calls, as it has of the routine's calls. The
    sums stay the same.
    """
    owners, sources = dict(owners), dict(sources)
    operations = {owner: [line.operations for line in source.lines] for owner, source in sources.items()}
    for done, calls in calls_of_routines(operations):
        routine = sources.pop(done)
        cclks = split(owners.pop(done, 0), calls)
        for call, cclk, cost in zip(calls, cclks, _costs(routine, calls), strict=True):
            owners[call.caller] = owners.get(call.caller, 0) + cclk
            sources[call.caller] = _with_cost(sources[call.caller], call, done.name, cost)
    return owners, sources


def _costs(routine: Source, calls: Sequence[Call[Owner]]) -> Iterator[tuple[int, Counter[Stall]]]:
    """Yield each call's share of a routine's issue cycles and stalls."""
    stalls = Counter[Stall]()
    for line in routine.lines:
        stalls.update(line.stalls)
    by_stall = {stall: split(cclk, calls) for stall, cclk in stalls.items()}
    for number, issue_cclk in enumerate(split(sum(each.issue_cclk for each in routine.lines), calls)):
        yield issue_cclk, Counter({stall: parts[number] for stall, parts in by_stall.items()})


def _with_cost(source: Source, call: Call[Owner], name: str, cost: tuple[int, Counter[Stall]]) -> Source:
    """Return the lines of a caller, with the cost of the routine `name` added to the line of the call."""
    lines, (more_cclk, stalls) = [*source.lines], cost
    line = lines[call.place]
    times, cclk = line.operations[name]
    stalls.update(line.stalls)
    operations = {**line.operations, name: (times, cclk + more_cclk)}
    lines[call.place] = replace(line, operations=operations, stalls=stalls)
    return replace(source, lines=tuple(lines))
