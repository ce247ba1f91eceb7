"""A core: plays the firmware's main loop, charges what its kernels cost, and waits for the rest of the machine.

The core runs ahead of the simulated time: kernel work only adds to its own clock, and it catches up with
the simulated time where it meets another device. Every cycle of its clock goes to one account, so that
issue + stall + idle = elapsed holds by construction.
"""

from __future__ import annotations

import contextlib
import os
import traceback
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import index
from pathlib import Path
from typing import Any

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.errors import BfsimError, FirmwareError
from bfsim.kernel import Kernel, Work
from bfsim.kernel.followers import Follower
from bfsim.machine.accounts import FrameAccounts
from bfsim.machine.bus import Bus, Transfer
from bfsim.machine.cached_lines import CachedInput, CachedOutput
from bfsim.machine.calls import CallBook
from bfsim.machine.capture import Capture
from bfsim.machine.mdma import MdmaStream
from bfsim.machine.memories import Row
from bfsim.machine.program import Main
from bfsim.machine.ring import InputRing, OutputRing
from bfsim.machine.semaphore import Semaphore
from bfsim.machine.settling import CameraSettings
from bfsim.machine.simulation import Simulation
from bfsim.trace import REST, CoreFrame, StallReason

NOT_FIRMWARE = (str(Path(__file__).parent.parent) + os.sep, contextlib.__file__)
"""Where the code lies that firmware calls; a mistake is told with the line of the firmware itself."""


BUS_STALLS = (
    StallReason.L2_LATENCY, StallReason.L2_PORT, StallReason.SDRAM_PAGE_HIT, StallReason.SDRAM_PAGE_MISS,
    StallReason.SDRAM_PAGE_CONFLICT, StallReason.SDRAM_REFRESH, StallReason.EBIU_ARBITRATION, StallReason.STORE_BUFFER,
    StallReason.CACHE_FILL, StallReason.CODE_FETCH,
)  # fmt: skip
"""What the bus stalls a core for, in the order of its counters (`bus_state`)."""


@dataclass(frozen=True, slots=True)
class Frame:
    """One picture of this core's camera. `rows`: its lines in memory, 2 · `width` bytes of UYVY each."""

    index: int
    rows: Sequence[Row]
    width: int
    height: int


@dataclass(frozen=True, slots=True, kw_only=True)
class FinishedFrame:
    """What one core reports at the end of a frame."""

    index: int
    full_at_cclk: int
    cycles: CoreFrame
    results: Mapping[str, int]


class Core:
    """One core. Firmware gets it as the argument of its main loop."""

    def __init__(
        self,
        env: Simulation,
        name: str,
        board: BoardSpec,
        *,
        buffers: Mapping[str, tuple[Row, ...]],
        calls: CallBook,
        bus: Bus,
        number: int,
        follower: Follower,
        capture: Capture,
        streams: tuple[MdmaStream, MdmaStream],
        semaphores: dict[str, Semaphore],
        stages: tuple[str, ...],
        on_finished: Callable[[], None],
    ) -> None:
        """`streams`: the MDMA streams of its input and of its output rings. `on_finished`: called at a frame's end."""
        self.name = name
        self.finished: list[FinishedFrame] = []
        """Frames that are done, until the board takes them."""
        self.waiting_for: str | None = None
        """What the core waits for, in words, while only another device can let it go on."""
        self._env = env
        self._board = board
        self._cclk_ticks = board.clocks.cclk_ticks
        self._cclk = 0
        self._entered_at_cclk = 0
        self._accounts = FrameAccounts(name, stages)
        self._account = self._accounts.now
        self._stages = stages
        self._on_finished = on_finished
        self._buffers = buffers
        self._calls = calls
        self._bus = bus
        self._number = number
        self._follower = follower
        self._capture = capture
        self._streams = streams
        self._semaphores = semaphores
        self._frame: Frame | None = None
        self._full_at_cclk = 0
        self._results: dict[str, int] = {}
        self._unclaimed: Work | None = None
        self._main: Generator[Any, Any, None] | None = None

    # What firmware uses

    def rows(self, name: str) -> tuple[Row, ...]:
        """Return the rows of the buffer called `name`."""
        try:
            return self._buffers[name]
        except KeyError:
            known = ", ".join(sorted(self._buffers))
            raise FirmwareError(f"core {self.name} has no buffer {name!r}; it has {known}") from None

    def array(self, name: str) -> Row:
        """Return the only row of the buffer called `name`."""
        rows = self.rows(name)
        if len(rows) != 1:
            raise FirmwareError(f"buffer {name} has {len(rows)} rows; use core.rows({name!r})")
        return rows[0]

    def input_ring(self, image: Sequence[Row], ring: str) -> InputRing | CachedInput:
        """Return a ring that fetches the lines of `image` into the rows of buffer `ring`, one line ahead.

        Where the LDF has the image cached, its own rows take the place of the ring's.
        """
        if self._is_cached(image):
            return CachedInput(image)
        return InputRing(self, self._streams[0], image, self.rows(ring))

    def output_ring(self, ring: str, image: Sequence[Row]) -> OutputRing | CachedOutput:
        """Return a ring that takes finished lines from the rows of buffer `ring` to `image`, which may be cached as above."""
        if self._is_cached(image):
            return CachedOutput(image)
        return OutputRing(self, self._streams[1], self.rows(ring), image)

    def run(self, kernel: Kernel, *arguments: Row | int) -> Work:
        """Run a kernel on rows and ints. Yield the result: the cycles are charged then, and you get its value."""
        if self._unclaimed is not None:
            self._check_claimed()
        try:
            call = self._calls.known[kernel, kernel.arrays_of(arguments)]
        except (LookupError, TypeError):  # the first time, or something is wrong with the arguments
            call = self._calls.prepare(kernel, arguments)
        work = self._unclaimed = call.run(arguments)
        return work

    @contextlib.contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Charge everything inside to the row `name` of the budget."""
        if name not in self._stages:
            raise FirmwareError(f"stage must be one of {', '.join(self._stages)}, not {name!r}")
        before = self._calls.stage
        self._enter(name)
        yield
        self._enter(before)

    def next_frame(self) -> Generator[Any, Any, Frame | None]:
        """Finish the current frame and wait for the next picture; None when the recording is over."""
        if self._calls.stage != REST:
            raise FirmwareError(f"next_frame must be called outside of stages, not in {self._calls.stage!r}")
        self._check_claimed()
        yield from self._sync()
        self._close_frame()
        pair = yield from self._blocked(self._capture.claim(self.name), "the next picture")
        self._wake(None)
        if pair is None:
            return None
        self._full_at_cclk = -(-pair.full_at_ticks // self._cclk_ticks)
        rows = pair.rows[self.name]
        width = rows[0].nbytes // 2
        self._invalidate(rows)
        if lost := pair.lost.get(self.name, 0):
            self.publish(ppi_words_lost=lost)
        self._frame = Frame(pair.index, rows, width, len(rows))
        return self._frame

    def publish(self, **results: int) -> None:
        """Add numbers to the record of the current frame."""
        self._results.update({f"{name}_{self.name}": index(value) for name, value in results.items()})

    def set_camera(self, settings: CameraSettings) -> None:
        """Give this core's camera new settings: its next pictures are off in brightness and colour until they have worked.

        The two-wire bus to the camera is not modelled.
        """
        self._capture.change_camera(self.name, settings)

    def post(self, name: str) -> Generator[Any, Any, None]:
        """Add one to the semaphore `name`, in L2."""
        yield from self._test_and_set()
        self._semaphore(name).post()

    def wait(self, name: str) -> Generator[Any, Any, None]:
        """Take one from the semaphore `name`, waiting until another core has posted it."""
        yield from self._test_and_set()
        turn = self._semaphore(name).take()
        if turn is not None:
            yield from self._blocked(iter([turn]), f"semaphore {name!r}")
            self._wake(StallReason.SEMAPHORE)

    def _is_cached(self, image: Sequence[Row]) -> bool:
        return bool(image) and self._follower.caches(image[0].offset)

    def _invalidate(self, rows: Sequence[Row]) -> None:
        """Let the data cache forget what it holds of a picture that DMA has written over."""
        lines = self._follower.forget(rows[0].offset, rows[0].nbytes * len(rows))
        cclk = lines * self._board.chip.cache.invalidate_cclk
        self._cclk += cclk
        self._account.issue_cclk += cclk

    def _enter(self, stage: str) -> None:
        """Go over to another row of the budget, and charge the one that ends what conflicts in L1 cost it."""
        self._bus.settle()
        conflicts_cclk = self._calls.conflicts_cclk(self._cclk - self._entered_at_cclk)
        if conflicts_cclk:
            self._stall(StallReason.L1_CONFLICT, conflicts_cclk)
        self._entered_at_cclk = self._cclk
        self._accounts.enter(stage)
        self._account = self._accounts.now
        self._calls.enter(stage)

    # What rings use

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
            self._stall(reason, -(-late_ticks // self._cclk_ticks))

    # What the board uses

    def play(self, main: Main) -> Generator[Any, Any, None]:
        """Run the firmware's main loop: the process of this core."""
        self._main = task = main(self)
        if not isinstance(task, Generator):
            raise FirmwareError(f"core {self.name}: the main loop must be a generator function, not {main!r}")
        value = None
        while True:
            try:
                item = task.send(value)
            except StopIteration:
                break
            except Exception as error:
                raise self._told(error) from error
            if item is self._unclaimed and item is not None:
                self._unclaimed = None
                if item.accesses:
                    yield from self._outside_l1(item)
                self._cclk += item.issue_cclk + item.stall_cclk
                self._account.issue_cclk += item.issue_cclk
                if item.stall_cclk:
                    stalls = self._account.stall_cclk
                    stalls[StallReason.INTERLOCK] = stalls.get(StallReason.INTERLOCK, 0) + item.stall_cclk
                value = item.value
            elif isinstance(item, simpy.Event):
                value = yield item
            else:
                raise FirmwareError(
                    f"core {self.name}: firmware must yield each core.run(...) once, or `yield from` a wait, "
                    f"not {item!r}{self._place()}"
                )
        self._check_claimed()
        yield from self._sync()
        self._close_frame()
        self._main = None

    @property
    def is_done(self) -> bool:
        """Whether the main loop has ended."""
        return self._main is None

    def describe_wait(self) -> str:
        """Say what the core waits for and where in the firmware."""
        if self.is_done:
            return f"core {self.name} has ended"
        return f"core {self.name} waits for {self.waiting_for or 'a device'}{self._place()}"

    # Inside

    def _place(self) -> str:
        """Innermost line of the firmware that is being played, as ` (file:line)`."""
        place = ""
        generator: Any = self._main
        while generator is not None and getattr(generator, "gi_frame", None) is not None:
            code = generator.gi_frame.f_code
            if not code.co_filename.startswith(NOT_FIRMWARE):
                place = f" ({code.co_filename}:{generator.gi_frame.f_lineno})"
            generator = generator.gi_yieldfrom
        return place

    def _told(self, error: Exception) -> BfsimError:
        """Return what went wrong in the firmware, with its line there."""
        calls = traceback.extract_tb(error.__traceback__)
        places = [
            f"{each.filename}:{each.lineno}" for each in calls if not each.filename.startswith(NOT_FIRMWARE)
        ]
        place = f" ({places[-1]})" if places else ""
        if isinstance(error, BfsimError):
            return type(error)(f"{error}{place}")
        return FirmwareError(f"core {self.name}: firmware failed with {type(error).__name__}: {error}{place}")

    def _check_claimed(self) -> None:
        if self._unclaimed is not None:
            raise FirmwareError(f"core {self.name}: core.run(...) must be yielded, or its cycles are lost")

    def _sync(self) -> Generator[Any, Any, None]:
        if late := self.catch_up():
            yield late

    def _stall(self, reason: StallReason, cclk: int) -> None:
        self._cclk += cclk
        stalls = self._account.stall_cclk
        stalls[reason] = stalls.get(reason, 0) + cclk

    def _wake(self, reason: StallReason | None) -> None:
        """Go on at the first CCLK edge from now; the time since the core's clock was a stall, or idle without a reason."""
        waited_cclk = -(-self._env.tick // self._cclk_ticks) - self._cclk
        if waited_cclk <= 0:
            return
        if reason is None:
            self._cclk += waited_cclk
            self._account.idle_cclk += waited_cclk
        else:
            self._stall(reason, waited_cclk)

    def _blocked(self, wait: Any, what: str) -> Generator[Any, Any, Any]:
        """Play `wait`, a generator of events, saying meanwhile what the core waits for."""
        self.waiting_for = f"{what}, since cycle {self._cclk:,}"
        result = yield from wait
        self.waiting_for = None
        return result

    def _outside_l1(self, work: Work) -> Generator[Any, Any, None]:
        """Play the accesses of a call outside L1 from the core's clock on, and charge what they stall."""
        yield from self._sync()
        begin, cclk = self.now_ticks, work.issue_cclk + work.stall_cclk
        yield self._bus.access(self._number, begin, cclk, work.accesses)
        for reason, stalled in zip(BUS_STALLS, self._bus.stalls_of(self._number), strict=True):
            if stalled:
                self._stall(reason, stalled)

    def _test_and_set(self) -> Generator[Any, Any, None]:
        chip = self._board.chip
        self._cclk += chip.events.testset_cclk
        self._account.issue_cclk += chip.events.testset_cclk
        self._stall(StallReason.L2_LATENCY, chip.l2.read_cclk if chip.l2 else 0)
        yield from self._sync()

    def _semaphore(self, name: str) -> Semaphore:
        return self._semaphores.setdefault(name, Semaphore(self._env, name))

    def _close_frame(self) -> None:
        """Turn the cycles since the last frame's end into a record, if there was a frame."""
        if self._frame is None:
            return
        cycles = self._accounts.close(self._cclk)
        self._account = self._accounts.now
        self.finished.append(
            FinishedFrame(
                index=self._frame.index, full_at_cclk=self._full_at_cclk, cycles=cycles, results=self._results
            )
        )
        self._frame, self._results = None, {}
        self._on_finished()
