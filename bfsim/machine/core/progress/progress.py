"""How a core's firmware advances relative to simulated time: in step with it (`in_step`) or ahead of it (`ahead`).

Everything that takes time or meets the rest of the machine goes through this, from the core's kernels to its rings.
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
    """The progress of one core. Throughout, cycles belong to `owner`, and `reason` is why they are a stall."""

    clock: CoreClock
    interrupts: Interrupts
    waits: Waits
    """The waits that the firmware has requested."""
    runs_ahead: bool
    """Whether calls that no other device can notice are made as soon as the firmware asks for them."""

    @property
    def tape(self) -> Tape | None:
        """Where machine code notes calls that no other device can notice."""

    @property
    def is_full(self) -> bool:
        """Whether the core must `sync` before it does more."""

    # ---- kernels

    def note_call(self, work: Work, call: KnownCall) -> None:
        """Charge a call with accesses outside L1 that was made ahead. Only while `runs_ahead`."""

    def charge_call(self, work: Work, call: KnownCall) -> None:
        """Charge a call that stayed in L1."""

    def play_call(self, work: Work, call: KnownCall) -> Wait:
        """Play the accesses of a call, if any, from the core's clock on, and charge the call."""

    def access_shared(self, work: Work, owner: str) -> Wait:
        """Play and charge the accesses of an instruction that belongs to no kernel."""

    # ---- time

    def sync(self) -> Wait:
        """Wait until simulated time has reached the core's clock, and take the interrupts pending then."""

    def catch_up(self) -> simpy.Event | None:
        """Return the event when simulated time reaches the core's clock, or one for now to take an interrupt. None: go on."""

    def when_there(self, what: Callable[[], None]) -> None:
        """Call `what` after everything that the core was told before: at once, unless its clock is not known yet."""

    def issue(self, cclk: int, owner: str) -> None:
        """Let `cclk` cycles pass with work outside kernels."""

    def program_device(self, owner: str, *, writes: int, reads: int = 0) -> None:
        """Write and read registers of a device."""

    # ---- copies

    def copies(self, lines: Lines) -> LineCopies:
        """Return the object that has lines copied for this core."""

    def settle(self) -> None:
        """Let everything that is due on the bus happen. Simulated time must have reached the core's clock."""

    def has(self, copy: Copy) -> bool:
        """Whether a copy is done by the core's clock."""

    def wait_transfer(self, copy: Copy, reason: StallReason, owner: str) -> Wait:
        """Stall until a copy or another transfer is done. Interrupts with handlers are taken as they come."""

    # ---- others

    def wait_event(self, event: simpy.Event | None, what: str, last: Callable[[], Transfer | None]) -> Wait:
        """Stall until `event`, the end of a DMA that this core started. `last` then returns its last transfer."""

    def blocked(
        self, wait: Any, what: str, reason: StallReason | None, away: Callable[[], Away] = nullcontext
    ) -> Wait:
        """Play `wait`, a generator of events; `what` names what the core waits for. Interrupts are taken as they come.

        `away` returns a context in which their handlers run.
        """

    def on_interrupt(self, source: str, handler: Handler) -> None:
        """Call `handler` at every interrupt of `source` from now on."""

    def request_interrupt(self, source: str) -> None:
        """Request an interrupt of this core."""

    def stay_in_step(self) -> None:
        """Do everything at its time from now on: other devices may notice whatever the core does."""
