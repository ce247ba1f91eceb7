"""The kernel calls of one core: prepared once per set of rows, counted per stage, reported per source line."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

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


class CallBook:
    """Runs kernels for one core, and counts them under the stage that was entered last."""

    def __init__(
        self, core: str, profile: CompilerProfile, follower: Follower, sdram: Sdram, *, sanitize: bool
    ) -> None:
        self._core = core
        self._profile = profile
        self._follower = follower
        self._sdram = sdram
        self._sanitize = sanitize
        self._groups: dict[tuple[str, Kernel, tuple[str, ...]], CallGroup] = {}
        self._prepared: dict[tuple[str, Kernel, object], PreparedCall] = {}
        self._repeated: dict[str, dict[tuple[Kernel, object], PreparedCall]] = {}
        self.enter(REST)

    def enter(self, stage: str) -> None:
        """Count the calls from now on under `stage`."""
        self.stage = stage
        # calls without integers on rows in L1, as most are: known by their arguments, checked at the first time
        self._known = self._repeated.setdefault(stage, {})

    def run(self, kernel: Kernel, arguments: tuple[Row | int, ...]) -> Work:
        """Run `kernel` now. Rows outside of this core's L1 are followed access by access."""
        try:
            call = self._known.get((kernel, arguments))
        except TypeError:  # an array of the firmware's own, which nothing can be known by
            self._prepare(kernel, arguments)
            raise
        return call.run(arguments) if call else self._run_checked(kernel, arguments)

    def _run_checked(self, kernel: Kernel, arguments: tuple[Row | int, ...]) -> Work:
        kernel.check(arguments)
        key = (self.stage, kernel, kernel.arrays_of(arguments))
        call = self._prepared.get(key)
        if call is None:
            call = self._prepared[key] = self._prepare(kernel, arguments)
        if self._sanitize:
            kernel.sanitize([each.array if isinstance(each, Row) else each for each in arguments])
        if call.is_followed:
            return self._followed(call, arguments)
        if not kernel.integer_positions and not self._sanitize:
            self._known[kernel, arguments] = call
        return call.run(arguments)

    def _followed(self, call: PreparedCall, arguments: tuple[Row | int, ...]) -> Work:
        """Run a call that sees and changes the open pages of the SDRAM."""
        pages = self._sdram.open_pages
        self._follower.open_pages[: len(pages)] = pages
        work = call.run(arguments)
        pages[:] = self._follower.open_pages[: len(pages)].tolist()
        return work

    def groups(self) -> Iterable[CallGroup]:
        """Return every group of calls, in the order of their first call."""
        return self._groups.values()

    def _prepare(self, kernel: Kernel, arguments: tuple[Row | int, ...]) -> PreparedCall:
        rows = []
        for position in kernel.array_positions:
            row = arguments[position]
            if not isinstance(row, Row):
                name = kernel.function.parameters[position].name
                raise KernelError(
                    f"{name} must be a row of a placed buffer, not {row!r} (kernel {kernel.name}, {kernel.place})"
                )
            rows.append(row)
        followed = any([self._is_followed(each) for each in rows])
        group = self._group(kernel, tuple(each.memory for each in rows), followed)
        arrays = [each.array for each in rows]
        return kernel.prepare(group.code, arrays, group.totals, self._follower if followed else None)

    def _is_followed(self, row: Row) -> bool:
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

    def _group(self, kernel: Kernel, memories: tuple[str, ...], followed: bool) -> CallGroup:
        key = (self.stage, kernel, memories)
        if key not in self._groups:
            code = kernel.compiled(self._profile, followed=followed)
            self._groups[key] = CallGroup(self.stage, kernel, memories, code, code.new_totals())
        return self._groups[key]
