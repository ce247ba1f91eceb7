"""Where a core's cycles went: an account per stage of a frame, closed into records at the frame's end.

Every cycle has an owner: the kernels, among which `calls.ledger` splits their cycles, or something else by name: a ring, a
semaphore, an interrupt, the cameras.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bfsim.trace import REST, CoreFrame, StageCost, StallReason
from bfsim.trace.owner_costs import COLUMN_OF, COLUMNS, IDLE, ISSUE, Owner, OwnerCosts

KERNELS = ""
"""The owner of the cost of kernels."""
SORTED_REASONS = sorted(COLUMN_OF.items())


class Account:
    """Cycles of one owner in one stage of a frame: a row of an `OwnerCosts` table."""

    __slots__ = ("row",)

    def __init__(self) -> None:
        self.row = [0] * COLUMNS

    def issue(self, cclk: int) -> None:
        """Add cycles of work."""
        self.row[ISSUE] += cclk

    def idle(self, cclk: int) -> None:
        """Add cycles without anything to do."""
        self.row[IDLE] += cclk

    def stall(self, reason: StallReason, cclk: int) -> None:
        """Add cycles of a stall."""
        self.row[COLUMN_OF[reason]] += cclk


class StageAccount:
    """Cycles of one stage in one frame, with an account for each of `owners`."""

    __slots__ = ("kernels", "owners")

    def __init__(self) -> None:
        self.kernels = Account()
        self.owners = {KERNELS: self.kernels}

    def of(self, owner: str) -> Account:
        """Return the account of an owner."""
        return self.owners.get(owner) or self.owners.setdefault(owner, Account())

    def cost(self, stage: str) -> StageCost:
        """Return the record of `stage`, all owners together."""
        whole = self.kernels.row
        if len(self.owners) > 1:
            whole = [*map(sum, zip(*[each.row for each in self.owners.values()], strict=True))]
        return StageCost(
            stage=stage,
            issue_cclk=whole[ISSUE],
            stall_cclk={reason: whole[column] for reason, column in SORTED_REASONS if whole[column]},
            idle_cclk=whole[IDLE],
        )


class FrameAccounts:
    """The accounts of one core's current frame. Cycles go to the account `now`."""

    def __init__(self, core: str, stages: tuple[str, ...]) -> None:
        self._core = core
        self._stages = stages
        self._begin_cclk = 0
        self._kernels: tuple[Owner, ...] = ()
        self._owners: dict[tuple[tuple[str, str], ...], tuple[Owner, ...]] = {}  # these kernels and others
        self._open()

    def _open(self) -> None:
        self._accounts = {REST: StageAccount()}
        self.now = self._accounts[REST]

    def enter(self, stage: str) -> None:
        """Let cycles go to `stage`, which may be the rest."""
        if stage not in self._accounts:
            self._accounts[stage] = StageAccount()
        self.now = self._accounts[stage]

    def close(self, end_cclk: int, kernels: tuple[Owner, ...], costs: NDArray[np.int64]) -> CoreFrame:
        """End the frame at `end_cclk`, begin the next one, and return the record with stages in the budget's order.

        `kernels` ran in this frame, each in its stage: the same tuple as long as no kernel is new. `costs` are their rows of an
        `OwnerCosts` table.
        """
        order = [each for each in (*self._stages, REST) if each in self._accounts]
        others, rows = [], []
        for stage in order:
            for owner, account in self._accounts[stage].owners.items():
                if owner != KERNELS:
                    others.append((stage, owner))
                    rows.append(account.row)
        table = np.array(rows, np.int64).reshape(-1, COLUMNS)
        frame = CoreFrame(
            core=self._core,
            begin_cclk=self._begin_cclk,
            end_cclk=end_cclk,
            stages=tuple([self._accounts[each].cost(each) for each in order]),
            owners=OwnerCosts(self._with(kernels, tuple(others)), np.concatenate([costs, table])),
        )
        self._begin_cclk = end_cclk
        self._open()
        return frame

    def _with(self, kernels: tuple[Owner, ...], others: tuple[tuple[str, str], ...]) -> tuple[Owner, ...]:
        """Return all owners of a frame, `others` by stage and name. Most frames have the same owners and get the same tuple."""
        if kernels is not self._kernels:
            self._kernels, self._owners = kernels, {}
        if others not in self._owners:
            self._owners[others] = (*kernels, *(Owner(*each) for each in others))
        return self._owners[others]
