"""The generators of one core's firmware, its main loop and handlers: their kernels are charged, their events waited for."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Generator
from typing import Any, Protocol

import simpy

from bfsim.chip.block_spec import EventSpec
from bfsim.errors import BfsimError, FirmwareError, KernelError, is_failure, shown
from bfsim.kernel import Kernel, Work
from bfsim.kernel.calls.work import UNYIELDED
from bfsim.machine.calls.call_cache import CallCache, DeferredWork
from bfsim.machine.core.progress.progress import Progress
from bfsim.machine.core.synchronisation.handovers import Handovers
from bfsim.machine.core.tasks.asked import Asked
from bfsim.machine.core.waits import Wait, name_of
from bfsim.machine.firmware_lines import failure_of, line_at, line_of
from bfsim.machine.memories import Row
from bfsim.machine_code.going_on import OVER
from bfsim.trace import REST, StallReason

NO_KEYWORDS = "machine code() takes no keyword arguments"
IN_ORDER = "core.run(kernel, ...) takes the kernel and its arguments in their order, without names"
"""What Python says about `core.run(kernel, n=3)`, because machine code runs kernels, and what bfsim says instead."""


class Run(Protocol):
    """The function that runs kernels for firmware."""

    def __call__(self, kernel: Kernel, *arguments: Row | int) -> Work:
        """Run a kernel."""


class Tasks:
    """The tasks of core `name`'s firmware, one at a time.

    Machine code makes and notes the calls that no other device can notice (`machine_code.asking`, `going_on`). The others,
    and the first call of each, are made here.
    """

    def __init__(
        self, name: str, progress: Progress, calls: CallCache, handovers: Handovers, events: EventSpec
    ) -> None:
        self._name = name
        self._progress = progress
        self._interrupts = progress.interrupts
        self._calls = calls
        self._handovers = handovers
        self._events = events
        self._asked = Asked(calls, progress.tape, handovers.turn_of(name), self._run)
        self._work: Work  # of the last call that was made here
        self._task: Generator[Any, Any, Any] | None = None  # the main loop, or a handler in between
        self.run: Run = self._asked.ask
        """Runs a kernel, now or once its result is yielded. The result must be yielded next."""
        self.frame_index: int | None = None
        """Index of the current picture, None between two."""
        self.is_over = False
        """Whether the firmware was told that the recording is over."""

    def _run(self, kernel: Kernel, *arguments: Row | int) -> Work:
        """Run a kernel that machine code does not know, or return a promise to run it."""
        self.check_claimed()
        try:
            rows_of, calls = self._calls.known[kernel]
            call = calls[rows_of(arguments)]
        except (LookupError, TypeError, AttributeError):  # the first time, or something is wrong
            call = self._calls.prepare(kernel, arguments)
        for each in call.handed_over:
            self._handovers.use(self._name, each)
        self._asked.know(call, kernel, arguments)
        if call.stays_in_l1 or (call.is_alone and self._progress.runs_ahead):
            self._work = call.run(*arguments)
        else:  # other devices may notice it, so it runs at its simulated time
            self._work = DeferredWork(call, arguments)
        self._asked.hold(self._work, call)
        return self._work

    def perform(self, task: Generator[Any, Any, Any]) -> Wait:
        """Play a generator of the firmware: charge the kernels that it yields, and wait for its events."""
        before, self._task = self._task, task
        progress, interrupts, asked, value = self._progress, self._interrupts, self._asked, None
        while True:
            try:
                item = asked.go_on(task, value)
            except BaseException as error:
                if not is_failure(error):
                    raise
                raise self.told(error) from error
            if item is OVER:
                break
            if call := asked.claim(item):
                if isinstance(item, DeferredWork):
                    yield from progress.sync()
                    item = self._made(item, task)
                    yield from progress.play_call(item, call)
                elif not asked.is_noted:
                    charge = progress.charge_call if call.stays_in_l1 else progress.note_call
                    charge(item, call)
                value = item.value
            elif isinstance(item, simpy.Event):
                value = yield item
            else:
                raise self._misused(item, line_at(task))
            if progress.is_full or (interrupts.are_handled and not interrupts.is_held):
                yield from progress.sync()
        self.check_claimed()
        self._check_waits(task)
        self._task = before

    def idle(self) -> Wait:
        """Wait for an interrupt and let its handler run. One that was already requested ends the wait at once."""
        progress, interrupts = self._progress, self._interrupts
        with interrupts.held():
            yield from progress.sync()
        if not interrupts.is_waiting:
            yield from progress.blocked(iter([interrupts.next_request()]), "an interrupt", None)
            progress.clock.wake(None, "wait for an interrupt")
        if not interrupts.is_held:
            yield from self.serve_interrupts()

    def serve_interrupts(self) -> Wait:
        """Run the handlers of all pending interrupts. Entry and exit are stalls."""
        clock, interrupts, name = self._progress.clock, self._interrupts, self._name
        with interrupts.held():
            while interrupts.is_waiting:
                source, handler = interrupts.take()
                self._handovers.take(name, f"{source} of core {name}")
                begin_cclk = clock.cclk
                with clock.elsewhere():
                    clock.stall(
                        StallReason.INTERRUPT, self._events.interrupt_entry_cclk, f"interrupt {source}"
                    )
                    task = self._handled(handler)
                    if isinstance(task, Generator):
                        yield from self.perform(task)
                    clock.stall(
                        StallReason.INTERRUPT, self._events.interrupt_exit_cclk, f"interrupt {source}"
                    )
                if clock.timeline:
                    clock.timeline.interrupt(source, begin_cclk, clock.cclk)

    def _handled(self, handler: Callable[[], object]) -> object:
        """Call a handler of the firmware. It may be done at once or return a generator."""
        try:
            return handler()
        except BaseException as error:
            if not is_failure(error):
                raise
            raise self.told(error, handler) from error

    def check_claimed(self) -> None:
        """Raise FirmwareError if a call was not yielded."""
        if call := self._asked.unclaimed:
            raise FirmwareError(
                f"core {self._name}: core.run(...) must be yielded, or its cycles are lost: "
                f"write `yield core.run({call.name}, ...)`"
            )

    def describe_wait(self) -> str:
        """Say what the core waits for, and where in the firmware."""
        return (
            f"core {self._name} waits for {self._progress.waits.present or 'a device'}{line_at(self._task)}"
        )

    # ---- what is wrong with the firmware

    def told(self, error: BaseException, called: object = None) -> BfsimError:
        """Return the error of the firmware with its line, or unchanged if the operating system refused bfsim something.

        `called` is what was called, if the call itself may be what was wrong.
        """
        if isinstance(error, BfsimError) and isinstance(error.__cause__, OSError):
            return error
        line = line_of(error, called)
        if isinstance(error, KernelError):
            return self._in_call(error, line)
        if isinstance(error, BfsimError):
            return type(error)(f"{error}{line}")
        what = f"TypeError: {IN_ORDER}" if str(error).endswith(NO_KEYWORDS) else failure_of(error)
        if forgotten := self._progress.waits.forgotten():
            return FirmwareError(f"{forgotten} ({what}){line}")
        if self._asked.unclaimed:
            return FirmwareError(f"core {self._name}: {UNYIELDED} ({what}){line}")
        return FirmwareError(f"core {self._name}: firmware failed with {what}{self._advice(error)}{line}")

    def _advice(self, error: BaseException) -> str:
        """Return what the author of the firmware may have overlooked."""
        if self.is_over:
            return "; core.next_frame() had given None, for the recording is over, and then the main loop must end"
        if isinstance(error, AttributeError) and error.name is not None:
            known = [each for each in dir(error.obj) if not each.startswith("_")]
            near = difflib.get_close_matches(error.name, known, n=3, cutoff=0.4)
            return f"; near it are {', '.join(near)}" if near else ""
        return ""

    def _check_waits(self, task: Generator[Any, Any, Any]) -> None:
        """Raise FirmwareError if `task`, which has ended, has forgotten a wait."""
        try:
            self._progress.waits.check()
        except FirmwareError as error:
            raise FirmwareError(f"{error} at the end of {name_of(task)}") from None

    def _misused(self, item: object, line: str) -> FirmwareError:
        """Return the error for a yield of `item`, which is neither a call nor an event."""
        if isinstance(item, Generator):
            wait = f"{name_of(item)}(...)"
            return FirmwareError(
                f"core {self._name}: a wait must be written `yield from {wait}`, not `yield {wait}`{line}"
            )
        return FirmwareError(
            f"core {self._name}: firmware must yield each core.run(...) once, or `yield from` a wait, not {shown(item)}{line}"
        )

    def _made(self, work: DeferredWork, task: Generator[Any, Any, Any]) -> Work:
        """Make a call that `task` has yielded."""
        try:
            return work.run()
        except KernelError as error:
            raise self._in_call(error, line_at(task)) from error
        except KeyboardInterrupt as error:  # the line that asked for it has been left
            raise KeyboardInterrupt(f"{error}{line_at(task)}") from None

    def _in_call(self, error: KernelError, line: str) -> KernelError:
        """Return a kernel's error, with where and when the firmware called it."""
        frame = "between two frames" if self.frame_index is None else f"frame {self.frame_index}"
        stage = "outside of stages" if self._calls.stage == REST else f"stage {self._calls.stage}"
        return KernelError(f"{error}\n    core {self._name}, {frame}, {stage}{line}")
