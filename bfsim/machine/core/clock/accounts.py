"""Where a core's cycles went: an account per stage of a frame, closed into records at the frame's end.

Every cycle has an owner: kernels, which say themselves how it is split among them (`calls.ledger`), or one of those that no kernel
is, by name: a ring, a semaphore, an interrupt, the cameras.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bfsim.trace import REST, CoreFrame, StageCost, StallReason
from bfsim.trace.owner_costs import COLUMN_OF, COLUMNS, IDLE, ISSUE, Owner, OwnerCosts

KERNELS = ""
"""The owner of what kernels cost."""
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
        """Add cycles of nothing to do."""
        self.row[IDLE] += cclk

    def stall(self, reason: StallReason, cclk: int) -> None:
        """Add cycles of a stall."""
        self.row[COLUMN_OF[reason]] += cclk


class StageAccount:
    """Cycles of one stage in one frame: `owners` have an account each."""

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
    """The accounts of one core's current frame. `now` is the account that cycles go to."""

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
        """Let cycles go to `stage`, or to the rest."""
        if stage not in self._accounts:
            self._accounts[stage] = StageAccount()
        self.now = self._accounts[stage]

    def close(self, end_cclk: int, kernels: tuple[Owner, ...], costs: NDArray[np.int64]) -> CoreFrame:
        """End the frame at `end_cclk`, begin the next one, and return the record: stages in the budget's order.

        `kernels` are those that ran, in each stage, the same tuple for as long as none comes, with their `costs` as rows of an `OwnerCosts` table.
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
        """Return all owners of a frame, others by stage and name: most frames have the same ones, and then the same tuple."""
        if kernels is not self._kernels:
            self._kernels, self._owners = kernels, {}
        if others not in self._owners:
            self._owners[others] = (*kernels, *(Owner(*each) for each in others))
        return self._owners[others]
