"""Where a core's cycles went: an account per stage of a frame, closed into records at the frame's end."""

from __future__ import annotations

from bfsim.trace import REST, CoreFrame, StageCost, StallReason


class Account:
    """Cycles of one stage in one frame."""

    __slots__ = ("idle_cclk", "issue_cclk", "stall_cclk")

    def __init__(self) -> None:
        self.issue_cclk = 0
        self.idle_cclk = 0
        self.stall_cclk: dict[StallReason, int] = {}


class FrameAccounts:
    """The accounts of one core's current frame. `now` is the account that cycles go to."""

    def __init__(self, core: str, stages: tuple[str, ...]) -> None:
        self._core = core
        self._stages = stages
        self._begin_cclk = 0
        self._open()

    def _open(self) -> None:
        self._accounts = {REST: Account()}
        self.now = self._accounts[REST]

    def enter(self, stage: str) -> Account:
        """Let cycles go to `stage`, or to the rest; return the account they went to before."""
        before = self.now
        self.now = self._accounts.setdefault(stage, Account())
        return before

    def close(self, end_cclk: int) -> CoreFrame:
        """End the frame at `end_cclk`, begin the next one, and return the record: stages in the budget's order."""
        order = [each for each in (*self._stages, REST) if each in self._accounts]
        frame = CoreFrame(
            core=self._core,
            begin_cclk=self._begin_cclk,
            end_cclk=end_cclk,
            stages=tuple(
                StageCost(
                    stage=each,
                    issue_cclk=self._accounts[each].issue_cclk,
                    stall_cclk=dict(sorted(self._accounts[each].stall_cclk.items())),
                    idle_cclk=self._accounts[each].idle_cclk,
                )
                for each in order
            ),
        )
        self._begin_cclk = end_cclk
        self._open()
        return frame
