"""A core that runs ahead: what nobody else can meet is done at once, and the buses play it when the core has to meet somebody.

Kernels in L1 or on buffers of its own and the lines of its rings run as the firmware asks for them, so bytes are where they belong
before time has passed; they are noted as operations of a stretch (`bus.stretches`), which says at which cycle each of them was.
Before the core waits for a picture, for the other core or for a device, the bus plays its stretches, and its clock is known again.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from functools import partial
from typing import Any

import numpy as np

from bfsim.errors import FirmwareError
from bfsim.kernel import Work
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.stalls import COUNTER_OF
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.core.core import Core
from bfsim.machine.core.interrupts import Handler
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.dma.memory_dma import MemoryDma
from bfsim.machine.memories import Row
from bfsim.trace import StallReason

MOST_WORDS, MOST_ACCESSES = w.MAX_OPERATIONS // 2 * w.OPERATION_WORDS, 1 << 16
"""What is done ahead, at most, before a core meets the others: its room is larger, for it cannot do so at every operation."""

Wait = Generator[Any, Any, Any]


Copy = int
"""A copy that a core has made ahead: the how-manieth of all of its own."""


class AheadStream(MdmaStream):
    """A memory DMA stream of a core that runs ahead: the bytes move at once, and the time that takes is found out later."""

    def __init__(self, stream: MdmaStream, core: AheadCore) -> None:
        self._stream = stream
        self._core = core
        self._copies: dict[tuple[Row, Row], tuple[int, int, int, int, int]] = {}
        self._kinds: dict[tuple[object, ...], int] = {}

    def copy(self, source: Row, destination: Row, at: int) -> Any:
        """Copy as the stream does."""
        if not self._core.runs_ahead:
            return self._stream.copy(source, destination, at)
        copy = self._copies.get((source, destination))
        if copy is None:
            copy = self._copies[source, destination] = self._planned(source, destination)
        destination.octets[:] = source.octets
        return self._core.copied(copy)

    def _planned(self, source: Row, destination: Row) -> tuple[int, int, int, int, int]:
        """Return a copy as an operation: the number of its plan, which those of its kind share, and where it begins to read and to write."""
        kind = self._stream.kind_of(source, destination)
        if kind not in self._kinds:
            self._kinds[kind] = self._core.keep_plan(self._stream.plan(source, destination).words)
        return w.COPY, self._kinds[kind], source.offset, destination.offset, 0


class AheadCore(Core):
    """A core whose firmware runs ahead, unless somebody looks at every moment of it or may interrupt it."""

    def __init__(
        self, *arguments: Any, bus: Bus, number: int, streams: tuple[MdmaStream, MdmaStream], **named: Any
    ) -> None:
        inward, outward = (AheadStream(each, self) for each in streams)
        super().__init__(*arguments, bus=bus, number=number, streams=(inward, outward), **named)
        self._may_run_ahead = self._timeline is None
        events = self._board.chip.events
        self._write_cclk, self._read_cclk = events.mmr_write_cclk, events.mmr_read_cclk
        self._copies: Copy = 0
        self._has_traced = False  # whether the call that was made last has a log
        self._begin()

    def _begin(self) -> None:
        """Begin anew: the clock is where the firmware is."""
        self._noted: list[int] = []  # operations, word by word,
        self._issued = self._interlocked = 0  # and what the calls behind the last of them took
        self._moments: list[tuple[int, Callable[[], None]]] = []  # what to do, and behind how many words
        self._owners: dict[str, int] = {}  # of their accounts
        self._is_full = False
        self._access_trace.drop()

    @property
    def runs_ahead(self) -> bool:
        """Whether the next operation is only noted."""
        return self._may_run_ahead or self._is_behind

    @property
    def _is_behind(self) -> bool:
        """Whether the core's clock is behind its firmware."""
        return bool(self._noted)

    # Kernels

    def _goes_ahead(self) -> bool:
        self._has_traced = self._may_run_ahead
        return self._has_traced

    def _charge_call(self, work: Work) -> None:
        if self._has_traced:
            self._has_traced = False
            first = self._access_trace.keep(work.accesses)
            last = first + work.accesses
            self._note(w.ACCESS, work.issue_cclk, work.stall_cclk, first, last)
            self._is_full |= last > MOST_ACCESSES
        elif self._noted:
            self._issued += work.issue_cclk
            self._interlocked += work.stall_cclk
        else:
            super()._charge_call(work)

    # Rings

    def catch_up(self) -> Any:
        """Catch up with the clock, when that is known."""
        if not self._may_run_ahead:
            return self._env.process(self.sync()) if self._is_behind else super().catch_up()
        if self._issued:
            self._note_calls()
        self._noted += (w.CATCH_UP, 0, 0, 0, 0)
        return None

    def settle(self) -> None:
        """Let everything on the bus happen that is due; what is done ahead does not depend on it."""
        if not (self._may_run_ahead or self._noted):
            super().settle()

    def has(self, transfer: Any) -> bool:
        """Whether a transfer is done by the core's clock: nobody knows that of one made ahead before it is waited for."""
        return not (self._may_run_ahead or self._noted) and super().has(self._posted(transfer))

    def goes_on(self, transfer: Any, reason: StallReason, owner: str) -> bool:
        """Note the wait for a copy that was made ahead, and go on; else ask as every core does."""
        if not (self._may_run_ahead and isinstance(transfer, Copy)):
            return super().goes_on(transfer, reason, owner)
        self._note(w.AWAIT, self._copies - transfer, COUNTER_OF[reason], self._account_of(owner))
        self._is_full |= len(self._noted) > MOST_WORDS
        return True

    def wait_transfer(self, transfer: Any, reason: StallReason, owner: str) -> Wait:
        """Wait as every core does."""
        if not self._may_run_ahead or not self.goes_on(transfer, reason, owner):
            yield from self.play_stretches()
            yield from super().wait_transfer(self._posted(transfer), reason, owner)

    def program_device(self, owner: str, *, writes: int, reads: int = 0) -> None:
        """Write and read registers as every core does."""
        if self._may_run_ahead or self._noted:
            self._note(w.SET_UP, writes * self._write_cclk + reads * self._read_cclk, self._account_of(owner))
        else:
            super().program_device(owner, writes=writes, reads=reads)

    def issue(self, cclk: int, owner: str) -> None:
        """Let cycles pass as every core does."""
        self.when_there(partial(super().issue, cclk, owner))

    def copied(self, copy: tuple[int, int, int, int, int]) -> Copy:
        """Note a copy that was made; return it."""
        if self._issued:
            self._note_calls()
        self._noted += copy
        self._copies += 1
        return self._copies - 1

    def keep_plan(self, words: tuple[int, ...]) -> int:
        """Keep the words of a plan for copies of its kind; return its number."""
        (number,) = self._bus.stretches.keep_plans([words])
        return int(number)

    # Who may interrupt it is met at every call

    def on_interrupt(self, source: str, handler: Handler) -> None:
        """Attach a handler as every core does."""
        self._may_run_ahead = False
        self._interrupts.source(source)  # a wrong one is told here
        self.when_there(partial(super().on_interrupt, source, handler))
        self._is_full = self._is_behind

    def request_interrupt(self, source: str) -> None:
        """Ask for an interrupt as every core does."""
        self._interrupts.source(source)
        self.when_there(partial(super().request_interrupt, source))

    def memory_dma(self, name: str) -> MemoryDma:
        """Return a stream as every core does; what it moves may be anybody's."""
        self._may_run_ahead = False
        return super().memory_dma(name)

    # Where the clock is needed

    def when_there(self, what: Callable[[], None]) -> None:
        """Do `what` when the clock is where the firmware is now."""
        if not self._is_behind:
            what()
            return
        self._note_calls()
        self._moments.append((len(self._noted), what))

    def sync(self) -> Wait:
        """Find the clock out, and wait until the simulated time has reached it."""
        yield from self.play_stretches()
        yield from super().sync()

    def play_stretches(self) -> Wait:
        """Have the bus play what was done ahead, and do at each moment what was to be done then."""
        if not self._is_behind:
            return
        before, self._in_handler = self._in_handler, True  # no handler comes between,
        self._is_full = False  # and no second play of the same
        self._note_calls()
        owners, operations, first = list(self._owners), np.array(self._noted, np.int64), 0
        for end, what in (*self._moments, (len(operations), self._begin)):
            if end > first:
                yield self._bus.stretches.play(self._number, self._cclk, operations[first:end])
                self._charge_stretch(self._bus.stretches.played(self._number, len(owners)), owners)
                first = end
            what()
        self._in_handler = before

    # Inside

    def _note(self, kind: int, one: int = 0, two: int = 0, three: int = 0, four: int = 0) -> None:
        """Note an operation and its numbers, as in `bus.state`, behind the calls before it."""
        if self._issued:
            self._note_calls()
        self._noted += (kind, one, two, three, four)

    def _note_calls(self) -> None:
        """Note the calls that have met nobody since the last operation, as one."""
        issued, interlocked = self._issued, self._interlocked
        if issued or interlocked:
            self._issued = self._interlocked = 0
            self._noted += (w.RUN, issued, interlocked, 0, 0)

    def _account_of(self, owner: str) -> int:
        owners = self._owners
        if owner in owners:
            return owners[owner]
        number = owners[owner] = len(owners)
        if number == w.MAX_ACCOUNTS:
            raise FirmwareError(
                f"core {self.name} must use at most {w.MAX_ACCOUNTS} rings before it waits for a picture or another core"
            )
        self._is_full |= number > w.MAX_ACCOUNTS // 2
        return number

    def _posted(self, transfer: Any) -> Transfer:
        """Return a transfer of the bus for one that was made ahead and has been played."""
        if not isinstance(transfer, Copy):
            return transfer  # type: ignore[no-any-return]
        return Transfer(self._bus.words, *self._bus.stretches.copy_of(self._number, transfer))
