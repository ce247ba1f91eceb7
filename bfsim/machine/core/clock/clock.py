"""A core's clock and its accounts: how time passes for a core, and which account each cycle goes to.

Every cycle of the clock goes to one account, so issue + stall + idle = elapsed holds by construction. Nothing here waits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from bfsim.chip.spec import BoardSpec
from bfsim.kernel import Work
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.stalls import BUS_STALLS, REASON_OF_ACCOUNT
from bfsim.machine.bus.transfer_plans import Played, Transfer
from bfsim.machine.core.clock.accounts import KERNELS, FrameAccounts
from bfsim.machine.simulation import Simulation
from bfsim.machine.timeline import CoreTimeline
from bfsim.trace import StallReason
from bfsim.trace.owner_costs import COLUMN_OF, ISSUE

KERNEL_COLUMNS = (ISSUE, *(COLUMN_OF[each] for each in (StallReason.INTERLOCK, *BUS_STALLS)))
"""Columns of the cycles that kernels took, in the order of `Played`."""
ACCOUNT_COLUMNS = [(word, COLUMN_OF[reason]) for word, reason in REASON_OF_ACCOUNT.items()]
"""Words of an account in `Played`, and the column of each."""


class CoreClock:
    """The clock of one core, which never goes back. Throughout, cycles belong to `owner`."""

    def __init__(
        self, env: Simulation, name: str, board: BoardSpec, bus: Bus, stages: tuple[str, ...]
    ) -> None:
        self._env = env
        self._records = bus.records
        self._events = board.chip.events
        self.cclk_ticks = board.clocks.cclk_ticks
        self.cclk = 0
        """The core's own time."""
        self.owed_cclk = 0
        """Cycles of a wait that passed before its interrupts and are on no account yet."""
        self.accounts = FrameAccounts(name, stages)
        self.timeline = CoreTimeline(env.timeline, name) if env.timeline else None
        """The timeline that hears what the core does, if anyone wants to know."""

    @property
    def ticks(self) -> int:
        """The core's own time, in ticks."""
        return self.cclk * self.cclk_ticks

    def stall(self, reason: StallReason, cclk: int, owner: str) -> None:
        """Let `cclk` cycles pass without work, for `reason`."""
        if self.timeline:
            self.timeline.wait(reason, self.cclk, cclk)
        self.cclk += cclk
        self.accounts.now.of(owner).stall(reason, cclk)

    def issue(self, cclk: int, owner: str) -> None:
        """Let `cclk` cycles pass with work outside kernels."""
        if self.timeline:
            self.timeline.work(self.cclk, cclk)
        self.cclk += cclk
        self.accounts.now.of(owner).issue(cclk)

    def program_device(self, owner: str, *, writes: int, reads: int) -> None:
        """Let the time of writing and reading a device's registers pass, as a stall for DMA set-up."""
        cclk = writes * self._events.mmr_write_cclk + reads * self._events.mmr_read_cclk
        self.stall(StallReason.DMA_SETUP, cclk, owner)

    def call(self, work: Work, stalls: dict[StallReason, int], name: str, owner: str = KERNELS) -> None:
        """Let the cycles of a call of kernel `name` pass. `stalls` come from its accesses outside L1."""
        if work.stall_cclk:
            stalls[StallReason.INTERLOCK] = work.stall_cclk
        if self.timeline:
            self.timeline.call(name, self.cclk, work.issue_cclk, stalls)
        account = self.accounts.now.of(owner)
        self.cclk += work.issue_cclk
        account.issue(work.issue_cclk)
        for reason, cclk in stalls.items():
            self.cclk += cclk
            account.stall(reason, cclk)

    def stretch(self, played: Played, owners: Sequence[str]) -> None:
        """Charge the cycles of a stretch that the bus has played. `owners` own its accounts, by number."""
        self.cclk = played.clock_cclk
        now = self.accounts.now
        row = now.kernels.row
        for column, cclk in zip(KERNEL_COLUMNS, (played.issue_cclk, *played.stalls_cclk), strict=True):
            row[column] += cclk
        for number, words in played.accounts.items():
            row = now.of(owners[number]).row
            for word, column in ACCOUNT_COLUMNS:
                row[column] += words[word]

    def until(self, tick: int) -> int:
        """Return the cycles until the first CCLK edge at or after `tick`, 0 if that has passed."""
        return max(0, -(-tick // self.cclk_ticks) - self.cclk)

    def is_over(self, transfer: Transfer) -> bool:
        """Whether a transfer is done by now."""
        end = transfer.end
        return end is not None and end <= self.ticks

    def wake(self, reason: StallReason | None, owner: str, ended_by: Transfer | None = None) -> None:
        """Go on at the first CCLK edge from now. The wait was a stall, or idle without a `reason`."""
        self.waited(reason, self.until(self._env.tick), owner, ended_by)

    def waited(
        self, reason: StallReason | None, cclk: int, owner: str, ended_by: Transfer | None = None
    ) -> None:
        """Let `cclk` cycles of a wait pass, and charge them together with those owed from before its interrupts."""
        self.pass_waiting(reason, cclk, ended_by)
        cclk, self.owed_cclk = cclk + self.owed_cclk, 0
        if reason is None:
            self.accounts.now.of(owner).idle(cclk)
        elif cclk:
            self.accounts.now.of(owner).stall(reason, cclk)

    def pass_waiting(self, reason: StallReason | None, cclk: int, ended_by: Transfer | None = None) -> None:
        """Let `cclk` cycles of a wait pass without charging them yet."""
        if self.timeline and cclk:
            self.timeline.wait(reason, self.cclk, cclk, self._records.flow_of(ended_by))
        self.cclk += cclk

    def tell_level(self, name: str, value: int) -> None:
        """Tell the timeline, if there is one, the new value of one of this core's levels."""
        if self.timeline:
            self.timeline.level(name, value, self.cclk)

    @contextmanager
    def elsewhere(self) -> Iterator[None]:
        """Begin this context without a place in the picture, and restore the previous place at its end."""
        if not self.timeline:
            yield
            return
        before = self.timeline.said
        self.timeline.say(None)
        yield
        self.timeline.say(before)
