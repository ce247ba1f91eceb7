"""Where a core's cycles went: an account per stage of a frame, closed into records at the frame's end."""

from __future__ import annotations

from bfsim.trace import REST, CoreFrame, StageCost, StallReason


class StageAccount:
    """Cycles of one stage in one frame."""

    __slots__ = ("idle_cclk", "issue_cclk", "stall_cclk")

    def __init__(self) -> None:
        self.issue_cclk = 0
        self.idle_cclk = 0
        self.stall_cclk: dict[StallReason, int] = {}

    def cost(self, stage: str) -> StageCost:
        """Return the record of `stage`."""
        stalls = {reason: cclk for reason, cclk in sorted(self.stall_cclk.items()) if cclk}
        return StageCost(stage=stage, issue_cclk=self.issue_cclk, stall_cclk=stalls, idle_cclk=self.idle_cclk)


class FrameAccounts:
    """The accounts of one core's current frame. `now` is the account that cycles go to."""

    def __init__(self, core: str, stages: tuple[str, ...]) -> None:
        self._core = core
        self._stages = stages
        self._begin_cclk = 0
        self._open()

    def _open(self) -> None:
        self._accounts = {REST: StageAccount()}
        self.now = self._accounts[REST]

    def enter(self, stage: str) -> None:
        """Let cycles go to `stage`, or to the rest."""
        self.now = self._accounts.setdefault(stage, StageAccount())

    def close(self, end_cclk: int) -> CoreFrame:
        """End the frame at `end_cclk`, begin the next one, and return the record: stages in the budget's order."""
        order = [each for each in (*self._stages, REST) if each in self._accounts]
        stages = tuple(self._accounts[each].cost(each) for each in order)
        frame = CoreFrame(core=self._core, begin_cclk=self._begin_cclk, end_cclk=end_cclk, stages=stages)
        self._begin_cclk = end_cclk
        self._open()
        return frame
