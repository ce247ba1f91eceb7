"""The cost of library routines, in the lines that call them: in object code, they are kernels of their own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Generic, TypeVar

from bfsim.report.wording.operations import is_routine
from bfsim.trace import KernelRecord, StallReason

Owner = TypeVar("Owner", bound=tuple[Any, ...])
"""A kernel: where it ran, such as its core and stage, then its name and its symbol."""


@dataclass(frozen=True, slots=True)
class Call(Generic[Owner]):
    """A line, at `place` among those of its `caller`, and the `times` that it called a routine."""

    caller: Owner
    place: int
    times: int


def calls_of_routines(
    operations: Mapping[Owner, Sequence[Mapping[str, tuple[int, int]]]],
) -> Iterator[tuple[Owner, Sequence[Call[Owner]]]]:
    """Yield each library routine that ran, with its calls; the routines that it calls come before it.

    `operations` are those of the lines of all kernels: a call of a routine is an operation of its name. Routines that
    call themselves are left out.
    """
    routines = {each[:-1]: each for each in operations if is_routine(each[-2])}
    waiting: dict[Owner, list[Call[Owner]]] = {}
    for caller, lines in operations.items():
        for place, line in enumerate(lines):
            for name, (times, _) in line.items():
                routine = routines.get((*caller[:-2], name))
                if routine and times:
                    waiting.setdefault(routine, []).append(Call(caller, place, times))
    while done := next((each for each in waiting if not _calls_one(each, waiting)), None):
        yield done, waiting.pop(done)


def _calls_one(routine: Owner, calls: Mapping[Owner, Sequence[Call[Owner]]]) -> bool:
    return any(one.caller == routine for each in calls.values() for one in each)


def split(total: int, calls: Sequence[Call[Owner]]) -> list[int]:
    """Return each call's part of a total: whole numbers that add up to it."""
    times, ends = 0, [0]
    for each in calls:
        times += each.times
        ends.append(times)
    return [end - begin for begin, end in pairwise(total * end // times for end in ends)]


def in_callers(kernels: Sequence[KernelRecord]) -> tuple[KernelRecord, ...]:
    """Return the records of kernels, with the cost of library routines merged into the lines that call them.

    A line gets the same share of a routine, including what the routine calls, as it has of the routine's calls on its
    core and in its stage. Routines keep nothing. The sums stay the same.
    """
    found = {(each.core, each.stage, each.kernel, each.symbol): each for each in kernels}
    operations = {owner: [line.operations for line in each.lines] for owner, each in found.items()}
    for owner, calls in calls_of_routines(operations):
        routine = found[owner]
        stalls = {reason: split(cclk, calls) for reason, cclk in routine.stall_cclk.items()}
        issues, objects = split(routine.issue_cclk, calls), split(routine.object_cclk, calls)
        for number, call in enumerate(calls):
            more = Counter({reason: parts[number] for reason, parts in stalls.items()})
            found[call.caller] = _with_more(
                found[call.caller], call.place, routine.kernel, issues[number], objects[number], more
            )
        found[owner] = replace(routine, issue_cclk=0, object_cclk=0, stall_cclk={}, lines=())
    return tuple(found.values())


def _with_more(
    caller: KernelRecord,
    place: int,
    routine: str,
    issue_cclk: int,
    object_cclk: int,
    stall_cclk: Counter[StallReason],
) -> KernelRecord:
    """Return a kernel with these cycles of a routine added to the line at `place`."""
    lines = [*caller.lines]
    line = lines[place]
    times, cclk = line.operations[routine]
    lines[place] = replace(
        line,
        issue_cclk=line.issue_cclk + issue_cclk,
        stall_cclk=Counter(line.stall_cclk) + stall_cclk,
        operations={**line.operations, routine: (times, cclk + issue_cclk)},
    )
    return replace(
        caller,
        issue_cclk=caller.issue_cclk + issue_cclk,
        object_cclk=caller.object_cclk + object_cclk,
        stall_cclk=Counter(caller.stall_cclk) + stall_cclk,
        lines=tuple(lines),
    )
