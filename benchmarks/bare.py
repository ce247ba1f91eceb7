"""The floor of the speed benchmark: the same firmware and kernels on the same pixels, without counters or time.

A `BareCore` answers firmware as a `Core` does, but copies lines at once and never waits; no SimPy is involved.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from bfsim.api import Firmware, Frame, FrameSize, Kernel, Row, Work
from bfsim.chip.boards import CM_BF561
from bfsim.kernel import VDSP_O2, PreparedCall
from bfsim.kernel.types import Number
from bfsim.linker import link, parse_ldf
from bfsim.machine.board import PROCESSORS, symbols_of
from bfsim.machine.memories import Memories
from bfsim.recording import StereoFrame
from bfsim.run import THESIS_LDF


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

    def __init__(self, name: str, firmware: Firmware, frames: Sequence[StereoFrame]) -> None:
        self.name = name
        height, double_width = frames[0].left.shape
        size = FrameSize(double_width // 2, height)
        places = link(parse_ldf(THESIS_LDF), symbols_of(firmware, size))
        self._memories = memories = Memories(CM_BF561)
        buffers = firmware.buffers(size)
        self._rows = {
            each.name: memories.place(each, places.find(PROCESSORS[name], each.name))
            for owner in ("shared", name)
            for each in buffers.get(owner, ())
        }
        self._camera = self._rows[firmware.camera][:height]
        self._frames = iter(frames)
        self._size = size
        self._calls: dict[tuple[object, ...], PreparedCall] = {}
        self._overlays: dict[tuple[object, ...], tuple[Row, ...]] = {}

    def rows(self, name: str) -> tuple[Row, ...]:
        """Return the rows of a buffer."""
        return self._rows[name]

    def array(self, name: str) -> Row:
        """Return the only row of a buffer."""
        return self._rows[name][0]

    def has_buffer(self, name: str) -> bool:
        """Return whether there is a buffer called `name`."""
        return name in self._rows

    def overlay(self, name: str, element: Number, columns: int) -> tuple[Row, ...]:
        """Return the memory of a buffer as rows of another kind."""
        kind = (name, element, columns)
        if kind not in self._overlays:
            self._overlays[kind] = self._memories.overlay(self._rows[name], element, columns)
        return self._overlays[kind]

    def input_ring(self, image: Sequence[Row], ring: str) -> BareInput:
        """Return an input ring without DMA."""
        return BareInput(image, self._rows[ring])

    def output_ring(self, ring: str, image: Sequence[Row]) -> BareOutput:
        """Return an output ring without DMA."""
        return BareOutput(self._rows[ring], image)

    def run(self, kernel: Kernel, *arguments: Any) -> Work:
        """Run the build of `kernel` that has no counters."""
        key = (kernel, kernel.arrays_of(arguments))
        call = self._calls.get(key)
        if call is None:
            code = kernel.compiled(VDSP_O2, counted=False)
            rows = [arguments[each].array for each in kernel.array_positions]
            call = self._calls[key] = kernel.prepare(code, rows, code.new_totals())
        return call.run(arguments)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Charge nothing."""
        yield

    def next_frame(self) -> Generator[Any, Any, Frame | None]:
        """Copy the next picture into the camera's buffer."""
        frame = next(self._frames, None)
        if frame is None:
            return None
        for row, line in zip(self._camera, frame.left if self.name == "A" else frame.right, strict=True):
            row.octets[:] = line
        return Frame(frame.index, self._camera, self._size.width_px, self._size.height_px)
        yield

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


def run_bare(firmware: Firmware, frames: Sequence[StereoFrame]) -> None:
    """Run both main loops over `frames`, one core after the other."""
    for name, main in firmware.mains.items():
        task: Any = main(BareCore(name, firmware, frames))  # type: ignore[arg-type]
        value = None
        try:
            while True:
                value = task.send(value).value
        except StopIteration:
            pass
