"""How often a kernel's instructions ran: each call of it, or of a possible caller, is repeated by its object code."""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.assembly.finding import KernelCode
from bfsim.blackfin.control_flow.edge_counts import CountedEvent
from bfsim.kernel import Kernel
from bfsim.kernel.objects.calls import ObjectCall
from bfsim.kernel.objects.compiled import CompiledObject
from bfsim.machine.memories import Row


@dataclass(slots=True)
class _Caller:
    """A kernel whose calls may reach the one that is counted. `calls`: bound to arrays, by their lengths."""

    kernel: Kernel
    compiled: CompiledObject
    totals: NDArray[np.int64]
    calls: dict[tuple[int, ...], tuple[ObjectCall, list[NDArray[Any]]]] = field(default_factory=dict)

    def play(self, arguments: Sequence[Row | int]) -> None:
        """Make a call on copies."""
        arrays = [each.array for each in arguments if isinstance(each, Row)]
        lengths = tuple(map(len, arrays))
        if lengths not in self.calls:
            copies = [each.copy() for each in arrays]
            self.calls[lengths] = (
                ObjectCall(self.compiled, copies, self.kernel.arguments.check, self.totals),
                copies,
            )
        call, copies = self.calls[lengths]
        for copy, array in zip(copies, arrays, strict=True):
            copy[:] = array
        call.run(*(each.array if isinstance(each, Row) else each for each in arguments))

    def events(self) -> Tally[CountedEvent]:
        """Return how often each event was counted."""
        counters = self.compiled.subroutine.translated.counted.counters
        found: Tally[CountedEvent] = Tally()
        for counter, count in zip(counters, self.totals.tolist(), strict=False):
            found[CountedEvent(counter.block.start, counter.taken, counter.along)] += count
        return found


@dataclass(slots=True)
class Counting:
    """Counts what the calls of a run do in the code of a kernel. A run must call `see` before each call."""

    code: KernelCode
    _callers: dict[Kernel, _Caller | None] = field(default_factory=dict)

    def see(self, kernel: Kernel, arguments: Sequence[Row | int]) -> None:
        """Note a call."""
        if kernel not in self._callers:
            self._callers[kernel] = self._caller(kernel)
        caller = self._callers[kernel]
        if caller is not None:
            caller.play(arguments)

    def events(self) -> Tally[CountedEvent]:
        """Return how often each block ran, each branch and each counted edge was taken, in the kernel and its callers."""
        found: Tally[CountedEvent] = Tally()
        for each in self._callers.values():
            if each is not None:
                found.update(each.events())
        return found

    def _caller(self, kernel: Kernel) -> _Caller | None:
        """Return a caller, or None for a kernel that never reaches the one that is counted: most are not even translated."""
        if self.code.kernel.function not in (kernel.function, *kernel.function.callees()):
            return None
        compiled = self.code.compiled_of(kernel)
        if compiled is None or self.code.routine.address not in compiled.subroutine.translated.code.blocks:
            return None
        return _Caller(kernel, compiled, compiled.new_totals())
