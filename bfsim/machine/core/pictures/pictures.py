"""The pictures that a core takes, one after the other, and what it reports about each at its end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bfsim.chip.spec import ChipSpec
from bfsim.errors import FirmwareError, printable, shown
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.machine.calls.call_cache import CallCache
from bfsim.machine.cameras.capture import Capture
from bfsim.machine.core.buffers.layouts import Layouts
from bfsim.machine.core.pictures.frames import FinishedFrame, Frame
from bfsim.machine.core.pictures.places import Columns, Pixels, place_of
from bfsim.machine.core.pictures.readout import Readout
from bfsim.machine.core.pictures.views import seen_by
from bfsim.machine.core.progress.progress import Progress
from bfsim.machine.core.tasks.tasks import Tasks
from bfsim.machine.core.waits import Wait
from bfsim.machine.memories import Row
from bfsim.seen import Seen
from bfsim.trace import REST, StallReason

CAMERAS = "cameras"
"""The cameras as an owner of cycles."""


class Pictures:
    """The pictures of one core's camera. `finished` holds completed frames until the board takes them."""

    def __init__(
        self, chip: ChipSpec, progress: Progress, tasks: Tasks, calls: CallCache, capture: Capture, access_trace: AccessTrace,
        layouts: Layouts, on_finished: Callable[[], None], view: Callable[[Readout], Seen | None] | None,
    ) -> None:  # fmt: skip
        """`on_finished` is called at a frame's end. `view` reads out what was seen, if anyone wants to know."""
        self.finished: list[FinishedFrame] = []
        self._chip = chip
        self._progress = progress
        self._clock = progress.clock
        self._tasks = tasks
        self._calls = calls
        self._capture = capture
        self._access_trace = access_trace
        self._layouts = layouts
        self._on_finished = on_finished
        self._view = view
        self._frame: Frame | None = None
        self._full_at_cclk = 0
        self._results: dict[str, int] = {}
        self._remarks: list[str] = []

    @property
    def is_over(self) -> bool:
        """Whether the firmware was told that the recording is over."""
        return self._tasks.is_over

    def next_frame(self) -> Wait:
        """Finish the current frame and wait for the next picture. Return None when the recording is over."""
        if self._calls.stage != REST:
            raise FirmwareError(f"next_frame must be called outside of stages, not in {self._calls.stage!r}")
        if self.is_over:
            raise FirmwareError("next_frame must not be called again after None, for the recording is over")
        self._tasks.check_claimed()
        yield from self._progress.sync()
        self.at()
        self.close()
        claim = self._capture.claim(self._layouts.core)
        pair = yield from self._progress.blocked(claim, "the next picture", None)
        self._clock.wake(None, CAMERAS, ended_by=pair.last if pair else None)
        if pair is None:
            self._tasks.is_over = True
            return None
        events = self._chip.events  # the interrupt of the PPI's DMA ends the wait
        self._clock.stall(
            StallReason.INTERRUPT, events.interrupt_entry_cclk + events.interrupt_exit_cclk, CAMERAS
        )
        self._full_at_cclk = -(-pair.full_at_ticks // self._clock.cclk_ticks)
        rows = pair.picture[self._layouts.core]
        self._invalidate(rows)
        if lost := pair.lost.get(self._layouts.core, 0):
            self.publish(ppi_words_lost=lost)
        self._frame = Frame(pair.index, rows, rows[0].nbytes // 2, len(rows))
        self._tasks.frame_index = pair.index
        return self._frame

    def _invalidate(self, rows: tuple[Row, ...]) -> None:
        """Invalidate the data cache's lines of a picture that DMA has overwritten."""
        lines = self._access_trace.forget(rows[0].offset, rows[0].nbytes * len(rows))
        self._clock.issue(lines * self._chip.cache.invalidate_cclk, CAMERAS)

    def publish(self, **results: int) -> None:
        """Add numbers to the record of the current frame."""
        self._results.update({f"{name}_{self._layouts.core}": each for name, each in results.items()})

    @property
    def has_lost_words(self) -> bool:
        """Whether the DMA of the camera has lost words of the current picture."""
        return any(name.startswith("ppi_words_lost_") for name in self._results)

    def remark(self, text: str) -> None:
        """Add a sentence about the current frame to the report, as one line. Raises FirmwareError if it is not text."""
        if not isinstance(text, str):
            raise FirmwareError(f"a remark must be text, not {shown(text)}")
        self._remarks.append(f"core {self._layouts.core} {printable(text)}")

    def at(
        self, rows: int | range | Pixels | None = None, columns: Columns | None = None, *taken: Any
    ) -> None:
        """Say which place of the picture the following work is about."""
        if self._clock.timeline:
            self._clock.timeline.say(None if rows is None else place_of(rows, columns, *taken))

    def take_line(self, number: int, lines: int) -> None:
        """Note that the core took a line of a picture of so many `lines`: it works there unless it has said more exactly where."""
        timeline = self._clock.timeline
        if (
            timeline
            and self._frame
            and lines == self._frame.height
            and (timeline.said is None or timeline.said.columns is None)
        ):
            self.at(number)

    def close(self) -> None:
        """Turn the cycles since the last frame's end into a record, if there was a frame."""
        if self._frame is None:
            return
        cclk = self._clock.cclk
        if self._clock.timeline:
            self._clock.timeline.end_frame(self._frame.index, cclk)
        kernels, costs, counts = self._calls.close()
        self.finished.append(
            FinishedFrame(
                index=self._frame.index,
                full_at_cclk=self._full_at_cclk,
                cycles=self._clock.accounts.close(cclk, kernels, costs),
                counts=counts,
                results=self._results,
                remarks=tuple(self._remarks),
                seen=self._seen(self._frame),
            )
        )
        self._frame = self._tasks.frame_index = None
        self._results, self._remarks = {}, []
        self._on_finished()

    def _seen(self, frame: Frame) -> Seen | None:
        return seen_by(self._view, Readout(self._layouts, frame, self._results)) if self._view else None
