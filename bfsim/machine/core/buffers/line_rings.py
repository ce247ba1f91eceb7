"""The line rings that a core makes for its firmware: with DMA, or without if the picture lies in cached memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from bfsim.errors import FirmwareError, shown
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.machine.calls.cached_lines import CachedInput, CachedOutput
from bfsim.machine.core.buffers.layouts import Layouts
from bfsim.machine.core.progress.progress import Progress
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.dma.ring import InputRing, OutputRing
from bfsim.machine.memories import Row

Ring = TypeVar("Ring", InputRing, CachedInput, OutputRing, CachedOutput)


TAKES = {"input_ring": "(rows, ring)", "window_ring": "(rows, ring)", "output_ring": "(ring, rows)"}
"""The methods that make rings, with their arguments: a message shows their order."""


def _check_rows(method: str, image: Sequence[Row]) -> None:
    """Raise FirmwareError unless `image` is the rows of a picture."""
    if (
        isinstance(image, str)
        or not isinstance(image, Sequence)
        or not all(isinstance(each, Row) for each in image[:1])
    ):
        raise FirmwareError(
            f"core.{method}{TAKES[method]} must get the rows of a picture, such as frame.rows or core.rows('image'), not {shown(image)}"
        )


class LineRings:
    """The rings of one core, on its two `streams`: one for input and one for output."""

    def __init__(
        self, progress: Progress, streams: tuple[MdmaStream, MdmaStream], layouts: Layouts, access_trace: AccessTrace,
        on_line: Callable[[int, int], None],
    ) -> None:  # fmt: skip
        """`on_line` is called with the number of each line that is taken, and with the number of lines."""
        self.streams = streams
        self._progress = progress
        self._layouts = layouts
        self._access_trace = access_trace
        self._on_line = on_line

    def input(self, image: Sequence[Row], ring: str | Sequence[Row]) -> InputRing | CachedInput:
        """Return a ring that fetches the lines of `image`, or the image's own lines if it is cached."""
        _check_rows("input_ring", image)
        if self._is_cached(image):
            return self._noted(CachedInput(image, self._on_line), "line")
        return self.window(image, self._layouts.rows(ring) if isinstance(ring, str) else ring)

    def window(self, image: Sequence[Row], rows: Sequence[Row]) -> InputRing:
        """Return a ring that fetches the lines of `image` even if it is cached."""
        _check_rows("window_ring", image)
        ring = InputRing(self._progress, self.streams[0], image, rows, self._on_line)
        return self._noted(ring, "line")

    def output(self, ring: str, image: Sequence[Row]) -> OutputRing | CachedOutput:
        """Return a ring that sends lines to `image`, or the image's own lines if it is cached."""
        _check_rows("output_ring", image)
        if self._is_cached(image):
            return self._noted(CachedOutput(image), "row")
        return self._noted(
            OutputRing(self._progress, self.streams[1], self._layouts.rows(ring), image), "row"
        )

    def _noted(self, ring: Ring, method: str) -> Ring:
        """Note each wait that a ring's `method` makes, as long as all waits are noted. After that, rings may hurry."""
        waits = self._progress.waits
        if waits.are_all_noted:
            setattr(ring, method, waits.noting(getattr(ring, method)))
        elif isinstance(ring, InputRing | OutputRing):
            ring.hurry()
        return ring

    def _is_cached(self, image: Sequence[Row]) -> bool:
        return bool(image) and self._access_trace.caches(image[0].offset)
