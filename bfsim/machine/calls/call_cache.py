"""The kernel calls of one core: prepared once per set of rows, counted per stage, reported per source line."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from dataclasses import dataclass
from typing import Protocol

from bfsim.errors import FirmwareError, KernelError
from bfsim.kernel import CompilerProfile, Kernel, Work
from bfsim.kernel.access_trace import AccessTrace
from bfsim.machine.calls.conflicts import SubBanks
from bfsim.machine.calls.fetch import CodeOutside, FetchedCall
from bfsim.machine.calls.groups import CallGroup
from bfsim.machine.memories import Row
from bfsim.trace import REST


class BoundCall(Protocol):
    """A kernel bound to its rows, ready to run."""

    @property
    def stays_in_l1(self) -> bool:
        """Whether neither its accesses nor its code can leave L1."""

    def run(self, arguments: tuple[Row | int, ...]) -> Work:
        """Run the kernel now and say what it cost."""


@dataclass(frozen=True, slots=True)
class CheckedCall:
    """A call that is checked before it runs."""

    call: BoundCall
    kernel: Kernel

    @property
    def stays_in_l1(self) -> bool:
        """Whether neither its accesses nor its code can leave L1."""
        return self.call.stays_in_l1

    def run(self, arguments: tuple[Row | int, ...]) -> Work:
        """Run the kernel, if its indexes are right, and say what it cost."""
        self.kernel.sanitize([each.array if isinstance(each, Row) else each for each in arguments])
        return self.call.run(arguments)


class DeferredWork(Work):
    """A call that is still to be made, with `run`."""

    __slots__ = ("_arguments", "_call")

    def __init__(self, call: BoundCall, arguments: tuple[Row | int, ...]) -> None:
        super().__init__(0, 0)
        self._call = call
        self._arguments = arguments

    def run(self) -> Work:
        """Run the kernel now and say what it cost."""
        return self._call.run(self._arguments)


class CallCache:
    """Runs kernels for one core, and counts them under the stage that was entered last."""

    def __init__(
        self,
        core: str,
        profile: CompilerProfile,
        access_trace: AccessTrace,
        code: CodeOutside,
        subbanks: SubBanks,
        *,
        sanitize: bool,
    ) -> None:
        self._core = core
        self._profile = profile
        self._access_trace = access_trace
        self._code = code
        self._subbanks = subbanks
        self._sanitize = sanitize
        self._groups: dict[tuple[str, Kernel, tuple[str, ...]], CallGroup] = {}
        self._calls: dict[str, dict[tuple[Kernel, object], BoundCall]] = {}
        self.enter(REST)

    def enter(self, stage: str) -> None:
        """Count the calls from now on under `stage`."""
        self.stage = stage
        self.known = self._calls.setdefault(stage, {})
        """Calls of this stage by kernel and rows, ready to run."""

    def conflicts_cclk(self, elapsed_cclk: int) -> int:
        """Return what conflicts in L1 cost the present stage in its `elapsed_cclk`, since it was asked last."""
        return self._subbanks.since(
            (each for each in self._groups.values() if each.stage == self.stage), elapsed_cclk
        )

    def prepare(self, kernel: Kernel, arguments: tuple[Row | int, ...]) -> BoundCall:
        """Prepare a call for the first time, and know it from now on. Rows outside of L1 are traced."""
        if not isinstance(kernel, Kernel):
            name = getattr(kernel, "__name__", repr(kernel))
            raise FirmwareError(f"core.run must get a function with @kernel before it, not {name}")
        call = self.known[kernel, kernel.arrays_of(arguments)] = self._prepared(kernel, arguments)
        return call

    def groups(self) -> Iterable[CallGroup]:
        """Return every group of calls, in the order of their first call."""
        return self._groups.values()

    def _prepared(self, kernel: Kernel, arguments: tuple[Row | int, ...]) -> BoundCall:
        for each in arguments:
            if isinstance(each, Generator):
                wait = f"{getattr(each, '__name__', 'wait')}(...)"
                raise FirmwareError(
                    f"kernel {kernel.name} must get what a wait gives, `(yield from {wait})`, not the wait `{wait}`"
                )
        kernel.check(arguments)
        rows = []
        for position in kernel.array_positions:
            row = arguments[position]
            if not isinstance(row, Row):
                name = kernel.function.parameters[position].name
                raise KernelError(
                    f"{name} must be a row of a placed buffer, not {row!r} (kernel {kernel.name}, {kernel.place})"
                )
            rows.append(row)
        traced = sum(map(self._is_traced, rows)) > 0  # of every row, since some cannot be reached at all
        group = self._group(kernel, tuple(each.memory for each in rows), traced)
        for seen, row in zip(group.subbanks, rows, strict=True):
            seen.update(self._subbanks.of(row))
        access_trace = self._access_trace if traced else None
        call: BoundCall = kernel.prepare(
            group.code, [each.array for each in rows], group.totals, access_trace
        )
        if outside := self._code.of(group.code.counters):
            call = FetchedCall(
                call, outside, group.code.counters, group.totals, self._access_trace, self._code.cache
            )
        return CheckedCall(call, kernel) if self._sanitize else call

    def _is_traced(self, row: Row) -> bool:
        """Whether accesses to `row` take longer than one cycle. Another core's L1 cannot be reached at all."""
        if not row.memory.startswith("CORE"):
            return True
        if (
            not row.memory.startswith(f"CORE{self._core}_L1_DATA")
            and row.memory != f"CORE{self._core}_SCRATCH"
        ):
            raise FirmwareError(
                f"core {self._core} cannot load or store {row.buffer}, which is in {row.memory}"
            )
        return False

    def _group(self, kernel: Kernel, memories: tuple[str, ...], traced: bool) -> CallGroup:
        key = (self.stage, kernel, memories)
        if key not in self._groups:
            code = kernel.compile(self._profile, traced=traced)
            self._groups[key] = CallGroup(
                self.stage, kernel, memories, code, code.new_totals(), [set() for _ in memories]
            )
        return self._groups[key]
