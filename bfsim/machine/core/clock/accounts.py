"""Where a core's cycles went: an account per stage of a frame, closed into records at the frame's end.

Every cycle has an owner: kernels, which say themselves how it is split among them (`calls.ledger`), or one of those that no kernel
is, by name: a ring, a semaphore, an interrupt, the cameras.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bfsim.machine.owner_costs import COLUMN_OF, COLUMNS, IDLE, ISSUE, Owner, OwnerCosts
from bfsim.trace import REST, CoreFrame, StageCost, StallReason

KERNELS = ""
"""The owner of what kernels cost."""


class Account:
    """Cycles of one owner in one stage of a frame."""

    __slots__ = ("idle_cclk", "issue_cclk", "stall_cclk")

    def __init__(self) -> None:
        self.issue_cclk = 0
        self.idle_cclk = 0
        self.stall_cclk: dict[StallReason, int] = {}

    def stall(self, reason: StallReason, cclk: int) -> None:
        """Add cycles of a stall."""
        self.stall_cclk[reason] = self.stall_cclk.get(reason, 0) + cclk

    def write(self, row: NDArray[np.int64]) -> None:
        """Write the cycles into a row of an `OwnerCosts` table."""
        row[ISSUE], row[IDLE] = self.issue_cclk, self.idle_cclk
        for reason, cclk in self.stall_cclk.items():
            row[COLUMN_OF[reason]] = cclk


class StageAccount:
    """Cycles of one stage in one frame, by owner."""

    def __init__(self) -> None:
        self.kernels = Account()
        self._owners = {KERNELS: self.kernels}

    def of(self, owner: str) -> Account:
        """Return the account of an owner."""
        return self._owners.get(owner) or self._owners.setdefault(owner, Account())

    def cost(self, stage: str) -> StageCost:
        """Return the record of `stage`, all owners together."""
        whole = Account()
        for each in self._owners.values():
            whole.issue_cclk += each.issue_cclk
            whole.idle_cclk += each.idle_cclk
            for reason, cclk in each.stall_cclk.items():
                whole.stall(reason, cclk)
        return StageCost(
            stage=stage,
            issue_cclk=whole.issue_cclk,
            stall_cclk={reason: cclk for reason, cclk in sorted(whole.stall_cclk.items()) if cclk},
            idle_cclk=whole.idle_cclk,
        )

    def others(self) -> Iterator[tuple[str, Account]]:
        """Yield the accounts of those owners that are no kernels."""
        return ((owner, each) for owner, each in self._owners.items() if owner != KERNELS)


class FrameAccounts:
    """The accounts of one core's current frame. `now` is the account that cycles go to."""

    def __init__(self, core: str, stages: tuple[str, ...]) -> None:
        self._core = core
        self._stages = stages
        self._begin_cclk = 0
        self._kernels: tuple[Owner, ...] = ()
        self._owners: dict[
            tuple[Owner, ...], tuple[Owner, ...]
        ] = {}  # these kernels and others, by the others
        self._open()

    def _open(self) -> None:
        self._accounts = {REST: StageAccount()}
        self.now = self._accounts[REST]

    def enter(self, stage: str) -> None:
        """Let cycles go to `stage`, or to the rest."""
        self.now = self._accounts.setdefault(stage, StageAccount())

    def close(self, end_cclk: int, kernels: tuple[Owner, ...], costs: NDArray[np.int64]) -> CoreFrame:
        """End the frame at `end_cclk`, begin the next one, and return the record: stages in the budget's order.

        `kernels` are those that ran, in each stage, the same tuple for as long as none comes, with their `costs` as rows of an `OwnerCosts` table.
        """
        order = [each for each in (*self._stages, REST) if each in self._accounts]
        others = [
            (Owner(stage, owner), each) for stage in order for owner, each in self._accounts[stage].others()
        ]
        table = np.zeros((len(others), COLUMNS), np.int64)
        for row, (_, each) in zip(table, others, strict=True):
            each.write(row)
        frame = CoreFrame(
            core=self._core,
            begin_cclk=self._begin_cclk,
            end_cclk=end_cclk,
            stages=tuple(self._accounts[each].cost(each) for each in order),
            owners=OwnerCosts(
                self._with(kernels, tuple(owner for owner, _ in others)), np.concatenate([costs, table])
            ),
        )
        self._begin_cclk = end_cclk
        self._open()
        return frame

    def _with(self, kernels: tuple[Owner, ...], others: tuple[Owner, ...]) -> tuple[Owner, ...]:
        """Return all owners of a frame: most frames have the same ones, and then the same tuple."""
        if kernels is not self._kernels:
            self._kernels, self._owners = kernels, {}
        if others not in self._owners:
            self._owners[others] = (*kernels, *others)
        return self._owners[others]
