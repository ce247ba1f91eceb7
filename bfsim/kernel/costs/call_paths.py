"""Call paths of a program: a kernel that is called through two others, or with other arrays, is counted separately.

A program's counts are a table laid out like its tree of calls: first those of a routine itself, then those of each
callee. Where a callee's part begins depends only on where the caller's does, so a call passes on its own place plus a
constant.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.costs.costs import Costs
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.costs.routine_calls import RoutineCall
from bfsim.kernel.ir.text import Entrance, SourceLine

MOST_COUNTERS = 1000
"""[ours] In a program with more, the calls of a routine are counted together, whatever their path."""


class Site(NamedTuple):
    """Accesses of one source line to one array, the parameter `array` of the routine."""

    line: SourceLine
    array: str


class Offset(NamedTuple):
    """Where a part begins: its first counter and its first site."""

    counter: int
    site: int


@dataclass(frozen=True, slots=True)
class CallPath:
    """One path to a routine. `routines`: those from the program's first down to it.

    `arrays`: its array parameters, each with that of the program. `first`: where its counters and its sites begin.
    """

    routines: tuple[str, ...]
    arrays: Mapping[str, str]
    first: Offset


class RoutineCosts(NamedTuple):
    """What a counter's event costs, by routine: a row for each counter and each routine that bears a part of it.

    `symbols`: the routines. `counter` and `routine`: their numbers in each row. `costs`: calls, issue cycles and stall
    cycles in each row.
    """

    symbols: tuple[str, ...]
    counter: NDArray[np.int64]
    routine: NDArray[np.int64]
    costs: NDArray[np.int64]


class CountedAccesses(NamedTuple):
    """The number of `accesses` that a counter's event makes at one site.

    `counter` and `site`: their numbers. `array`: the program's; each access may be to any of `among` arrays, this one
    included.
    """

    counter: int
    site: int
    array: str
    among: int
    accesses: int


@dataclass(frozen=True)
class Program:
    """The kernel `symbol` and all that it calls, as counted: each counter once for each path to its routine."""

    symbol: str
    costs: Costs
    arrays: tuple[str, ...]
    """The kernel's array parameters."""
    together: bool = False
    """Whether the calls of a routine are counted together, whatever their path, by counters in the order of the costs."""
    paths: tuple[CallPath, ...] = field(init=False)

    def __post_init__(self) -> None:
        paths = tuple(self._tree()) if self._has_tree else tuple(self._flat())
        object.__setattr__(self, "paths", paths)

    @cached_property
    def own(self) -> Mapping[str, tuple[Counter, ...]]:
        """Counters of each routine."""
        found: dict[str, list[Counter]] = {each: [] for each in (self.symbol, *self.costs.calls)}
        for each in self.costs.counters:
            found[each.routine].append(each)
        return {routine: tuple(each) for routine, each in found.items()}

    @cached_property
    def own_sites(self) -> Mapping[str, tuple[Site, ...]]:
        """Sites of each routine."""
        return {
            routine: tuple(
                dict.fromkeys(Site(one.line, one.array) for each in counters for one in each.accesses)
            )
            for routine, counters in self.own.items()
        }

    @cached_property
    def counted(self) -> tuple[tuple[int, CallPath, Counter], ...]:
        """Every counter with its number and the path that it counts, path by path."""
        given = {id(each): number for number, each in enumerate(self.costs.counters)}
        return tuple(
            (given[id(each)] if self.together else number, path, each)
            for path in self.paths
            for number, each in enumerate(self.own[path.routines[-1]], path.first.counter)
        )

    @cached_property
    def counters(self) -> tuple[Counter, ...]:
        """What is counted, in the order of the numbers."""
        return self.costs.counters if self.together else tuple(counter for _, _, counter in self.counted)

    @cached_property
    def sites(self) -> tuple[Site, ...]:
        """Where it may access memory outside L1, path by path."""
        return tuple(each for path in self.paths for each in self.own_sites[path.routines[-1]])

    @cached_property
    def routine_costs(self) -> RoutineCosts:
        """The routines whose calls and cycles each counter counts."""
        rows: dict[tuple[int, str], list[int]] = {}
        for number, _, counter in self.counted:
            for each in counter.enters:
                rows.setdefault((number, each.symbol), [0, 0, 0])[0] += 1
            for place, issue_cclk, stall_cclk in counter.line_cclk:
                row = rows.setdefault((number, place.routine), [0, 0, 0])
                row[1] += issue_cclk
                row[2] += stall_cclk
        numbers = {
            symbol: number for number, symbol in enumerate(dict.fromkeys(symbol for _, symbol in rows))
        }
        return RoutineCosts(
            tuple(numbers),
            np.array([counter for counter, _ in rows], np.int64),
            np.array([numbers[symbol] for _, symbol in rows], np.int64),
            np.array(list(rows.values()), np.int64).reshape(-1, 3),
        )

    @cached_property
    def accesses(self) -> tuple[CountedAccesses, ...]:
        """The accesses to its arrays by the events of its counters."""
        sites = {
            (path.first, site): number
            for path in self.paths
            for number, site in enumerate(self.own_sites[path.routines[-1]], path.first.site)
        }
        found: dict[tuple[int, int, str, int], int] = {}
        for number, path, counter in self.counted:
            for each in counter.accesses:
                if each.is_counted and each.array in path.arrays:
                    site = sites[path.first, Site(each.line, each.array)]
                    key = (number, site, path.arrays[each.array], each.among)
                    found[key] = found.get(key, 0) + 1
        return tuple(CountedAccesses(*key, accesses) for key, accesses in found.items())

    def call_offsets(self, routine: str) -> tuple[Offset, ...]:
        """Return for each call of a routine where the callee's part begins, relative to the caller's."""
        calls = self.costs.calls.get(routine, ())
        if not calls or not self._has_tree:
            return (Offset(0, 0),) * len(calls)
        found, at = dict[RoutineCall, Offset](), self._own_size(routine)
        for each in calls:
            if each not in found:
                found[each] = at
                size = self._size(each.callee)
                at = Offset(at.counter + size.counter, at.site + size.site)
        return tuple(found[each] for each in calls)

    def base(self, routine: str) -> Offset:
        """Return where a routine's own counters begin in the part that it is handed."""
        if self._has_tree:
            return Offset(0, 0)
        return next(each.first for each in self.paths if each.routines[-1] == routine)

    def through(self, path: CallPath, line: SourceLine) -> tuple[str, ...]:
        """Return the routines down to a line of the one that `path` leads to, including those inlined there."""
        if line.routine == path.routines[-1]:
            return path.routines
        return (*path.routines, *self.costs.inlined.get(line.site, ())[1:], line.routine)

    def entered(self, path: CallPath, entrance: Entrance) -> tuple[str, ...]:
        """Return the routines down to one that begins at the end of `path`: that routine itself, or one inlined there."""
        if entrance.symbol == path.routines[-1]:
            return path.routines
        return (*self.through(path, entrance.caller), entrance.symbol)

    @cached_property
    def _has_tree(self) -> bool:
        if self.together:
            return False
        return self._size(self.symbol).counter <= max(MOST_COUNTERS, len(self.costs.counters))

    def _own_size(self, routine: str) -> Offset:
        return Offset(len(self.own[routine]), len(self.own_sites[routine]))

    @cached_property
    def _sizes(self) -> dict[str, Offset]:
        return {}

    def _size(self, routine: str) -> Offset:
        """Return how many counters and sites a routine has, callees included."""
        if routine not in self._sizes:
            parts = [
                self._own_size(routine),
                *(self._size(each.callee) for each in dict.fromkeys(self.costs.calls.get(routine, ()))),
            ]
            self._sizes[routine] = Offset(
                sum(each.counter for each in parts), sum(each.site for each in parts)
            )
        return self._sizes[routine]

    def _tree(self) -> Iterator[CallPath]:
        """Yield every path, each routine before its callees, in the layout of `call_offsets`."""
        top = CallPath((self.symbol,), {each: each for each in self.arrays}, Offset(0, 0))
        yield from self._below(top)

    def _below(self, path: CallPath) -> Iterator[CallPath]:
        yield path
        routine, first = path.routines[-1], path.first
        calls = self.costs.calls.get(routine, ())
        for call, offset in dict(zip(calls, self.call_offsets(routine), strict=True)).items():
            arrays = {taker: path.arrays[giver] for taker, giver in call.arrays}
            begin = Offset(first.counter + offset.counter, first.site + offset.site)
            yield from self._below(CallPath((*path.routines, call.callee), arrays, begin))

    def _flat(self) -> Iterator[CallPath]:
        """Yield one path to each routine, the first one found."""
        waiting = [CallPath((self.symbol,), {each: each for each in self.arrays}, Offset(0, 0))]
        at, known = Offset(0, 0), {self.symbol}
        while waiting:
            path = waiting.pop(0)
            routine = path.routines[-1]
            yield CallPath(path.routines, path.arrays, at)
            size = self._own_size(routine)
            at = Offset(at.counter + size.counter, at.site + size.site)
            for call in self.costs.calls.get(routine, ()):
                if call.callee not in known:
                    known.add(call.callee)
                    arrays = {taker: path.arrays[giver] for taker, giver in call.arrays}
                    waiting.append(CallPath((*path.routines, call.callee), arrays, at))
