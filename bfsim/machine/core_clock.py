"""A core's clock and its accounts: how time passes for a core, and which account each cycle goes to.

The core runs ahead of the simulated time: kernel work only adds to its own clock, and it catches up with the
simulated time where it meets another device. Every cycle of its clock goes to one account, so that
issue + stall + idle = elapsed holds by construction.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.machine.accounts import FrameAccounts
from bfsim.machine.bus import Bus, Transfer
from bfsim.machine.simulation import Simulation
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
        self._accounts = FrameAccounts(name, stages)
        self._account = self._accounts.now

    @property
    def now_ticks(self) -> int:
        """The core's own clock, in ticks: the simulated time or later."""
        return self._cclk * self._cclk_ticks

    def catch_up(self) -> simpy.Event | None:
        """Return the event at which the simulated time reaches the core's clock; None when it has."""
        ahead_ticks = self._cclk * self._cclk_ticks - self._env.tick
        return self._env.after(ahead_ticks) if ahead_ticks > 0 else None

    def settle(self) -> None:
        """Let everything on the bus happen that is due; the core's clock must have been caught up with."""
        self._bus.settle()

    def has(self, transfer: Transfer) -> bool:
        """Whether `transfer` is done by the core's clock."""
        end = transfer.end
        return end is not None and end <= self._cclk * self._cclk_ticks

    def wait_transfer(self, transfer: Transfer, reason: StallReason) -> Generator[Any, Any, None]:
        """Stall for `reason` until `transfer` is done."""
        if transfer.end is None:
            yield from self._sync()
            self._bus.settle()
            if transfer.end is None:
                yield self._bus.when_done(transfer)
        end = transfer.end
        assert end is not None
        late_ticks = end - self._cclk * self._cclk_ticks
        if late_ticks > 0:
            self.stall(reason, -(-late_ticks // self._cclk_ticks))

    def wait_event(self, event: simpy.Event | None, what: str) -> Generator[Any, Any, None]:
        """Stall until `event`, the end of a DMA that this core started."""
        yield from self._sync()
        if event is not None and not event.processed:
            yield from self._blocked(iter([event]), what)
            self._wake(StallReason.RING_EMPTY)

    def stall(self, reason: StallReason, cclk: int) -> None:
        """Let `cclk` cycles pass without work, for `reason`."""
        self._cclk += cclk
        stalls = self._account.stall_cclk
        stalls[reason] = stalls.get(reason, 0) + cclk

    def issue(self, cclk: int) -> None:
        """Let `cclk` cycles pass with work that is no kernel's."""
        self._cclk += cclk
        self._account.issue_cclk += cclk

    def program_device(self, writes: int, reads: int = 0) -> None:
        """Write and read registers of a device: that is DMA set-up."""
        events = self._board.chip.events
        self.stall(StallReason.DMA_SETUP, writes * events.mmr_write_cclk + reads * events.mmr_read_cclk)

    def _sync(self) -> Generator[Any, Any, None]:
        if late := self.catch_up():
            yield late

    def _wake(self, reason: StallReason | None, step_cclk: int = 1) -> None:
        """Go on at the first CCLK edge from now, or whole `step_cclk` later; that was a stall, or idle without a reason."""
        waited_cclk = -(-self._env.tick // self._cclk_ticks) - self._cclk
        if waited_cclk <= 0:
            return
        waited_cclk = -(-waited_cclk // step_cclk) * step_cclk
        if reason is None:
            self._cclk += waited_cclk
            self._account.idle_cclk += waited_cclk
        else:
            self.stall(reason, waited_cclk)

    def _blocked(self, wait: Any, what: str) -> Generator[Any, Any, Any]:
        """Play `wait`, a generator of events, saying meanwhile what the core waits for."""
        self.waiting_for = f"{what}, since cycle {self._cclk:,}"
        result = yield from wait
        self.waiting_for = None
        return result
