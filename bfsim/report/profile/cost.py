"""Cycles of a kind: work, stalls by reason, and idling."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from bfsim.trace import StallReason


@dataclass(slots=True)
class Cost:
    """Cycles that add up: issue + stall + idle = elapsed."""

    issue_cclk: int = 0
    stall_cclk: Counter[StallReason] = field(default_factory=Counter)
    idle_cclk: int = 0

    @property
    def stalled_cclk(self) -> int:
        """Stalls for any reason."""
        return sum(self.stall_cclk.values())

    @property
    def elapsed_cclk(self) -> int:
        """All cycles."""
        return self.issue_cclk + self.stalled_cclk + self.idle_cclk

    def add(self, issue_cclk: int, stall_cclk: Mapping[StallReason, int], idle_cclk: int = 0) -> None:
        """Add cycles of each kind."""
        self.issue_cclk += issue_cclk
        self.stall_cclk.update(stall_cclk)
        self.idle_cclk += idle_cclk

    def take(self, issue_cclk: int, stall_cclk: Mapping[StallReason, int]) -> None:
        """Subtract cycles of each kind; there must be as many."""
        self.issue_cclk -= issue_cclk
        self.stall_cclk = self.stall_cclk - Counter(stall_cclk)


def sum_of(costs: Iterable[Cost]) -> Cost:
    """Return the sum of all costs."""
    result = Cost()
    for each in costs:
        result.add(each.issue_cclk, each.stall_cclk, each.idle_cclk)
    return result
