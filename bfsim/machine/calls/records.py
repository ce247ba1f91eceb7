"""The counts of one core's kernels → records: per kernel and source line, per buffer, and per path of calls."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property, partial

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.costs.call_paths import Offset
from bfsim.kernel.host_code.jit import CompiledKernel
from bfsim.kernel.ir.text import SourceLine
from bfsim.kernel.language.function import Function
from bfsim.machine.calls.groups import CallGroup
from bfsim.machine.calls.ledger import FILLS, Counted, stalls_by_reason
from bfsim.trace import AccessRecord, KernelRecord, LineCost, PathRecord

Stalls = NDArray[np.int64]


def _no_stalls() -> Stalls:
    return np.zeros(FILLS, np.int64)


@dataclass(slots=True)
class _Cost:
    """Sums of cycles. `stalls` are those at sites."""

    issue_cclk: int = 0
    interlocks_cclk: int = 0
    stalls: Stalls = field(default_factory=_no_stalls)


@dataclass(slots=True)
class _Accesses:
    """Sums of the accesses of one line to one buffer."""

    reads: int = 0
    writes: int = 0
    fills: int = 0
    stalls: Stalls = field(default_factory=_no_stalls)


@dataclass(slots=True)
class _Kernel:
    """Sums of one kernel in one stage, by line."""

    function: Function
    calls: int = 0
    object_cclk: int = 0
    executions: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    lines: dict[int, _Cost] = field(default_factory=lambda: defaultdict(_Cost))
    operations: dict[int, dict[str, tuple[int, int]]] = field(default_factory=lambda: defaultdict(dict))
    accesses: dict[tuple[int, int], _Accesses] = field(default_factory=lambda: defaultdict(_Accesses))
    """By line and owner of the memory."""


@dataclass(slots=True)
class _Path:
    """Sums of one path of calls in one stage."""

    calls: int = 0
    cost: _Cost = field(default_factory=_Cost)


class CoreRecords:
    """The records of one core, made on demand from its groups of calls and the counts at one moment.

    `buffers` are the names of the owners of memory, by number.
    """

    def __init__(
        self, core: str, groups: Sequence[CallGroup], counted: Counted, buffers: Sequence[str]
    ) -> None:
        self._core = core
        self._groups = groups
        self._counted = counted
        self._buffers = buffers

    def kernels(self) -> Iterator[KernelRecord]:
        """Yield one record per stage and kernel."""
        for (stage, symbol), each in self._sums.kernels.items():
            function, first = each.function, each.function.first_line
            costs = each.lines.values()
            yield KernelRecord(
                core=self._core,
                stage=stage,
                kernel=function.name,
                symbol=symbol,
                file=function.file,
                first_line=first,
                text=tuple(function.lines),
                calls=each.calls,
                issue_cclk=sum(cost.issue_cclk for cost in costs),
                stall_cclk=stalls_by_reason(
                    sum(cost.interlocks_cclk for cost in costs), _sum(cost.stalls for cost in costs)
                ),
                lines=tuple(
                    LineCost(
                        line=first + line - 1,
                        executions=each.executions[line],
                        issue_cclk=cost.issue_cclk,
                        stall_cclk=stalls_by_reason(cost.interlocks_cclk, cost.stalls.tolist()),
                        operations={name: both for name, both in each.operations[line].items() if any(both)},
                    )
                    for line, cost in sorted(each.lines.items())
                ),
                object_cclk=each.object_cclk,
            )

    def accesses(self) -> Iterator[AccessRecord]:
        """Yield one record per stage, kernel, line and buffer."""
        for (stage, symbol), kernel in self._sums.kernels.items():
            for (line, owner), each in sorted(kernel.accesses.items()):
                yield AccessRecord(
                    core=self._core,
                    stage=stage,
                    symbol=symbol,
                    line=kernel.function.first_line + line - 1,
                    buffer=self._buffers[owner],
                    reads=each.reads,
                    writes=each.writes,
                    fills=each.fills,
                    stall_cclk=stalls_by_reason(0, each.stalls.tolist()),
                )

    def paths(self) -> Iterator[PathRecord]:
        """Yield one record per stage and path of calls."""
        for (stage, path), each in self._sums.paths.items():
            yield PathRecord(
                core=self._core,
                stage=stage,
                path=path,
                calls=each.calls,
                issue_cclk=each.cost.issue_cclk,
                stall_cclk=stalls_by_reason(each.cost.interlocks_cclk, each.cost.stalls.tolist()),
            )

    def issue_cclk(self, *, of_objects: bool = False) -> int:
        """Return the issue cycles of all calls, or of those that ran as object code, faster than through the records."""
        total = 0
        for group, events in _counted(self._groups, self._counted):
            if not of_objects or _is_object(group):
                _, counter, _, costs = group.code.tables.costs
                _, issue_cclk, _ = costs.T
                total += int(events[counter].dot(issue_cclk))
        return total

    @cached_property
    def _sums(self) -> _Sums:
        return _Sums(self._groups, self._counted)


def object_share(cores: Sequence[CoreRecords]) -> float:
    """Return the share of object code in the kernels' issue cycles."""
    of_objects = sum(each.issue_cclk(of_objects=True) for each in cores)
    return of_objects / sum(each.issue_cclk() for each in cores) if of_objects else 0.0


def _is_object(group: CallGroup) -> bool:
    return not isinstance(group.code, CompiledKernel)


def _counted(groups: Iterable[CallGroup], counted: Counted) -> Iterator[tuple[CallGroup, NDArray[np.int64]]]:
    """Yield the groups with the events of their counters. Groups added after the counted moment are left out."""
    for group in groups:
        if group.first_event < len(counted.events):
            yield group, counted.events[group.first_event :][: group.code.tables.counters]


class _Sums:
    """Sums over the groups: `kernels` by stage and symbol, `paths` by stage and symbols."""

    def __init__(self, groups: Iterable[CallGroup], counted: Counted) -> None:
        self.kernels: dict[tuple[str, str], _Kernel] = {}
        self.paths: dict[tuple[str, tuple[str, ...]], _Path] = defaultdict(_Path)
        for group, events in _counted(groups, counted):
            self._add_events(group, events.tolist())
            self._add_stalls(group, counted.sites[group.first_site :])

    def _kernel(self, group: CallGroup, symbol: str) -> _Kernel:
        key = (group.stage, symbol)
        if key not in self.kernels:
            self.kernels[key] = _Kernel(next(each for each in group.code.functions if each.symbol == symbol))
        return self.kernels[key]

    def _add_events(self, group: CallGroup, totals: Sequence[int]) -> None:
        program, owner_of = group.code.program, group.by_array(group.owners)
        is_object = _is_object(group)
        kernel_of = cache(partial(self._kernel, group))
        executions: dict[tuple[Offset, SourceLine], int] = {}
        for number, path, counter in program.counted:
            events = totals[number]
            for each in counter.enters:
                kernel_of(each.symbol).calls += events
                self.paths[group.stage, program.entered(path, each)].calls += events
            for place, issue_cclk, stall_cclk in counter.line_cclk:
                through = self.paths[group.stage, program.through(path, place)]
                kernel = kernel_of(place.routine)
                kernel.object_cclk += events * issue_cclk * is_object
                for cost in (kernel.lines[place.line], through.cost):
                    cost.issue_cclk += events * issue_cclk
                    cost.interlocks_cclk += events * stall_cclk
                if counter.value is None:
                    once = (path.first, place)
                    executions[once] = max(executions.get(once, 0), events)
            for place, name, times, cclk in counter.line_operations if events else ():
                operations = kernel_of(place.routine).operations[place.line]
                had_times, had_cclk = operations.get(name, (0, 0))
                operations[name] = had_times + events * times, had_cclk + events * cclk
            for access in counter.accesses:
                owner = owner_of.get(path.arrays.get(access.array, ""))
                if owner is not None and access.is_counted:
                    sums = kernel_of(access.line.routine).accesses[access.line.line, owner]
                    sums.reads += 0 if access.writes else access.times(events)
                    sums.writes += access.times(events) if access.writes else 0
        for (_, place), events in executions.items():
            kernel_of(place.routine).executions[place.line] += events

    def _add_stalls(self, group: CallGroup, rows: Stalls) -> None:
        for site, row in zip(group.sites(), rows, strict=False):
            if row.any():
                kernel, stalls = self._kernel(group, site.line.routine), row[:FILLS]
                kernel.lines[site.line.line].stalls += stalls
                self.paths[group.stage, site.path].cost.stalls += stalls
                accesses = kernel.accesses[site.line.line, site.owner]
                accesses.stalls += stalls
                accesses.fills += int(row[FILLS])


def _sum(rows: Iterable[Stalls]) -> list[int]:
    total: list[int] = sum(rows, _no_stalls()).tolist()
    return total
