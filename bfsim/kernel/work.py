"""`Work`: what one kernel call cost and touched. The one type in which `kernel/` and `machine/` meet."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.followers import Follower
from bfsim.kernel.jit import Compiled


class Work(NamedTuple):
    """One kernel call, done natively: pixels are written already, time has not passed yet.

    `value` is what the kernel returned. `accesses` counts its accesses outside L1 by class, in the order of
    `followers.Access`, or is None when every array lies in L1.
    """

    issue_cclk: int
    value: int | None
    accesses: list[int] | None


class PreparedCall:
    """A kernel bound to its arrays: only the integers change from call to call.

    Binding once and calling often keeps the cost of a call from Python near a microsecond.
    """

    __slots__ = (
        "_arguments", "_at", "_entry", "_follower", "_has_value", "_integers", "_totals_at", "_value_slot",
        "calls", "totals",
    )  # fmt: skip

    def __init__(
        self,
        compiled: Compiled,
        arrays: Sequence[tuple[int, int, int]],
        integers: Sequence[int],
        *,
        has_value: bool,
        follower: Follower | None,
        totals: NDArray[np.int64],
    ) -> None:
        """`arrays`: (slot, host address, length); `integers`: slots; `totals`: one word per counter, added to."""
        slots = 2 * len(arrays) + len(integers)
        self._value_slot = slots + (follower is not None)
        self._arguments = (ctypes.c_int64 * (self._value_slot + 1))()
        for slot, address, length in arrays:
            self._arguments[slot], self._arguments[slot + 1] = address, length
        if follower:
            self._arguments[slots] = follower.address()
        self._integers = tuple(integers)
        self._entry = compiled.entry
        self._at = ctypes.addressof(self._arguments)
        self._follower = follower
        self._has_value = has_value
        self.totals = totals
        self._totals_at = totals.ctypes.data
        self.calls = 0

    def run(self, integers: Sequence[int] = ()) -> Work:
        """Run the kernel now and say what it cost."""
        for slot, integer in zip(self._integers, integers, strict=True):
            self._arguments[slot] = integer
        issue_cclk = self._entry(self._at, self._totals_at)
        self.calls += 1
        value = self._arguments[self._value_slot] if self._has_value else None
        return Work(issue_cclk, value, self._follower.take_counts() if self._follower else None)
