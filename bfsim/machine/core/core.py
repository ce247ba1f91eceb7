"""A core as its firmware sees it: everything that a main loop and its handlers may ask for. Its parts do the work."""

from __future__ import annotations

import contextlib
from collections.abc import Generator, Iterator, Sequence
from functools import partial
from inspect import iscoroutinefunction
from operator import index
from typing import Any

from bfsim.errors import FirmwareError, shown
from bfsim.kernel.types import Number
from bfsim.machine.buffers import FrameSize
from bfsim.machine.calls.cached_lines import CachedInput, CachedOutput
from bfsim.machine.cameras.settling import CameraSettings
from bfsim.machine.core.interrupts import CoreHandler
from bfsim.machine.core.parts import Parts
from bfsim.machine.core.pictures.frames import Frame
from bfsim.machine.core.pictures.pictures import CAMERAS
from bfsim.machine.core.pictures.places import Columns, Pixels
from bfsim.machine.core.tasks.tasks import Run
from bfsim.machine.core.waits import awaited, entered
from bfsim.machine.dma.memory_dma import MemoryDma
from bfsim.machine.dma.ring import InputRing, OutputRing
from bfsim.machine.memories import Row
from bfsim.machine_code.built_in import idle

SPI = "SPI"
"""The peripheral that firmware means if it names none."""


class Core:
    """One core. Firmware gets it as the argument of its main loop.

    `yield core.run(kernel, *arguments)` runs a kernel on rows and ints, charges its cycles and gives its value.
    `core.name` is A or B.
    """

    run: Run
    """Run a kernel on rows and ints. Yield the result to charge the cycles and get the kernel's value."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        # firmware asks for this most, so no call stands between; and no cached_property, because with one, Python 3.11 looks
        # up all attributes of the object by name, which takes four times as long
        self.run = parts.tasks.run
        self._waits = parts.progress.waits
        # firmware asks for these most
        self._tasks, self._pictures, self._layouts = parts.tasks, parts.pictures, parts.layouts
        self._arrays = parts.layouts.arrays
        if not parts.clock.timeline:
            self.at = idle()  # type: ignore[method-assign]  # firmware calls it all the time, and nobody looks
        self.name = parts.name
        """Name of the core: A or B."""

    @property
    def now_ticks(self) -> int:
        """The core's own clock, in ticks of the simulation. It does not include waits that a core running ahead has not met yet."""
        return self._parts.clock.ticks

    # ---- stages

    @entered
    @contextlib.contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Charge everything inside to the row `name` of the budget."""
        self._parts.stages.check(name)
        before = self._parts.stages.present
        with self._parts.clock.elsewhere():
            self._enter(name)
            yield
            self.at()
            self._enter(before)

    def _enter(self, stage: str) -> None:
        self._tasks.check_claimed()
        self._parts.stages.enter(stage)

    # ---- memory

    def rows(self, name: str) -> tuple[Row, ...]:
        """Return the rows of the buffer called `name`."""
        return self._layouts.rows(name)

    def array(self, name: str) -> Row:
        """Return the only row of the buffer called `name`."""
        return self._arrays[name]

    def has_buffer(self, name: str) -> bool:
        """Whether there is a buffer called `name`. Some exist only if the recording has tables."""
        return self._layouts.has_buffer(name)

    def overlay(self, buffer: str | Sequence[Row], element: Number, columns: int) -> tuple[Row, ...]:
        """Return the memory of a buffer, by its name, or of the rows of a picture, as rows of another kind, like a union in C."""
        return self._layouts.overlay(buffer, element, columns)

    def part(self, rows: Sequence[Row], first: int, count: int) -> tuple[Row, ...]:
        """Return `count` elements of each row from element `first` on, such as the columns of an area. No bytes move."""
        return self._layouts.part(rows, first, count)

    def use_size(self, size: FrameSize) -> None:
        """Lay out the buffers as the firmware declares them for pictures of `size`, in the memory of the full ones.

        Contents are not moved. Raises FirmwareError for a size that does not fit.
        """
        self._layouts.use(size)

    # ---- lines of pictures, and other copies

    def input_ring(self, image: Sequence[Row], ring: str | Sequence[Row]) -> InputRing | CachedInput:
        """Return a ring that fetches the lines of `image` one line ahead into `ring`, rows or the name of a buffer.

        If the LDF has the image cached, its own rows are used instead of the ring's.
        """
        return self._parts.rings.input(image, ring)

    def window_ring(self, image: Sequence[Row], rows: Sequence[Row]) -> InputRing:
        """Return a ring that fetches the lines of `image` into `rows` even if the image is cached."""
        return self._parts.rings.window(image, rows)

    def output_ring(self, ring: str, image: Sequence[Row]) -> OutputRing | CachedOutput:
        """Return a ring that moves finished lines from the buffer `ring` to `image`, which may be cached as above."""
        return self._parts.rings.output(ring, image)

    def memory_dma(self, name: str) -> MemoryDma:
        """Return the memory DMA stream `name`, such as MDMA2_1 or IMDMA_0, to program its registers."""
        self._parts.progress.stay_in_step()  # what it moves may belong to anyone
        return self._parts.dma.stream(name, self._parts.progress)

    # ---- pictures

    @awaited
    def next_frame(self) -> Generator[Any, Any, Frame | None]:
        """Finish the current frame and wait for the next picture. Return None when the recording is over."""
        frame: Frame | None = yield from self._pictures.next_frame()
        return frame

    def at(
        self, rows: int | range | Pixels | None = None, columns: Columns | None = None, *taken: Any
    ) -> None:
        """Say which rows and columns of the picture the work from here on belongs to, for the heat map.

        Without columns it belongs to whole rows, without any argument to no place. `columns` may be a function, followed by its
        arguments, that returns single columns, such as those of edges. In place of both, a function may return (row, column) of
        single pixels, such as those under lines. Functions are called only if someone looks. The place holds until the next
        `at` or the end of the stage. Rows without columns, or no place, hold only until the next line of a ring over a picture
        as high as the camera's, which is then the place. It takes no cycles.
        """
        self._pictures.at(rows, columns, *taken)

    def publish(self, **results: int) -> None:
        """Add numbers to the record of the current frame. Raises FirmwareError if one is not a 64-bit integer."""
        self._pictures.publish(**{name: self._integer(name, value) for name, value in results.items()})

    def _integer(self, name: str, value: int) -> int:
        if not name.isidentifier():
            raise FirmwareError(
                f"core {self.name}: a result must have a name such as edges_found, not {shown(name)}"
            )
        try:
            number = index(value)
        except TypeError:
            raise FirmwareError(
                f"core {self.name}: the result {name} must be an integer, not {shown(value)}; with a fraction, publish it in a smaller unit"
            ) from None
        if not -(2**63) <= number < 2**63:
            raise FirmwareError(
                f"core {self.name}: the result {name} must fit in 64 bits, not {shown(value)}"
            )
        return number

    def remark(self, text: str) -> None:
        """Add a sentence about the current frame to the report, as one line. Raises FirmwareError unless it is text."""
        self._pictures.remark(text)

    def set_camera(self, settings: CameraSettings) -> None:
        """Give this core's camera new settings. Brightness and colour of its next pictures are off until they take effect.

        The two-wire bus to the camera is not modelled.
        """
        if not isinstance(settings, CameraSettings):
            raise FirmwareError(f"set_camera must get a bfsim.api.CameraSettings, not {shown(settings)}")
        change = partial(self._parts.capture.change_camera, self.name, settings)
        self._parts.progress.when_there(change)

    def set_picture_size(self, size: FrameSize) -> None:
        """Have this core's camera send pictures of `size`: the recorded size, half or a quarter of it.

        The camera does so from its next picture on, once every camera has been given the same size.
        """
        self._parts.progress.when_there(partial(self._parts.capture.change_size, self.name, size))

    @awaited
    def ppi_status(self) -> Generator[Any, Any, int]:
        """Read and clear PPI_STATUS of this core's PPI: the bits of `PpiStatusBit` set since the last time."""
        self._parts.progress.program_device(CAMERAS, writes=0, reads=1)
        yield from self._parts.progress.sync()
        return self._parts.capture.read_status(self.name)

    # ---- messages

    @awaited
    def send(self, row: Row, nbytes: int, over: str = SPI) -> Generator[Any, Any, None]:
        """Send the first `nbytes` of `row` by DMA to the device on the peripheral `over`, after the previous message."""
        yield from self._parts.messages.send(row, nbytes, over)

    @awaited
    def receive(self, row: Row, over: str = SPI) -> Generator[Any, Any, int]:
        """Receive the next message of the device on the peripheral `over` into `row`; return its bytes, 0 if there is none."""
        nbytes: int = yield from self._parts.messages.receive(row, over)
        return nbytes

    # ---- the other core

    @awaited
    def post(self, name: str) -> Generator[Any, Any, None]:
        """Add one to the semaphore `name`, in L2."""
        yield from self._parts.synchronisation.post(name)

    @awaited
    def wait(self, name: str) -> Generator[Any, Any, None]:
        """Subtract one from the semaphore `name`, trying until another core has posted it."""
        yield from self._parts.synchronisation.wait(name)

    @awaited
    def lock(self, name: str) -> Generator[Any, Any, None]:
        """Take the spin lock `name`, trying until the other core gives it back."""
        yield from self._parts.synchronisation.lock(name)

    @awaited
    def unlock(self, name: str) -> Generator[Any, Any, None]:
        """Give the spin lock `name` back."""
        yield from self._parts.synchronisation.unlock(name)

    @awaited
    def interrupt_core(self, other: str) -> Generator[Any, Any, None]:
        """Raise the supplemental interrupt SUPPLEMENTAL_0 of another core."""
        yield from self._parts.synchronisation.interrupt_core(other)

    # ---- interrupts

    def on_interrupt(self, source: str, handler: CoreHandler) -> None:
        """Call `handler(core)` at every interrupt of `source`, such as MDMA1_0, SPI_DMA or SUPPLEMENTAL_0.

        A handler may be a generator function that yields kernels. Raises FirmwareError unless it is a function, and for `async` ones.
        """
        if not callable(handler) or iscoroutinefunction(handler):
            what = "an `async` one" if callable(handler) else shown(handler)
            raise FirmwareError(
                f"on_interrupt must get a function of the core for {source}, or a generator function, not {what}"
            )
        self._parts.progress.on_interrupt(source, partial(handler, self))

    def request_interrupt(self, source: str) -> None:
        """Request an interrupt of this core, as a device does."""
        self._parts.progress.request_interrupt(source)

    @awaited
    def idle(self) -> Generator[Any, Any, None]:
        """Wait for an interrupt and run its handler. An interrupt that is already pending ends the wait at once."""
        yield from self._tasks.idle()
