"""A core that plays generators of the firmware, its main loop and its handlers: kernels are charged, events waited for."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.errors import BfsimError, FirmwareError, KernelError, shown
from bfsim.kernel import Kernel, Work
from bfsim.kernel.work import UNYIELDED
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.stalls import BUS_STALLS
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.calls.call_cache import CallCache, DeferredWork
from bfsim.machine.core.accounts import Account
from bfsim.machine.core.clock import CoreClock
from bfsim.machine.core.handovers import Handovers
from bfsim.machine.core.interrupts import Handler, Interrupts
from bfsim.machine.core.waits import Waits, awaited, name_of
from bfsim.machine.firmware_lines import line_at, line_of
from bfsim.machine.memories import Row
from bfsim.machine.simulation import Simulation
from bfsim.trace import REST, StallReason


class PlayingCore(CoreClock):
    """A core's part of kernels and interrupts."""

    def __init__(
        self,
        env: Simulation,
        name: str,
        board: BoardSpec,
        *,
        bus: Bus,
        number: int,
        stages: tuple[str, ...],
        calls: CallCache,
        interrupts: Interrupts,
        handovers: Handovers,
    ) -> None:
        super().__init__(env, name, board, bus, stages)
        self._number = number
        self._calls = calls
        self._interrupts = interrupts
        self._handovers = handovers
        self._unclaimed: Work | None = None
        self._unclaimed_kernel: Kernel | None = None
        self.waits = Waits(name)
        """Waits that the firmware has made and may have forgotten to begin."""
        self._task: Generator[Any, Any, Any] | None = None  # the main loop, or the handler that came between
        self._in_handler = False
        self._frame_index: int | None = None
        """Index of the picture that is worked on, None between two."""
        self._is_full = False  # of work done ahead: the simulated time must come up
        self._is_spinning = False  # on a lock, when no handler comes between
        self.is_done = False
        """Whether the main loop has ended."""

    # What firmware uses

    def run(self, kernel: Kernel, *arguments: Row | int) -> Work:
        """Run a kernel on rows and ints. Yield the result: the cycles are charged then, and you get its value."""
        if self._unclaimed is not None:
            self._check_claimed()
        try:
            call = self._calls.known[kernel, kernel.arrays_of(arguments)]
        except (LookupError, TypeError, AttributeError):  # the first time, or something is wrong
            call = self._calls.prepare(kernel, arguments)
        self._unclaimed_kernel = kernel
        for each in call.handed_over:
            self._handovers.use(self.name, each)
        if call.stays_in_l1 or (call.is_alone and self._goes_ahead()):
            work = call.run(arguments)
        else:  # it may meet what others do, and runs when the simulated time is there
            work = DeferredWork(call, arguments)
        self._unclaimed = work
        return work

    def on_interrupt(self, source: str, handler: Handler) -> None:
        """Have `handler(core)` called at every interrupt of `source`, such as MDMA1_0, SPI_DMA or SUPPLEMENTAL_0.

        A handler may be a generator function that yields kernels.
        """
        self._interrupts.attach(source, handler)

    def request_interrupt(self, source: str) -> None:
        """Ask this core for an interrupt, as a device does."""
        self._interrupts.request(source)

    @awaited
    def idle(self) -> Generator[Any, Any, None]:
        """Wait for an interrupt, and let its handler run; one that was asked for already ends the wait at once."""
        before, self._in_handler = self._in_handler, True
        yield from self.sync()
        self._in_handler = before
        if not self._interrupts.is_waiting:
            yield from self._blocked(iter([self._interrupts.next_request()]), "an interrupt", None)
            self._wake(None, "wait for an interrupt")
        if not self._in_handler:
            yield from self._take_interrupts()

    # What the board uses

    def describe_wait(self) -> str:
        """Say what the core waits for and where in the firmware."""
        if self.is_done:
            return f"core {self.name} has ended"
        return f"core {self.name} waits for {self.waiting_for or 'a device'}{line_at(self._task)}"

    # Inside

    def _perform(self, task: Generator[Any, Any, Any]) -> Generator[Any, Any, None]:
        """Play a generator of the firmware: charge the kernels that it yields, and wait for the events."""
        before, self._task = self._task, task
        value = None
        while True:
            try:
                item = task.send(value)
            except StopIteration:
                break
            except (Exception, SystemExit) as error:
                raise self._told(error) from error
            if item is self._unclaimed and item is not None:
                self._unclaimed = None
                if isinstance(item, DeferredWork):
                    account = item.owner
                    yield from self.sync()
                    item = self._made(item, task)
                    stalls = (yield from self._outside_l1(item)) if item.accesses else {}
                    self._charge_work(item, stalls, self._account.of(account))
                else:
                    self._charge_call(item)
                value = item.value
            elif isinstance(item, simpy.Event):
                value = yield item
            else:
                raise self._misused(item, line_at(task))
            if self._is_full or (self._interrupts.are_handled and not self._in_handler):
                yield from self.sync()
        self._check_claimed()
        self._check_waits(task)
        self._task = before

    def sync(self) -> Generator[Any, Any, None]:
        """Wait until the simulated time has reached the core's clock, and take the interrupts that wait then."""
        yield from super().sync()
        while self.can_be_interrupted and self._interrupts.is_waiting:
            yield from self._take_interrupts()
            yield from super().sync()

    def catch_up(self) -> simpy.Event | None:
        """Return the event at which the simulated time reaches the core's clock, or now for an interrupt; None when it has."""
        late = super().catch_up()
        if late is None and self.can_be_interrupted and self._interrupts.is_waiting:
            return self._env.after(0)
        return late

    def wait_transfer(self, transfer: Transfer, reason: StallReason, owner: str) -> Generator[Any, Any, None]:
        """Wait as the clock does; interrupts that have handlers are taken as they come."""
        if self.can_be_interrupted:
            yield from self.sync()
            self._bus.settle()
            if not super().has(transfer):  # as the clock has it: a recording has every wait asked for
                yield from self._blocked(iter([self._end_of(transfer)]), "DMA", reason)
        yield from super().wait_transfer(transfer, reason, owner)

    def _end_of(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of `transfer`, which is behind the core's clock."""
        if transfer.end is None:
            return self._bus.when_done(transfer)
        return self._env.after(max(0, transfer.end - self._env.tick))

    def _goes_ahead(self) -> bool:
        """Whether calls that nobody else can meet run before the simulated time is there."""
        return False

    def _charge_call(self, work: Work) -> None:
        """Charge a call that has met nobody."""
        self._charge_work(work, {}, self._account.kernels)

    def _charge_work(self, work: Work, stalls: dict[StallReason, int], account: Account) -> None:
        """Let the cycles of a call pass, on `account`; `stalls` are those of its accesses outside L1."""
        if work.stall_cclk:
            stalls[StallReason.INTERLOCK] = work.stall_cclk
        if self._timeline:
            name = self._unclaimed_kernel.name if self._unclaimed_kernel else "TESTSET"
            self._timeline.call(name, self._cclk, work.issue_cclk, stalls)
        self._cclk += work.issue_cclk
        account.issue_cclk += work.issue_cclk
        for reason, cclk in stalls.items():
            self._cclk += cclk
            account.stall(reason, cclk)

    def _check_waits(self, task: Generator[Any, Any, Any]) -> None:
        """Raise FirmwareError if `task`, which has ended, has forgotten a wait."""
        try:
            self.waits.check()
        except FirmwareError as error:
            raise FirmwareError(f"{error} at the end of {name_of(task)}") from None

    def _misused(self, item: object, line: str) -> FirmwareError:
        """Return what is wrong with a yield of `item`, which is no call and no event."""
        if isinstance(item, Generator):
            wait = f"{name_of(item)}(...)"
            return FirmwareError(
                f"core {self.name}: a wait must be written `yield from {wait}`, not `yield {wait}`{line}"
            )
        return FirmwareError(
            f"core {self.name}: firmware must yield each core.run(...) once, or `yield from` a wait, not {shown(item)}{line}"
        )

    def _told(self, error: Exception | SystemExit) -> BfsimError:
        """Return what went wrong in the firmware, with its line there."""
        line = line_of(error)
        if isinstance(error, KernelError):
            return self._in_call(error, line)
        if isinstance(error, BfsimError):
            return type(error)(f"{error}{line}")
        what = f"{type(error).__name__}: {error}"
        if forgotten := self.waits.forgotten():
            return FirmwareError(f"{forgotten} ({what}){line}")
        if self._unclaimed is not None:
            return FirmwareError(f"core {self.name}: {UNYIELDED} ({what}){line}")
        return FirmwareError(f"core {self.name}: firmware failed with {what}{line}")

    def _made(self, work: DeferredWork, task: Generator[Any, Any, Any]) -> Work:
        """Make a call that `task` has yielded."""
        try:
            return work.run()
        except KernelError as error:
            raise self._in_call(error, line_at(task)) from error

    def _in_call(self, error: KernelError, line: str) -> KernelError:
        """Return a mistake in a kernel with where and when the firmware called it."""
        frame = "between two frames" if self._frame_index is None else f"frame {self._frame_index}"
        stage = "outside of stages" if self._calls.stage == REST else f"stage {self._calls.stage}"
        return KernelError(f"{error}\n    core {self.name}, {frame}, {stage}{line}")

    def _check_claimed(self) -> None:
        if self._unclaimed is not None:
            kernel = (
                f"core.run({self._unclaimed_kernel.name}, ...)" if self._unclaimed_kernel else "core.run(...)"
            )
            raise FirmwareError(
                f"core {self.name}: core.run(...) must be yielded, or its cycles are lost: write `yield {kernel}`"
            )

    def _outside_l1(self, work: Work) -> Generator[Any, Any, dict[StallReason, int]]:
        """Play the accesses of a call outside L1 from the core's clock on, and return the cycles that they stall."""
        begin, cclk = self.now_ticks, work.issue_cclk + work.stall_cclk
        yield self._bus.cores.access(self._number, begin, cclk, work.accesses)
        stalls = zip(BUS_STALLS, self._bus.cores.stalls_of(self._number), strict=True)
        return {reason: stalled for reason, stalled in stalls if stalled}

    @property
    def can_be_interrupted(self) -> bool:
        """Whether a handler would be called now."""
        return self._interrupts.are_handled and not self._in_handler

    def _blocked(self, wait: Any, what: str, reason: StallReason | None) -> Generator[Any, Any, Any]:
        """Play `wait`, a generator of events, saying meanwhile what the core waits for; interrupts are taken as they come."""
        if self.can_be_interrupted:
            wait = self._interruptible(wait, reason)
        return super()._blocked(wait, what, reason)

    def _interruptible(self, wait: Any, reason: StallReason | None) -> Generator[Any, Any, Any]:
        owed_cclk, what = 0, self.waiting_for
        self._in_handler = True  # the clock still stands where the wait began: nobody else may take them
        while True:
            try:
                event = next(wait)
            except StopIteration as end:
                result = end.value
                break
            while not event.processed:
                yield self._env.any_of([event, self._interrupts.next_request()])
                if self._interrupts.is_waiting:
                    passed_cclk = self._until(self._env.tick)
                    self._pass_waiting(reason, passed_cclk)
                    owed_cclk += passed_cclk
                    if self._is_spinning:
                        self._bus.cores.pause_spinning(self._number)
                    yield from self._take_interrupts()
                    if self._is_spinning:
                        self._bus.cores.spin(self._number, self.now_ticks)
                    self.waiting_for = what
        self._in_handler = False
        self._owed_cclk = owed_cclk
        return result

    def _take_interrupts(self) -> Generator[Any, Any, None]:
        """Run the handlers of all interrupts that wait; the way in and out is a stall."""
        events = self._board.chip.events
        before, self._in_handler = self._in_handler, True
        while self._interrupts.is_waiting:
            source, handler = self._interrupts.take()
            self._handovers.take(self.name, f"{source} of core {self.name}")
            begin_cclk = self._cclk
            with self._elsewhere():
                self.stall(StallReason.INTERRUPT, events.interrupt_entry_cclk, f"interrupt {source}")
                task = handler(self)
                if isinstance(task, Generator):
                    yield from self._perform(task)
                self.stall(StallReason.INTERRUPT, events.interrupt_exit_cclk, f"interrupt {source}")
            if self._timeline:
                self._timeline.interrupt(source, begin_cclk, self._cclk)
        self._in_handler = before
