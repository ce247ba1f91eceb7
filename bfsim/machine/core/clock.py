"""A core's clock and its accounts: how time passes for a core, and which account each cycle goes to.

The core runs ahead of the simulated time: kernel work only adds to its own clock, and it catches up with the
simulated time where it meets another device. Every cycle of its clock goes to one account, so that
issue + stall + idle = elapsed holds by construction.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.stalls import BUS_STALLS, REASON_OF_ACCOUNT
from bfsim.machine.bus.transfer_plans import Played, Transfer
from bfsim.machine.core.accounts import FrameAccounts
from bfsim.machine.simulation import Simulation
from bfsim.machine.timeline import CoreTimeline
from bfsim.trace import StallReason


class CoreClock:
    """The clock of one core. It never goes back, and is never behind the simulated time when the core acts."""

    def __init__(
        self, env: Simulation, name: str, board: BoardSpec, bus: Bus, stages: tuple[str, ...]
    ) -> None:
        self.name = name
        self.waiting_for: str | None = None
        """What the core waits for, in words, while only another device can let it go on."""
        self._env = env
        self._board = board
        self._bus = bus
        self._cclk_ticks = board.clocks.cclk_ticks
        self._cclk = 0
        self._owed_cclk = 0  # of a wait: what passed before its interrupts, on no account yet
        self._accounts = FrameAccounts(name, stages)
        self._account = self._accounts.now
        self._timeline = CoreTimeline(env.timeline, name) if env.timeline else None

    @property
    def now_ticks(self) -> int:
        """The core's own clock, in ticks: the simulated time or later."""
        return self._cclk * self._cclk_ticks

    def catch_up(self) -> simpy.Event | None:
        """Return the event at which the simulated time reaches the core's clock; None when it has."""
        ahead_ticks = self._cclk * self._cclk_ticks - self._env.tick
        return self._env.after(ahead_ticks) if ahead_ticks > 0 else None

    def sync(self) -> Generator[Any, Any, None]:
        """Wait until the simulated time has reached the core's clock."""
        while late := CoreClock.catch_up(self):  # a handler may come in between
            yield late

    def when_there(self, what: Callable[[], None]) -> None:
        """Do `what` when all is done that the core has been told before: at once, unless its clock is still to be found out."""
        what()

    def settle(self) -> None:
        """Let everything on the bus happen that is due; the core's clock must have been caught up with."""
        self._bus.settle()

    def has(self, transfer: Transfer) -> bool:
        """Whether `transfer` is done by the core's clock."""
        end = transfer.end
        return end is not None and end <= self._cclk * self._cclk_ticks

    def goes_on(self, transfer: Transfer, reason: StallReason, owner: str) -> bool:  # noqa: ARG002  # of a wait, as below
        """Whether a core that needs `transfer` done can go on at once; else it must wait for it."""
        return self.has(transfer)

    def wait_transfer(self, transfer: Transfer, reason: StallReason, owner: str) -> Generator[Any, Any, None]:
        """Stall for `reason` until `transfer` is done; `owner`: whom these cycles belong to, as everywhere here."""
        if transfer.end is None:
            yield from self.sync()
            self._bus.settle()
            if transfer.end is None:
                yield from self._blocked(iter([self._bus.when_done(transfer)]), "DMA", reason)
        self._charge(reason, self._until(transfer.end), owner, transfer)

    def wait_event(
        self, event: simpy.Event | None, what: str, last: Callable[[], Transfer | None]
    ) -> Generator[Any, Any, None]:
        """Stall until `event`, the end of a DMA that this core started; `last`: returns its last transfer then."""
        yield from self.sync()
        if event is not None and not event.processed:
            yield from self._blocked(iter([event]), what, StallReason.RING_EMPTY)
            self._wake(StallReason.RING_EMPTY, what, ended_by=last())

    def stall(self, reason: StallReason, cclk: int, owner: str) -> None:
        """Let `cclk` cycles pass without work, for `reason`."""
        if self._timeline:
            self._timeline.wait(reason, self._cclk, cclk)
        self._cclk += cclk
        self._account.of(owner).stall(reason, cclk)

    def issue(self, cclk: int, owner: str) -> None:
        """Let `cclk` cycles pass with work that is no kernel's."""
        if self._timeline:
            self._timeline.work(self._cclk, cclk)
        self._cclk += cclk
        self._account.of(owner).issue_cclk += cclk

    @property
    def is_told(self) -> bool:
        """Whether a timeline is told what this core does."""
        return self._timeline is not None

    def tell_level(self, name: str, value: int) -> None:
        """Tell the timeline, if there is one, how high a level of this core's is from now on."""
        if self._timeline:
            self._timeline.level(name, value, self._cclk)

    @contextmanager
    def _elsewhere(self) -> Iterator[None]:
        """Have what is inside be about no place of the picture until it says so, and what comes after about the one before."""
        if not self._timeline:
            yield
            return
        before, self._timeline.place = self._timeline.place, None
        yield
        self._timeline.place = before

    def _charge_stretch(self, played: Played, owners: Sequence[str]) -> None:
        """Charge what a stretch of work took that the bus has played; `owners`: of its accounts, by their numbers."""
        self._cclk = played.clock_cclk
        kernels = self._account.kernels
        kernels.issue_cclk += played.issue_cclk
        stalls = (played.interlocks_cclk, *played.bus_stalls_cclk)
        for reason, cclk in zip((StallReason.INTERLOCK, *BUS_STALLS), stalls, strict=True):
            if cclk:
                kernels.stall(reason, cclk)
        for number, words in played.accounts.items():
            account = self._account.of(owners[number])
            for word, reason in REASON_OF_ACCOUNT.items():
                if words[word]:
                    account.stall(reason, words[word])

    def program_device(self, owner: str, *, writes: int, reads: int = 0) -> None:
        """Write and read registers of a device: that is DMA set-up."""
        events = self._board.chip.events
        cclk = writes * events.mmr_write_cclk + reads * events.mmr_read_cclk
        self.stall(StallReason.DMA_SETUP, cclk, owner)

    def _until(self, tick: int | None) -> int:
        """Return the cycles up to the first CCLK edge from `tick` on, which must be known; 0 if that is over."""
        assert tick is not None
        return max(0, -(-tick // self._cclk_ticks) - self._cclk)

    def _wake(self, reason: StallReason | None, owner: str, ended_by: Transfer | None = None) -> None:
        """Go on at the first CCLK edge from now; that was a stall, or idle without a reason."""
        self._charge(reason, self._until(self._env.tick), owner, ended_by)

    def _charge(
        self, reason: StallReason | None, waited_cclk: int, owner: str, ended_by: Transfer | None = None
    ) -> None:
        """Let `waited_cclk` pass, and charge them with what the wait owes from before its interrupts."""
        self._pass_waiting(reason, waited_cclk, ended_by)
        waited_cclk, self._owed_cclk = waited_cclk + self._owed_cclk, 0
        if reason is None:
            self._account.of(owner).idle_cclk += waited_cclk
        elif waited_cclk:
            self._account.of(owner).stall(reason, waited_cclk)

    def _pass_waiting(self, reason: StallReason | None, cclk: int, ended_by: Transfer | None = None) -> None:
        """Let `cclk` cycles of a wait pass that are on no account yet."""
        if self._timeline and cclk:
            self._timeline.wait(reason, self._cclk, cclk, self._bus.flow_of(ended_by))
        self._cclk += cclk

    def _blocked(
        self,
        wait: Any,
        what: str,
        reason: StallReason | None,  # noqa: ARG002  # of what passes before an interrupt
    ) -> Generator[Any, Any, Any]:
        """Play `wait`, a generator of events, saying meanwhile what the core waits for; `reason` is as for `_wake`."""
        self.waiting_for = f"{what}, since cycle {self._cclk:,}"
        result = yield from wait
        self.waiting_for = None
        return result
