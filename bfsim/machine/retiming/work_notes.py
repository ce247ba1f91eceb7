"""Notes of what one core has done since its last picture: `FrameWork` in the making."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.calls import access_log as log
from bfsim.machine.bus import state as w
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.memories import Row
from bfsim.machine.retiming.work import (
    ACCESS_COLUMNS,
    COPY_COLUMNS,
    OPERATION_COLUMNS,
    FrameWork,
    Place,
    Table,
)
from bfsim.trace import REST

Entries = NDArray[np.int64]


class WorkNotes:
    """Operations, accesses and calls of firmware, in order. Copies and accounts keep their numbers from frame to frame."""

    def __init__(self, core: str, owners: MemoryOwners) -> None:
        self._core = core
        self._owners = owners
        self._accounts: dict[str, int] = {}
        self._stages = {REST: 0}
        self._copies: dict[tuple[int, ...], int] = {}
        self._events = np.zeros(0, np.int64)
        self._begin()

    def _begin(self) -> None:
        self._operations: list[Table] = []
        self._single: list[tuple[int, ...]] = []  # operations after these
        self._accesses: list[tuple[Entries, Entries]] = []
        self._counted: list[Table] = []
        self._calls: list[tuple[str, tuple[Any, ...]]] = []
        self._new_accounts: list[str] = []
        self._new_stages: list[str] = []
        self._results: dict[str, int] = {}
        self._new_copies: list[tuple[int, ...]] = []

    def add(self, kind: int, one: int = 0, two: int = 0, three: int = 0, four: int = 0) -> None:
        """Note one operation."""
        self._single.append((kind, one, two, three, four))

    def add_all(self, operations: Table) -> None:
        """Note operations, row by row."""
        self._end_single()
        self._operations.append(operations)

    def _end_single(self) -> None:
        if self._single:
            self._operations.append(np.array(self._single, np.int64))
            self._single = []

    def add_accesses(self, entries: Entries, sites: Entries) -> None:
        """Note accesses of the operations to come, since the core's log may forget them."""
        self._accesses.append((entries.copy(), sites.copy()))

    def add_mark(self, events: NDArray[np.int64]) -> None:
        """Note the kernels' counts up to the next mark, whose operation is noted separately."""
        since = events.copy()
        since[: len(self._events)] -= self._events
        counters = np.flatnonzero(since)
        self._counted.append(
            np.column_stack([np.full(len(counters), len(self._counted)), counters, since[counters]])
        )
        self._events = events.copy()

    def add_call(self, name: str, arguments: tuple[Any, ...]) -> None:
        """Note a call of firmware, which is a mark."""
        self._calls.append((name, arguments))

    def publish(self, results: Mapping[str, int]) -> None:
        """Note results that are published for the frame."""
        self._results.update({name: int(each) for name, each in results.items()})

    def account(self, owner: str) -> int:
        """Return the number of an account."""
        return _number(owner, self._accounts, self._new_accounts)

    def stage(self, name: str) -> int:
        """Return the number of a stage."""
        return _number(name, self._stages, self._new_stages)

    @property
    def accounts(self) -> int:
        """Number of accounts."""
        return len(self._accounts)

    def copy(self, stream: int, source: Row, destination: Row) -> int:
        """Return the number of a copy by one of the core's streams."""
        copy = stream, *self._byte(source), *self._byte(destination), source.nbytes
        if copy not in self._copies:
            self._copies[copy] = len(self._copies)
            self._new_copies.append(copy)
        return self._copies[copy]

    def place(self, row: Row) -> Place:
        """Return the place of a row."""
        return Place(*self._byte(row), row.nbytes)

    def _byte(self, row: Row) -> tuple[int, int]:
        owner = self._owners.of(row.offset)
        return owner, row.offset - self._owners.first[owner]

    def take(self) -> FrameWork:
        """Return what was noted, and begin anew."""
        self._end_single()
        work = FrameWork(
            core=self._core,
            operations=_joined(_together(self._operations, OPERATION_COLUMNS)),
            accesses=self._by_owner(),
            events=_together(self._counted, 3),
            copies=_together(self._new_copies, COPY_COLUMNS),
            calls=tuple(self._calls),
            accounts=tuple(self._new_accounts),
            stages=tuple(self._new_stages),
            results=self._results,
        )
        self._begin()
        return work

    def _by_owner(self) -> NDArray[np.uint32]:
        """Return the accesses as rows of `FrameWork.accesses`."""
        entries, sites = (
            np.concatenate([each[side] for each in self._accesses] or [np.zeros(0, np.int64)])
            for side in (0, 1)
        )
        offsets, kinds = entries & log.OFFSET_MASK, entries >> log.KIND_BIT & log.KIND_MASK
        owners = np.where(kinds == log.FETCHES, w.NO_BUFFER_IN_SDRAM, self._owners.of_all(offsets))
        columns = np.empty((ACCESS_COLUMNS, len(entries)), np.uint32)
        columns[:] = (
            entries >> log.STAMP_BIT, kinds, owners,
            offsets - np.array(self._owners.first)[owners], sites,
        )  # fmt: skip
        return columns.T


def _number(name: str, numbers: dict[str, int], new: list[str]) -> int:
    """Return the number of a name, a new one if it has none yet."""
    if name not in numbers:
        numbers[name] = len(numbers)
        new.append(name)
    return numbers[name]


def _together(tables: Sequence[Any], columns: int) -> Table:
    return np.vstack([np.zeros((0, columns), np.int64), *tables])


def _joined(operations: Table) -> Table:
    """Return the operations with consecutive calls in L1 merged into one."""
    runs = operations[:, 0] == w.RUN
    firsts = np.flatnonzero(~np.append(False, runs[1:] & runs[:-1])[: len(runs)])
    joined = operations[firsts]
    if len(firsts):
        joined[:, 1:3] = np.add.reduceat(operations[:, 1:3], firsts)
    return joined
