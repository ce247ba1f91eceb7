"""The kernel calls of one core: prepared once per set of rows, counted per stage, reported per source line."""

from __future__ import annotations

from collections.abc import Callable, Collection, Generator
from dataclasses import dataclass, replace
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError, KernelError, shown
from bfsim.kernel import Kernel, Work
from bfsim.kernel.build import Build
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.kernel.objects.loaded_files import LoadedFiles
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.calls.conflicts import Accesses, StageGroups, SubBanks
from bfsim.machine.calls.fetch import CodeOutside
from bfsim.machine.calls.groups import CallGroup
from bfsim.machine.calls.ledger import FrameCounts, Ledger
from bfsim.machine.calls.ready_calls import ReadyCalls
from bfsim.machine.calls.records import CoreRecords
from bfsim.machine.calls.watched_call import BeforeCall, WatchedCall
from bfsim.machine.memories import Row
from bfsim.machine_code.calling import words_at
from bfsim.trace import REST
from bfsim.trace.owner_costs import Owner


def _nobody(kernel: Kernel, arguments: tuple[Row | int, ...]) -> None:
    """Ignore the call."""


@dataclass(frozen=True, slots=True)
class KnownCall:
    """The kernel `name` bound to its rows, ready to run, with its `number` among the calls of its core.

    `words` is the address by which machine code runs it, 0 if only Python can.
    `stays_in_l1` says whether all its accesses and its code stay in L1; `is_alone`, whether outside L1 it accesses only buffers that
    belong to its core alone, permanently or `handed_over` at the time. Code is read-only, so it does not matter for that.
    """

    name: str
    number: int
    run: Callable[..., Work]
    words: int
    stays_in_l1: bool
    is_alone: bool
    handed_over: tuple[str, ...]


class _CallOnRows(NamedTuple):
    """A call as it is counted: its group, its rows, those of them outside L1, and the stack if it is outside.

    `is_traced` says whether its code reports accesses.
    """

    group: CallGroup
    rows: list[Row]
    outside: list[Row]
    stack: NDArray[np.uint8] | None
    is_traced: bool

    @property
    def stays_in_l1(self) -> bool:
        """Whether all its accesses and its code stay in L1."""
        return not (self.outside or self.stack is not None or self.group.fetched)


KernelCalls = tuple[Callable[[tuple[Row | int, ...]], object], dict[object, KnownCall]]
"""A function that picks the rows out of a kernel's arguments, and the kernel's calls by these rows."""


class DeferredWork(Work):
    """A call that has yet to be made, with `run`."""

    __slots__ = ("_arguments", "_call")

    def __init__(self, call: KnownCall, arguments: tuple[Row | int, ...]) -> None:
        super().__init__(0, 0)
        self._call = call
        self._arguments = arguments

    def run(self) -> Work:
        """Run the kernel now and return its cost."""
        return self._call.run(*self._arguments)


class CallCache:
    """Runs kernels for one core, and counts them under the stage that was entered last."""

    def __init__(
        self,
        core: str,
        build: Build,
        access_trace: AccessTrace,
        code: CodeOutside,
        subbanks: SubBanks,
        owners: MemoryOwners,
        ledger: Ledger,
        *,
        memory: NDArray[np.uint8],
        stack: NDArray[np.uint8] | None = None,
        own: Collection[str],
        handed_over: Collection[str],
        before_call: tuple[BeforeCall, ...],
        in_first_frame: tuple[BeforeCall, ...],
    ) -> None:
        """All rows lie in `memory`. `stack` is the memory of the core's stack if that is outside L1. Only this core works on its `own` buffers.

        Only one core at a time works on `handed_over` ones. `before_call` is called before each call, `in_first_frame` only in the first frame.
        """
        self._core = core
        self._build = build
        self._files = LoadedFiles()
        self._access_trace = access_trace
        self._code = code
        self._subbanks = subbanks
        self._own = own
        self._handed_over = handed_over
        self._before_call = before_call
        self._in_first_frame = in_first_frame
        self._owners = owners
        self._ledger = ledger
        self._memory = memory
        self._stack = stack
        self._groups: dict[tuple[str, Kernel, tuple[int, ...]], CallGroup] = {}
        self._in_stage: dict[str, StageGroups] = {}
        self._calls: dict[str, dict[Kernel, KernelCalls]] = {}
        self.ready = ReadyCalls()
        """The calls that machine code finds."""
        self.made: list[KnownCall] = []
        """The prepared calls, by number."""
        self.on_prepared: BeforeCall = _nobody
        """Called with each call that is prepared."""
        self.enter(REST)

    def enter(self, stage: str) -> None:
        """Count the calls from now on under `stage`."""
        self.stage = stage
        self.groups_in(stage)
        self.known = self._calls.setdefault(stage, {})
        """Calls of this stage by kernel, ready to run."""
        self.ready.enter(stage)

    def accessed(self) -> Accesses:
        """Return what the calls of the current stage have accessed in L1 since the last call of this."""
        return self._in_stage[self.stage].accessed(self._ledger.events_at)

    def groups_in(self, stage: str) -> StageGroups:
        """Return the groups of calls of a stage."""
        if stage not in self._in_stage:
            self._in_stage[stage] = StageGroups()
        return self._in_stage[stage]

    @property
    def sub_banks(self) -> SubBanks:
        """The sub-banks of L1."""
        return self._subbanks

    @property
    def conflicts_at(self) -> int:
        """The address of the costs of conflicts in L1 by site, to be added to."""
        return self._ledger.conflicts_at

    def conflicts_cclk(self, accessed: Accesses, elapsed_cclk: int) -> int:
        """Return the cost of conflicts in L1 for calls that `accessed` it in `elapsed_cclk`, all since the last call of this."""
        return self._subbanks.charge(accessed, elapsed_cclk, self._ledger.conflicts_at)

    def prepare(self, kernel: Kernel, arguments: tuple[Row | int, ...]) -> KnownCall:
        """Prepare a new call, and keep it. Rows outside L1 are traced."""
        if not isinstance(kernel, Kernel):
            name = getattr(kernel, "__name__", repr(kernel))
            raise FirmwareError(f"core.run must get a function with @kernel before it, not {name}")
        call = self._prepared(kernel, self._on_rows(kernel, arguments))
        rows_of, calls = self.known.setdefault(kernel, (kernel.arrays_of, {}))
        calls[rows_of(arguments)] = call
        self.made.append(call)
        self.on_prepared(kernel, arguments)
        return call

    def expect(self, kernel: Kernel, arguments: tuple[Row | int, ...], *, was_traced: bool) -> bool:
        """Count a call from now on that is played, not made. Return whether it stays in L1.

        With `was_traced`, some of its rows lay outside L1 when it was recorded, so its sites are numbered as in traced code.
        """
        return self._on_rows(kernel, arguments, was_traced=was_traced).stays_in_l1

    @property
    def events(self) -> NDArray[np.int64]:
        """The events that the kernels have counted, by counter."""
        return self._ledger.events

    @property
    def counters_at(self) -> tuple[int, int]:
        """The address of these counts, to be added to, and their number."""
        return self._ledger.events_at, self._ledger.event_count

    def end_first_frame(self) -> None:
        """Stop calling the functions that are called in the first frame only."""
        if not self._in_first_frame:
            return
        self._in_first_frame = ()
        for _, calls in chain.from_iterable(each.values() for each in self._calls.values()):
            for rows, call in calls.items():
                assert isinstance(call.run, WatchedCall), "somebody was told"
                run = self._watched(call.run.kernel, call.run.run)
                calls[rows] = self.made[call.number] = replace(call, run=run, words=words_at(run))

    def close(self) -> tuple[tuple[Owner, ...], NDArray[np.int64], FrameCounts]:
        """Return all kernels in each stage, their costs in the frame that ends now, and their counts in it."""
        return self._ledger.close()

    def report(self, counts: FrameCounts) -> None:
        """Report the counts of the next frame, too."""
        self._ledger.report(counts)

    def records(self) -> CoreRecords:
        """Return the records of the reported counts."""
        buffers = tuple(each.buffer for each in self._owners)
        return CoreRecords(self._core, tuple(self._groups.values()), self._ledger.reported, buffers)

    def _on_rows(
        self, kernel: Kernel, arguments: tuple[Row | int, ...], *, was_traced: bool = False
    ) -> _CallOnRows:
        """Return a call as it is counted under the current stage. Raises KernelError or FirmwareError for wrong arguments."""
        for each in arguments:
            if isinstance(each, Generator):
                wait = f"{getattr(each, '__name__', 'wait')}(...)"
                raise FirmwareError(
                    f"kernel {kernel.name} must get what a wait gives, `(yield from {wait})`, not the wait `{wait}`"
                )
        kernel.arguments.check(arguments)
        rows = []
        for position in kernel.array_positions:
            row = arguments[position]
            if not isinstance(row, Row):
                name = kernel.function.parameters[position].name
                got = (
                    "an array: pass the row, not its `.array`" if isinstance(row, np.ndarray) else shown(row)
                )
                raise KernelError(
                    f"{name} must be a row of a placed buffer, not {got} (kernel {kernel.name}, {kernel.place})"
                )
            rows.append(row)
        outside = [each for each in rows if self._is_traced(each)]
        stack = self._stack if self._build.has_code(kernel) else None
        is_traced = bool(outside) or stack is not None or was_traced
        group = self._group(kernel, tuple(self._owners.of(each.offset) for each in rows), is_traced)
        for seen, row in zip(group.subbanks, rows, strict=True):
            seen.update(self._subbanks.of(row))
        return _CallOnRows(group, rows, outside, stack, is_traced)

    def _prepared(self, kernel: Kernel, call: _CallOnRows) -> KnownCall:
        group, outside = call.group, call.outside
        run = kernel.prepare(
            group.code,
            [each.array for each in call.rows],
            group.totals,
            self._access_trace if call.is_traced else None,
            group.first_site,
            call.stack,
            self._memory,
        ).run
        if group.fetches:
            run = group.fetches.behind(run)
        run = self._watched(kernel, run)
        return KnownCall(
            kernel.name,
            len(self.made),
            run,
            words_at(run),
            stays_in_l1=call.stays_in_l1,
            is_alone=all(each.buffer in self._own or each.buffer in self._handed_over for each in outside),
            handed_over=tuple(
                dict.fromkeys(each.buffer for each in call.rows if each.buffer in self._handed_over)
            ),
        )

    def _watched(self, kernel: Kernel, run: Callable[..., Work]) -> Callable[..., Work]:
        """Return a call wrapped to tell its watchers first, if there are any. Machine code cannot make such a call."""
        before = *self._in_first_frame, *self._before_call
        return WatchedCall(run, kernel, before) if before else run

    def _is_traced(self, row: Row) -> bool:
        """Whether accesses to `row` take longer than one cycle. Another core's L1 is out of reach."""
        if not row.is_in_l1:
            return True
        if (
            not row.memory.startswith(f"CORE{self._core}_L1_DATA")
            and row.memory != f"CORE{self._core}_SCRATCH"
        ):
            raise FirmwareError(
                f"core {self._core} cannot load or store {row.buffer}, which is in {row.memory}"
            )
        return False

    def _group(self, kernel: Kernel, owners: tuple[int, ...], traced: bool) -> CallGroup:
        key = (self.stage, kernel, owners)
        if key not in self._groups:
            code = self._build.compiled(kernel, traced=traced, files=self._files)
            fetched = tuple(self._code.of(code.tables.routines))
            totals, first_event, first_site = self._ledger.room(
                len(code.new_totals()), len(code.tables.site_routines) + len(fetched)
            )
            self._groups[key] = CallGroup(
                stage=self.stage,
                kernel=kernel,
                owners=owners,
                fetched=fetched,
                code=code,
                totals=totals,
                first_event=first_event,
                first_site=first_site,
                subbanks=[set() for _ in owners],
            )
            if fetched:
                self._groups[key].fetches = self._code.fetches_of(self._groups[key], self._access_trace)
            self._ledger.add(self._groups[key])
            self._in_stage[self.stage].add(self._groups[key])
        return self._groups[key]
