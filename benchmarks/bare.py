"""The floor of the speed benchmark: the same firmware and kernels on the same pixels, without counters, checks or time.

A `BareCore` answers firmware as a `Core` does, but copies lines at once and never waits; no SimPy is involved.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from bfsim.api import CameraSettings, Firmware, Frame, FrameSize, Kernel, Row, Work
from bfsim.chip.boards import CM_BF561
from bfsim.kernel import VDSP_O2
from bfsim.kernel.decorator import RunnableCall
from bfsim.linker import link, parse_ldf
from bfsim.machine.core.buffers.layouts import Layouts
from bfsim.machine.memories import Memories
from bfsim.machine.symbols import PROCESSORS, symbols_of
from bfsim.recording import StereoFrame
from bfsim.shipped import DEFAULT_LDFS


class Turn:
    """What a core yields before it takes a frame: the other core has its turn."""

    value = None


class BareInput:
    """Lines of a picture, copied when they are asked for."""

    def __init__(self, image: Sequence[Row], rows: Sequence[Row]) -> None:
        self._image, self._rows, self._taken = image, rows, 0

    def line(self) -> Generator[Any, Any, Row]:
        """Copy the next line."""
        row = self._rows[self._taken % len(self._rows)]
        row.octets[:] = self._image[self._taken].octets
        self._taken += 1
        return row
        yield

    def __getitem__(self, number: int) -> Row:
        return self._rows[number % len(self._rows)]


class BareOutput:
    """Finished lines, copied when they are sent."""

    def __init__(self, rows: Sequence[Row], image: Sequence[Row]) -> None:
        self._rows, self._image, self._sent = rows, image, 0

    def row(self) -> Generator[Any, Any, Row]:
        """Return the next row to write."""
        return self._rows[self._sent % len(self._rows)]
        yield

    def send(self) -> None:
        """Copy the row that was written."""
        self._image[self._sent].octets[:] = self._rows[self._sent % len(self._rows)].octets
        self._sent += 1

    def flush(self) -> Generator[Any, Any, None]:
        """Do nothing: every line has arrived."""
        return
        yield


class BareCore:
    """A core without time."""

    counted = False
    """Whether kernels run with their counters and checks."""

    def __init__(
        self, name: str, firmware: Firmware, frames: Sequence[StereoFrame], memories: Memories
    ) -> None:
        self.name = name
        height, double_width = frames[0].left.shape
        size = FrameSize(double_width // 2, height)
        places = link(parse_ldf(DEFAULT_LDFS["ADSP-BF561"]), symbols_of(firmware, size))
        buffers = firmware.buffers(size)
        rows = {
            each.name: memories.place(each, places.find(PROCESSORS[name], each.name))
            for owner in ("shared", name)
            for each in buffers.get(owner, ())
        }
        self._layouts = Layouts(name, memories, rows, size, lambda _: {})
        self.rows, self.overlay, self.part = self._layouts.rows, self._layouts.overlay, self._layouts.part
        self.use_size = self._layouts.use
        self._camera = rows[firmware.camera][:height]
        self._frames = iter(frames)
        self._size = size
        self._calls: dict[tuple[object, ...], RunnableCall] = {}

    def array(self, name: str) -> Row:
        """Return the only row of a buffer."""
        return self.rows(name)[0]

    def has_buffer(self, name: str) -> bool:
        """Return whether there is a buffer called `name`."""
        return self._layouts.has_buffer(name)

    def input_ring(self, image: Sequence[Row], ring: str | Sequence[Row]) -> BareInput:
        """Return an input ring without DMA."""
        return BareInput(image, self._ring(ring))

    def output_ring(self, ring: str | Sequence[Row], image: Sequence[Row]) -> BareOutput:
        """Return an output ring without DMA."""
        return BareOutput(self._ring(ring), image)

    def _ring(self, ring: str | Sequence[Row]) -> Sequence[Row]:
        return self.rows(ring) if isinstance(ring, str) else ring

    def run(self, kernel: Kernel, *arguments: Any) -> Work:
        """Run `kernel`."""
        key = (kernel, kernel.arrays_of(arguments))
        call = self._calls.get(key)
        if call is None:
            code = kernel.compile(VDSP_O2, counted=self.counted, checked=self.counted)
            rows = [arguments[each].array for each in kernel.array_positions]
            call = self._calls[key] = kernel.prepare(code, rows, code.new_totals())
        return call.run(*arguments)

    def at(self, *place: int | range) -> None:
        """Take no note of a place: nothing is drawn."""

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Charge nothing."""
        yield

    def next_frame(self) -> Generator[Any, Any, Frame | None]:
        """Copy the next picture into the camera's buffer."""
        yield Turn
        frame = next(self._frames, None)
        if frame is None:
            return None
        for row, line in zip(self._camera, frame.left if self.name == "A" else frame.right, strict=True):
            row.octets[:] = line
        return Frame(frame.index, self._camera, self._size.width_px, self._size.height_px)

    def set_camera(self, settings: CameraSettings) -> None:
        """Leave the camera as it is."""

    def set_picture_size(self, size: FrameSize) -> None:
        """Leave the pictures as large as they are."""

    def publish(self, **results: int) -> None:
        """Publish nothing."""

    def post(self, name: str) -> Generator[Any, Any, None]:
        """Meet nobody."""
        return
        yield

    wait = post

    def send(self, row: Row, nbytes: int) -> Generator[Any, Any, None]:
        """Send nothing."""
        return
        yield

    def receive(self, row: Row) -> Generator[Any, Any, int]:
        """Get nothing."""
        return 0
        yield


def run_bare(
    firmware: Firmware, frames: Sequence[StereoFrame], core: Callable[..., BareCore] = BareCore
) -> None:
    """Run both main loops over `frames`, frame by frame; the last core first, since core A reads what core B left.

    `core` makes a core from its name, the firmware, the frames and the memories.
    """
    memories = Memories(CM_BF561)
    cores = reversed(firmware.mains.items())
    tasks: list[Any] = [main(core(name, firmware, frames, memories)) for name, main in cores]  # type: ignore[arg-type]
    for _ in range(len(frames) + 1):  # up to the first frame, and every frame
        for task in tasks:
            _play_frame(task)


def _play_frame(task: Any) -> None:
    """Play a core until it takes the next frame, or has none left."""
    value = None
    with suppress(StopIteration):
        while (work := task.send(value)) is not Turn:
            value = work.value
