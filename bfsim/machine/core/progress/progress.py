"""How a core's firmware gets on against the simulated time: in step with it (`in_step`), or ahead of it (`ahead`).

Whatever a core does that takes time or meets the rest of the machine goes through this, from its kernels to its rings.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any, Protocol

import simpy

from bfsim.kernel import Work
from bfsim.machine.bus.tape import Tape
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.calls.call_cache import KnownCall
from bfsim.machine.core.clock.clock import CoreClock
from bfsim.machine.core.interrupts import Handler, Interrupts
from bfsim.machine.core.progress.line_copies import Copy, LineCopies, Lines
from bfsim.machine.core.waits import Wait, Waits
from bfsim.trace import StallReason

Away = AbstractContextManager[None]


class Progress(Protocol):
    """The progress of one core. `owner`, everywhere here: whom cycles belong to; `reason`: why they are a stall."""

    clock: CoreClock
    interrupts: Interrupts
    waits: Waits
    """What the firmware has asked to wait for."""
    runs_ahead: bool
    """Whether calls that nobody else can meet are made as soon as the firmware asks for them."""

    @property
    def tape(self) -> Tape | None:
        """Where machine code notes calls that nobody else can meet."""

    @property
    def is_full(self) -> bool:
        """Whether the core must `sync` before it does more."""

    # ---- kernels

    def note_call(self, work: Work, call: KnownCall) -> None:
        """Charge a call that has accesses outside L1 and was made ahead: only where `runs_ahead` says so."""

    def charge_call(self, work: Work, call: KnownCall) -> None:
        """Charge a call that has met nobody."""

    def play_call(self, work: Work, call: KnownCall) -> Wait:
        """Play the accesses of a call, if it has any, from the core's clock on, and charge it."""

    def access_shared(self, work: Work, owner: str) -> Wait:
        """Play what an instruction accesses that is no kernel's."""

    # ---- time

    def sync(self) -> Wait:
        """Wait until the simulated time has reached the core's clock, and take the interrupts that wait then."""

    def catch_up(self) -> simpy.Event | None:
        """Return the event at which the simulated time reaches the core's clock, or now for an interrupt; None when it has."""

    def when_there(self, what: Callable[[], None]) -> None:
        """Do `what` when all is done that the core has been told before: at once, unless its clock is still to be found out."""

    def issue(self, cclk: int, owner: str) -> None:
        """Let `cclk` cycles pass with work that is no kernel's."""

    def program_device(self, owner: str, *, writes: int, reads: int = 0) -> None:
        """Write and read registers of a device."""

    # ---- copies

    def copies(self, lines: Lines) -> LineCopies:
        """Return what has lines copied for this core."""

    def settle(self) -> None:
        """Let everything on the bus happen that is due; the core's clock must have been caught up with."""

    def has(self, copy: Copy) -> bool:
        """Whether a copy is done by the core's clock."""

    def wait_transfer(self, copy: Copy, reason: StallReason, owner: str) -> Wait:
        """Stall until a copy or another transfer is done; interrupts that have handlers are taken as they come."""

    # ---- others

    def wait_event(self, event: simpy.Event | None, what: str, last: Callable[[], Transfer | None]) -> Wait:
        """Stall until `event`, the end of a DMA that this core started; `last`: returns its last transfer then."""

    def blocked(
        self, wait: Any, what: str, reason: StallReason | None, away: Callable[[], Away] = nullcontext
    ) -> Wait:
        """Play `wait`, a generator of events, saying meanwhile what the core waits for; interrupts are taken as they come.

        `away`: returns a context in which their handlers run.
        """

    def on_interrupt(self, source: str, handler: Handler) -> None:
        """Have `handler` called at every interrupt of `source` from now on."""

    def request_interrupt(self, source: str) -> None:
        """Ask this core for an interrupt."""

    def stay_in_step(self) -> None:
        """Do everything at its time from now on: somebody else may meet whatever the core does."""
