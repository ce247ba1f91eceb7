"""Waits for pictures and for the other core, which are no work of a core. All else keeps it busy, stalls included."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol

from bfsim.trace import StallReason


class Cycles(Protocol):
    """Cycles of any kind of owner: issue + stall + idle add up to all."""

    @property
    def issue_cclk(self) -> int:
        """Work."""

    @property
    def stall_cclk(self) -> Mapping[StallReason, int]:
        """Stalls by reason."""

    @property
    def idle_cclk(self) -> int:
        """Waits for pictures."""


def other_core_cclk(*costs: Cycles) -> int:
    """Return the time of waits for the other core."""
    return sum(each.stall_cclk.get(StallReason.SEMAPHORE, 0) for each in costs)


def waiting_cclk(*costs: Cycles) -> int:
    """Return the time of waits for pictures and for the other core."""
    return sum(each.idle_cclk for each in costs) + other_core_cclk(*costs)


def busy_cclk(costs: Iterable[Cycles]) -> int:
    """Return all other cycles."""
    found = list(costs)
    used = sum(each.issue_cclk + sum(each.stall_cclk.values()) for each in found)
    return used - other_core_cclk(*found)
