"""Counters of the kernels → records per kernel and source line, the kernels that were called by others included."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import TypeVar

from bfsim.kernel import Kernel, tree
from bfsim.kernel.ir_text import SourceLine
from bfsim.machine.calls.groups import CallGroup
from bfsim.trace import KernelRecord, LineCost

Label = TypeVar("Label")
_Array = tuple[str, str]  # routine and parameter


@dataclass(slots=True)
class _Tally:
    """Sums of one kernel in one stage."""

    function: tree.Function
    calls: int = 0
    executions: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    issue_cclk: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    stall_cclk: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    accesses: dict[str, list[int]] = field(default_factory=lambda: defaultdict(lambda: [0, 0]))


def kernel_records(core: str, groups: Iterable[CallGroup]) -> Iterator[KernelRecord]:
    """Return one record per stage and kernel of one core."""
    tallies: dict[tuple[str, str], _Tally] = {}
    for group in groups:
        _add(group, tallies)
    for (stage, _), tally in tallies.items():
        function = tally.function
        yield KernelRecord(
            core=core,
            stage=stage,
            kernel=function.name,
            file=function.file,
            first_line=function.first_line,
            text=tuple(function.source.splitlines()),
            calls=tally.calls,
            issue_cclk=sum(tally.issue_cclk.values()),
            lines=tuple(
                LineCost(
                    line=function.first_line + line - 1,
                    executions=tally.executions[line],
                    issue_cclk=cclk,
                    stall_cclk=tally.stall_cclk[line],
                )
                for line, cclk in sorted(tally.issue_cclk.items())
            ),
            accesses={memory: (reads, writes) for memory, (reads, writes) in sorted(tally.accesses.items())},
        )


def _add(group: CallGroup, tallies: dict[tuple[str, str], _Tally]) -> None:
    top = group.kernel.function
    functions = {each.symbol: each for each in (*top.callees(), top)}
    memory_of = arrays_of_callees(group.kernel, group.memories)
    executions: dict[tuple[str, SourceLine], int] = {}

    def tally(symbol: str) -> _Tally:
        return tallies.setdefault((group.stage, symbol), _Tally(functions[symbol]))

    for counter, events in zip(group.code.counters, group.totals.tolist(), strict=False):
        for symbol in counter.enters:
            tally(symbol).calls += events
        for place, issue_cclk, stall_cclk in counter.line_cclk:
            own = tally(place.routine)
            own.issue_cclk[place.line] += events * issue_cclk
            own.stall_cclk[place.line] += events * stall_cclk
            if counter.value is None:
                once = (counter.routine, place)
                executions[once] = max(executions.get(once, 0), events)
        for array, reads, writes in counter.array_accesses:
            sums = tally(counter.routine).accesses[memory_of[counter.routine, array]]
            sums[0] += events * reads
            sums[1] += events * writes
    for (_, place), events in executions.items():
        tally(place.routine).executions[place.line] += events


def arrays_of_callees(kernel: Kernel, labels: tuple[Label, ...]) -> dict[_Array, Label]:
    """Hand the labels of a kernel's arrays on to the kernels it calls: label by (routine, parameter).

    What a callee gets comes from its first call.
    """
    names = [kernel.function.parameters[each].name for each in kernel.array_positions]
    found = {(kernel.function.symbol, name): label for name, label in zip(names, labels, strict=True)}
    for taker, giver in _handed_on(kernel):
        found.setdefault(taker, found[giver])
    return found


@cache
def _handed_on(kernel: Kernel) -> tuple[tuple[_Array, _Array], ...]:
    """Return the arrays of the kernels that a kernel calls, each with the caller's that it is, callers first."""
    pairs: list[tuple[_Array, _Array]] = []
    waiting = [kernel.function]
    while waiting:
        caller = waiting.pop()
        for call in tree.calls_in(caller.body):
            for parameter, argument in zip(call.callee.parameters, call.arguments, strict=True):
                if isinstance(argument, str):
                    pairs.append(((call.callee.symbol, parameter.name), (caller.symbol, argument)))
            waiting.append(call.callee)
    return tuple(dict.fromkeys(pairs))
