"""The kernel calls of one core: prepared once per set of rows, counted per stage, reported per source line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError, KernelError
from bfsim.kernel import CompilerProfile, Kernel, PreparedCall, Work
from bfsim.kernel.followers import Follower
from bfsim.kernel.jit import Compiled
from bfsim.machine.memories import Row
from bfsim.machine.sdram import Sdram
from bfsim.trace import REST


@dataclass(slots=True)
class CallGroup:
    """Calls of one kernel in one stage with its arrays in the same memories. `totals`: events of each counter."""

    stage: str
    kernel: Kernel
    memories: tuple[str, ...]
    code: Compiled
    totals: NDArray[np.int64]
    calls: list[PreparedCall] = field(default_factory=list)


class CallBook:
    """Runs kernels for one core. `stage` is the row of the budget that calls are counted under."""

    def __init__(
        self, core: str, profile: CompilerProfile, follower: Follower, sdram: Sdram, *, sanitize: bool
    ) -> None:
        self.stage = REST
        self._core = core
        self._profile = profile
        self._follower = follower
        self._sdram = sdram
        self._sanitize = sanitize
        self._prepared: dict[tuple[object, ...], tuple[PreparedCall, bool]] = {}
        self._groups: dict[tuple[str, Kernel, tuple[str, ...]], CallGroup] = {}

    def run(self, kernel: Kernel, arguments: tuple[Row | int, ...]) -> Work:
        """Run `kernel` now. Rows outside of this core's L1 are followed access by access."""
        integers: Sequence[int] = ()
        rows: tuple[Row | int, ...] = arguments
        if kernel.integer_positions:
            kernel.check_count(arguments)
            integers = [kernel.check_integer(each, arguments[each]) for each in kernel.integer_positions]
            rows = tuple([arguments[each] for each in kernel.array_positions])
        found = self._prepared.get((self.stage, kernel, rows))
        if found is None:
            found = self._prepared[self.stage, kernel, rows] = self._prepare(kernel, arguments, rows)
        call, followed = found
        if self._sanitize:
            kernel.sanitize([each.array for each in rows if isinstance(each, Row)], integers)
        if not followed:
            return call.run(integers)
        self._follower.open_pages[: len(self._sdram.open_pages)] = self._sdram.open_pages
        work = call.run(integers)
        self._sdram.open_pages[:] = self._follower.open_pages[: len(self._sdram.open_pages)].tolist()
        return work

    def groups(self) -> Iterable[CallGroup]:
        """Return every group of calls, in the order of their first call."""
        return self._groups.values()

    def _prepare(
        self, kernel: Kernel, arguments: tuple[Row | int, ...], rows: tuple[Row | int, ...]
    ) -> tuple[PreparedCall, bool]:
        kernel.check_count(arguments)
        placed = []
        for position, row in zip(kernel.array_positions, rows, strict=True):
            if not isinstance(row, Row):
                name = kernel.function.parameters[position].name
                raise KernelError(
                    f"{name} must be a row of a placed buffer, not {row!r} (kernel {kernel.name}, {kernel.place})"
                )
            placed.append(row)
        followed = [self._is_followed(each) for each in placed]
        group = self._group(kernel, tuple(each.memory for each in placed), any(followed))
        follower = self._follower if any(followed) else None
        call = kernel.prepare(group.code, [each.array for each in placed], group.totals, follower)
        group.calls.append(call)
        return call, any(followed)

    def _is_followed(self, row: Row) -> bool:
        """Whether accesses to `row` take longer than one cycle. Another core's L1 cannot be reached at all."""
        if not row.memory.startswith("CORE"):
            return True
        if not row.memory.startswith(f"CORE{self._core}_L1_DATA") and row.memory != f"CORE{self._core}_SCRATCH":
            raise FirmwareError(f"core {self._core} cannot load or store {row.buffer}, which is in {row.memory}")
        return False

    def _group(self, kernel: Kernel, memories: tuple[str, ...], followed: bool) -> CallGroup:
        key = (self.stage, kernel, memories)
        if key not in self._groups:
            code = kernel.compiled(self._profile, followed=followed)
            self._groups[key] = CallGroup(self.stage, kernel, memories, code, code.new_totals())
        return self._groups[key]
