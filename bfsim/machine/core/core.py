"""A core: plays the firmware's main loop, charges what its kernels cost, and waits for the rest of the machine."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from functools import partial
from operator import index
from typing import Any

from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError, shown
from bfsim.kernel.access_trace import AccessTrace
from bfsim.kernel.types import Number
from bfsim.machine.buffers import FrameSize
from bfsim.machine.bus.bus import Bus
from bfsim.machine.calls.cached_lines import CachedInput, CachedOutput
from bfsim.machine.calls.call_cache import CallCache
from bfsim.machine.calls.conflicts import Accesses
from bfsim.machine.cameras.capture import Capture
from bfsim.machine.cameras.settling import CameraSettings
from bfsim.machine.core.accounts import KERNELS
from bfsim.machine.core.frames import FinishedFrame, Frame
from bfsim.machine.core.layouts import Layouts
from bfsim.machine.core.readout import Readout, seen_by
from bfsim.machine.core.synchronised import SharedObjects, SynchronisedCore
from bfsim.machine.core.waits import awaited
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.dma.memory_dma import Dma, MemoryDma
from bfsim.machine.dma.ring import InputRing, OutputRing
from bfsim.machine.memories import Row
from bfsim.machine.peripherals.peripheral import Peripheral
from bfsim.machine.simulation import Simulation
from bfsim.seen import Seen
from bfsim.spans import Place
from bfsim.trace import REST, StallReason

CAMERAS = "cameras"
"""Owner of cycles."""
SPI = "SPI"
"""The peripheral that is meant where firmware names none."""


Pixels = Callable[[], Iterable[tuple[int, int]]]
"""What returns the row and the column of single pixels, and is called only if someone looks."""

Columns = int | range | Callable[[], Iterable[int]]
"""Columns of a picture: one, those of a range, or what returns single ones and is called only if someone looks."""


def _range(places: int | range) -> range:
    return places if isinstance(places, range) else range(index(places), index(places) + 1)


def _place(rows: int | range | Pixels, columns: Columns | None) -> Place | None:
    if callable(rows):
        pixels = sorted(set(rows()))
        return Place(*zip(*pixels, strict=True)) if pixels else None
    if columns is None:
        return Place(_range(rows))
    if callable(columns):
        return Place(_range(rows), tuple(sorted(set(columns()))) or None)
    return Place(_range(rows), _range(columns))


class Core(SynchronisedCore):
    """One core. Firmware gets it as the argument of its main loop."""

    def __init__(
        self,
        env: Simulation,
        name: str,
        board: BoardSpec,
        *,
        layouts: Layouts,
        calls: CallCache,
        bus: Bus,
        number: int,
        access_trace: AccessTrace,
        capture: Capture,
        streams: tuple[MdmaStream, MdmaStream],
        dma: Dma,
        peripherals: Mapping[str, Peripheral],
        shared: SharedObjects,
        stages: tuple[str, ...],
        on_finished: Callable[[], None],
        view: Callable[[Readout], Seen | None] | None,
    ) -> None:
        """`streams`: the MDMA streams of its input and of its output rings. `on_finished`: called at a frame's end.

        `view`: reads out what was seen, if anyone wants to know.
        """
        super().__init__(
            env,
            name,
            board,
            bus=bus,
            number=number,
            stages=stages,
            calls=calls,
            interrupts=shared.interrupts[name],
            handovers=shared.handovers,
        )
        self.finished: list[FinishedFrame] = []
        """Frames that are done, until the board takes them."""
        self._entered_at_cclk = 0
        self._stages = stages
        self._on_finished = on_finished
        self._layouts = layouts
        self._view = view
        self._access_trace = access_trace
        self._capture = capture
        self._streams = streams
        self._dma = dma
        self._peripherals = peripherals
        self._shared = shared
        self._frame: Frame | None = None
        self._is_over = False
        self._full_at_cclk = 0
        self._results: dict[str, int] = {}
        self._remarks: list[str] = []

    # What firmware uses

    def rows(self, name: str) -> tuple[Row, ...]:
        """Return the rows of the buffer called `name`."""
        return self._layouts.rows(name)

    def array(self, name: str) -> Row:
        """Return the only row of the buffer called `name`."""
        rows = self.rows(name)
        if len(rows) != 1:
            raise FirmwareError(f"buffer {name} has {len(rows)} rows; use core.rows({name!r})")
        return rows[0]

    def has_buffer(self, name: str) -> bool:
        """Whether there is a buffer called `name`: some come only with the tables of a recording."""
        return name in self._layouts

    def overlay(self, buffer: str | Sequence[Row], element: Number, columns: int) -> tuple[Row, ...]:
        """Return the memory of the buffer of that name, or of the rows of a picture, all as one, as rows of another kind: a union in C."""
        return self._layouts.overlay(buffer, element, columns)

    def part(self, rows: Sequence[Row], first: int, count: int) -> tuple[Row, ...]:
        """Return `count` elements of each row from element `first` on, such as the columns of an area: no bytes move."""
        return self._layouts.part(rows, first, count)

    def use_size(self, size: FrameSize) -> None:
        """Have the buffers from now on as firmware declares them for pictures of `size`, in the memory of the full ones.

        Their contents are not moved. Raises FirmwareError for a size that the memory has no room for.
        """
        self._layouts.use(size)

    def input_ring(self, image: Sequence[Row], ring: str | Sequence[Row]) -> InputRing | CachedInput:
        """Return a ring that fetches the lines of `image` into rows, or those of the buffer `ring`, one line ahead.

        Where the LDF has the image cached, its own rows take the place of the ring's.
        """
        if self._is_cached(image):
            return CachedInput(image, self.take_line)
        return self.window_ring(image, self.rows(ring) if isinstance(ring, str) else ring)

    def window_ring(self, image: Sequence[Row], rows: Sequence[Row]) -> InputRing:
        """Return a ring that fetches the lines of `image` into `rows`, where kernels need them, even if it is cached."""
        return InputRing(self, self._streams[0], image, rows, self.take_line)

    def output_ring(self, ring: str, image: Sequence[Row]) -> OutputRing | CachedOutput:
        """Return a ring that takes finished lines from the rows of buffer `ring` to `image`, which may be cached as above."""
        if self._is_cached(image):
            return CachedOutput(image)
        return OutputRing(self, self._streams[1], self.rows(ring), image)

    @contextlib.contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Charge everything inside to the row `name` of the budget."""
        if name not in self._stages:
            raise FirmwareError(f"stage must be one of {', '.join(self._stages)}, not {name!r}")
        before = self._calls.stage
        with self._elsewhere():
            self._enter(name)
            yield
            self.at()
            self._enter(before)

    def at(self, rows: int | range | Pixels | None = None, columns: Columns | None = None) -> None:
        """Say what the work from here on is about, for the heat map: rows and columns of the picture that is looked at.

        `columns` may also be a function that returns single ones, such as those of edges, and in the place of both may be one that
        returns (row, column) of single pixels, such as those under lines: it is called only if someone looks.
        Without columns it is the whole rows, without anything no place. That holds until the next `at` or the end of the
        stage; rows without columns, or no place, also until the next line of a ring over a picture as high as the camera's,
        which is the place then. It takes no cycle.
        """
        if self._timeline:
            self._timeline.place = None if rows is None else _place(rows, columns)

    @awaited
    def next_frame(self) -> Generator[Any, Any, Frame | None]:
        """Finish the current frame and wait for the next picture; None when the recording is over."""
        if self._calls.stage != REST:
            raise FirmwareError(f"next_frame must be called outside of stages, not in {self._calls.stage!r}")
        if self._is_over:
            raise FirmwareError("next_frame must not be called again after None, for the recording is over")
        self._check_claimed()
        yield from self.sync()
        self.at()
        self._close_frame()
        pair = yield from self._blocked(self._capture.claim(self.name), "the next picture", None)
        self._wake(None, CAMERAS, ended_by=pair.last if pair else None)
        if pair is None:
            self._is_over = True
            return None
        events = self._board.chip.events  # the interrupt of the PPI's DMA ends the wait
        self.stall(StallReason.INTERRUPT, events.interrupt_entry_cclk + events.interrupt_exit_cclk, CAMERAS)
        self._full_at_cclk = -(-pair.full_at_ticks // self._cclk_ticks)
        rows = pair.picture[self.name]
        width = rows[0].nbytes // 2
        self._invalidate(rows)
        if lost := pair.lost.get(self.name, 0):
            self.publish(ppi_words_lost=lost)
        self._frame, self._frame_index = Frame(pair.index, rows, width, len(rows)), pair.index
        return self._frame

    def publish(self, **results: int) -> None:
        """Add numbers to the record of the current frame."""
        self._results.update({f"{name}_{self.name}": index(value) for name, value in results.items()})

    def set_camera(self, settings: CameraSettings) -> None:
        """Give this core's camera new settings: its next pictures are off in brightness and colour until they have worked.

        The two-wire bus to the camera is not modelled.
        """
        self.when_there(partial(self._capture.change_camera, self.name, settings))

    @awaited
    def ppi_status(self) -> Generator[Any, Any, int]:
        """Read PPI_STATUS of this core's PPI, which clears it: the bits of `PpiStatusBit` that were set since the last time."""
        self.program_device(CAMERAS, writes=0, reads=1)
        yield from self.sync()
        return self._capture.read_status(self.name)

    def set_picture_size(self, size: FrameSize) -> None:
        """Have this core's camera send pictures of `size`: the recorded one, half or a quarter of it.

        It does so once every camera is told the same, from the next picture on that it begins.
        """
        self.when_there(partial(self._capture.change_size, self.name, size))

    def remark(self, text: str) -> None:
        """Add a sentence about the current frame to the report."""
        self._remarks.append(f"core {self.name} {text}")

    def memory_dma(self, name: str) -> MemoryDma:
        """Return the memory DMA stream `name`, such as MDMA2_1 or IMDMA_0, to be programmed by its registers."""
        return self._dma.stream(name, self)

    @awaited
    def send(self, row: Row, nbytes: int, over: str = SPI) -> Generator[Any, Any, None]:
        """Send the first `nbytes` of `row` to the device on the peripheral `over`, by DMA, once the message before is out."""
        peripheral = self._peripheral(over)
        yield from self.sync()
        if peripheral.sending is not None:
            yield from self._blocked(iter([peripheral.sending]), f"the {over}", StallReason.RING_FULL)
            self._wake(StallReason.RING_FULL, over)
        self.program_device(over, writes=peripheral.transfer_writes)
        yield from self.sync()
        peripheral.send(row, nbytes)

    @awaited
    def receive(self, row: Row, over: str = SPI) -> Generator[Any, Any, int]:
        """Take the next message of the device on the peripheral `over` into `row`, if it has one; return its bytes, 0 without one."""
        peripheral = self._peripheral(over)
        yield from self.sync()
        if not peripheral.has_message:
            return 0
        self.program_device(over, writes=peripheral.transfer_writes)
        yield from self.sync()
        if not peripheral.has_message:  # the other core was faster
            return 0
        transfer, nbytes = peripheral.receive(row)
        yield from self.wait_transfer(transfer, StallReason.RING_EMPTY, over)
        return nbytes

    def _peripheral(self, name: str) -> Peripheral:
        if name not in self._peripherals:
            raise FirmwareError(f"messages must go over {' or '.join(self._peripherals)}, not {shown(name)}")
        return self._peripherals[name]

    def _is_cached(self, image: Sequence[Row]) -> bool:
        return bool(image) and self._access_trace.caches(image[0].offset)

    def _invalidate(self, rows: Sequence[Row]) -> None:
        """Let the data cache forget what it holds of a picture that DMA has written over."""
        lines = self._access_trace.forget(rows[0].offset, rows[0].nbytes * len(rows))
        cclk = lines * self._board.chip.cache.invalidate_cclk
        self.issue(cclk, CAMERAS)

    def _enter(self, stage: str) -> None:
        """Go over to another row of the budget, and charge the one that ends what conflicts in L1 cost it."""
        self._check_claimed()
        accessed = self._calls.accessed()
        self._calls.enter(stage)
        self.when_there(partial(self._change_account, stage, accessed))

    def _change_account(self, stage: str, accessed: Accesses) -> None:
        """Let cycles go to `stage` from now on; what was `accessed` in L1 before is charged to the one that ends."""
        self._bus.settle()
        conflicts_cclk = self._calls.conflicts_cclk(accessed, self._cclk - self._entered_at_cclk)
        if conflicts_cclk:
            self.stall(StallReason.L1_CONFLICT, conflicts_cclk, KERNELS)
        self._entered_at_cclk = self._cclk
        if self._timeline:
            self._timeline.enter(stage, self._cclk)
        self._accounts.enter(stage)
        self._account = self._accounts.now

    # What the board uses

    def take_line(self, number: int, lines: int) -> None:
        """Note that the core took a line of a picture of so many `lines`, and works on it unless it says more exactly where."""
        if self._timeline and self._frame and lines == self._frame.height:
            place = self._timeline.place
            if place is None or place.columns is None:
                self.at(number)

    def play(self, main: Callable[[Core], Generator[Any, Any, None]]) -> Generator[Any, Any, None]:
        """Run the firmware's main loop: the process of this core."""
        try:
            task = main(self)
        except (Exception, SystemExit) as error:
            raise self._told(error) from error
        if not isinstance(task, Generator):
            raise FirmwareError(
                f"core {self.name}: the main loop must be a generator function, not {main!r}: "
                "it waits with `yield from core.next_frame()`, and runs kernels with `yield core.run(...)`"
            )
        yield from self._perform(task)
        yield from self.sync()
        self._close_frame()
        self.is_done = True

    @property
    def is_over(self) -> bool:
        """Whether the firmware was told that the recording is over."""
        return self._is_over

    def _close_frame(self) -> None:
        """Turn the cycles since the last frame's end into a record, if there was a frame."""
        if self._frame is None:
            return
        if self._timeline:
            self._timeline.end_frame(self._frame.index, self._cclk)
        snapshot = self._calls.snapshot()
        cycles = self._accounts.close(self._cclk, *self._calls.close(snapshot))
        self._account = self._accounts.now
        self.finished.append(
            FinishedFrame(
                index=self._frame.index,
                full_at_cclk=self._full_at_cclk,
                cycles=cycles,
                counted=snapshot,
                results=self._results,
                remarks=tuple(self._remarks),
                seen=seen_by(self._view, Readout(self, self._frame, self._results)) if self._view else None,
            )
        )
        self._frame, self._frame_index, self._results, self._remarks = None, None, {}, []
        self._on_finished()
