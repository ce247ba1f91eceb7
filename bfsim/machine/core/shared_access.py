"""What a core does with a shared variable in L2 besides kernels: TESTSET, and the store that gives a lock back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bfsim.kernel import Work
from bfsim.machine.bus.bus import Bus


class SharedAccess:
    """One access of core `number` to a shared variable, in an instruction of `issue_cclk` cycles: run as a kernel call is."""

    stays_in_l1 = False

    def __init__(self, bus: Bus, number: int, kind: int, issue_cclk: int, asks_cclk: int) -> None:
        """`kind`: what it is in the log of accesses. `asks_cclk`: the cycle of its instruction at which it asks for its memory."""
        self._bus = bus
        self._number = number
        self._kind = kind
        self._issue_cclk = issue_cclk
        self._asks_cclk = asks_cclk

    def run(self, arguments: Sequence[Any]) -> Work:  # noqa: ARG002
        """Log the access, and say what it costs besides its memory."""
        entries = self._bus.logs.log_in_l2(self._number, self._asks_cclk, self._kind)
        return Work(self._issue_cclk, 0, accesses=entries)
