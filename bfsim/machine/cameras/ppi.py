"""PPI and camera: a picture arrives in a frame buffer in memory, word by word, at the pace of the camera's own oscillator."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import ceil

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.chip.ppi_registers import check_ppi_clk
from bfsim.chip.sensor_spec import CameraSpec, SensorMode
from bfsim.chip.spec import BoardSpec
from bfsim.clocks import PeriodicEdges
from bfsim.errors import ConfigError, FirmwareError
from bfsim.kernel.types import u8
from bfsim.machine.buffers import FrameSize
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.transfer_plans import Pace, Transfer, Walk
from bfsim.machine.cameras.oscillator import Oscillator
from bfsim.machine.cameras.ppi_status import PpiStatus
from bfsim.machine.cameras.settling import CameraSettings, Settling
from bfsim.machine.cameras.skipping import SKIPS, skipped
from bfsim.machine.memories import Memories, Row
from bfsim.machine.timeline import Timeline
from bfsim.spans import SpanKind


class Ppi:
    """One parallel peripheral interface with its camera. `status` is the chip's PPI_STATUS."""

    def __init__(
        self,
        board: BoardSpec,
        size: FrameSize,
        camera: CameraSpec,
        bus: Bus,
        memories: Memories,
        *,
        number: int,
        outside: int,
        interrupt: Callable[[str], None],
    ) -> None:
        """`size` is that of the recorded pictures, `number` 0 or 1, and `outside` where in the arena two pictures are as they come in.

        It is two because the next picture may begin before the bus has taken the last words of the previous one. `interrupt` is
        called with PPI0_DMA at the end of each picture of PPI0, and then also with PPI0_ERROR if a bit of its status is set.
        """
        self._bus = bus
        self._memories = memories
        self._master = w.PPI0 + number
        self._clocks = board.clocks
        self._sensor = board.sensor
        self._recorded = size
        self._camera = camera
        self._name = f"PPI{number}"
        self._interrupt = interrupt
        self._outside = outside, outside + 2 * size.width_px * size.height_px
        # PPI_CONTROL with PACK_EN, and DMA32 if DMA has 32 bits
        self._word_bytes = board.chip.dma.word_bytes
        self._lines: dict[tuple[int, FrameSize], tuple[Row, ...]] = {}
        self._first_frame, self._origin_ticks = 0, 0
        self._send(size)
        # settings change only when firmware asks for it: a run begins with settled cameras
        self._settling = Settling(
            camera, CameraSettings(exposure_lines=0, gain=0, red_gain=0, blue_gain=0), camera.settling_frames
        )
        self._lost = 0
        self.through: simpy.Event | None = None
        """The event at which the latest picture is complete in its frame buffer."""
        self.transfer: Transfer | None = None
        """The transfer of that picture."""
        self._begin = 0

    def _send(self, size: FrameSize) -> None:
        """Program sensor and PPI for pictures of `size`."""
        self.size = size
        mode = self._sensor.mode(size.width_px, size.height_px)
        require_pace(mode, size, self._clocks.sclk_hz)
        self._oscillator = Oscillator(self._clocks, mode, self._camera)
        ppi_clk_ticks = countable(self._clocks.tick_hz / self._oscillator.ppi_clk_hz, mode.frame_clocks)
        self._word_ticks = ppi_clk_ticks * self._word_bytes
        self._line_ticks: Fraction = ppi_clk_ticks * mode.line_clocks
        lines = PeriodicEdges(self._line_ticks)
        self.picture_ticks = lines.after(mode.height_px - 1) + PeriodicEdges(ppi_clk_ticks).after(
            mode.active_clocks
        )
        """Ticks from the first byte of a picture to its last."""
        self.frame_ticks = lines.after(mode.frame_lines)
        """Ticks from one picture's first line to the next picture's, including vertical blanking."""
        self.status = PpiStatus(self._name, mode.height_px, mode.active_clocks)

    def start_of(self, frame: int) -> int:
        """Return the tick at which the free-running camera sends the first byte of its picture number `frame`."""
        return self._origin_ticks + self._oscillator.line_start(frame - self._first_frame, 0)

    def check_size(self, size: FrameSize) -> None:
        """Raise FirmwareError unless the recorded pictures can be sent in this size."""
        width_px, height_px = self._recorded.width_px, self._recorded.height_px
        sizes = [
            FrameSize(width_px // step, height_px // step) for step in SKIPS if width_px % (2 * step) == 0
        ]
        if size not in sizes:
            raise FirmwareError(f"pictures must be of {' or '.join(map(str, sizes))}, not of {size}")

    def change_size(self, size: FrameSize, frame: int) -> None:
        """Send pictures of `size` from number `frame` on, and settle. [assumed] That picture begins at its usual time."""
        if size == self.size:
            return
        start = self.start_of(frame)
        self._send(size)
        self._first_frame, self._origin_ticks = frame, start - self._oscillator.line_start(0, 0)
        self._settling.restart()

    def lines_in(self, rows: Sequence[Row]) -> Sequence[Row]:
        """Return the lines that a picture of the current size takes in the frame buffer `rows`."""
        if self.size == self._recorded:
            return rows
        key = (rows[0].offset, self.size)
        if key not in self._lines:  # the same rows every time: calls and copies with them are prepared once
            lines = self._memories.overlay(rows, u8, 2 * self.size.width_px)
            self._lines[key] = lines[: self.size.height_px]
        return self._lines[key]

    def _sent(self, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
        return self._settling.next_picture(skipped(picture, self._recorded.width_px // self.size.width_px))

    def change(self, settings: CameraSettings) -> None:
        """Give the camera new settings. The next pictures are off until these take effect."""
        self._settling.change(settings)

    def skip(self, picture: NDArray[np.uint8]) -> None:
        """Let a picture go by: the camera sends it and goes on settling, but nothing receives it."""
        self._sent(picture)

    def receive(self, picture: NDArray[np.uint8], rows: Sequence[Row], start: int) -> simpy.Event:
        """Write a recorded `picture` (height, 2 · width) to `rows` as the camera sends it from tick `start` on. Return the event at its end."""
        picture = self._sent(picture)
        words = picture.shape[1] // self._word_bytes
        self.status.frame_sync()
        self.status.lines(*picture.shape)
        outside, other = self._outside
        self._outside = other, outside
        self._memories.bytes_from(outside, picture.nbytes)[:] = picture.reshape(-1)
        plan = self._bus.planner.receive(
            self._master,
            Walk(outside, words, self._word_bytes, self._word_bytes),
            Walk(rows[0].offset, words, self._word_bytes, self._word_bytes),
            words * len(rows),
            element_bytes=self._word_bytes,
            pace=Pace(start, words, self._word_ticks, self._line_ticks),
            name=f"picture → {rows[0].buffer}",
        )
        self.transfer = self._bus.post(plan)
        self.through = self._bus.when_done(self.transfer)
        self._begin = start
        return self.through

    def end_picture(self) -> int:
        """Request the interrupts of a picture's end. Return how many of its words found the FIFO full; any of them sets OVR."""
        if timeline := self._bus.records.timeline:
            self._tell_lines(timeline)
        total = self._bus.lost_by(self._master)
        lost, self._lost = total - self._lost, total
        if lost:
            self.status.overrun(lost * self._word_bytes)
        self._interrupt(f"{self._name}_DMA")
        if self.status.causes:
            self._interrupt(f"{self._name}_ERROR")
        return lost

    def _tell_lines(self, timeline: Timeline) -> None:
        """Tell when the camera sent the lines of the picture that has just ended."""
        nbytes = 2 * self.size.width_px
        sent = PeriodicEdges(self._word_ticks).after(nbytes // self._word_bytes)
        lines = PeriodicEdges(self._line_ticks)
        for number in range(self.size.height_px):
            begin = self._begin + lines.after(number)
            timeline.span(
                SpanKind.LINE,
                self._name,
                f"line {number}",
                timeline.cclk(begin),
                timeline.cclk(begin + sent),
                nbytes,
            )


def countable(cycle_ticks: Fraction, cycles: int) -> Fraction:
    """Return the ticks of a cycle, in parts of a tick of which so many cycles have fewer than 2**62.

    The bus counts in 64 bits. What common clocks come to is that already; others are rounded by less than a part a cycle.
    """
    return cycle_ticks.limit_denominator(max(1, 2**62 // ceil(cycles * cycle_ticks)))


def require_pace(mode: SensorMode, size: FrameSize, sclk_hz: Fraction) -> None:
    """Raise ConfigError, with advice, if the camera sends pictures of `size` faster than a PPI can receive them."""
    try:
        check_ppi_clk(mode.ppi_clk_hz, sclk_hz)
    except ConfigError as error:
        raise ConfigError(
            f"pictures of {size} are too large for a camera that sends {float(mode.frame_hz):.3g} of them a second: {error}; "
            "`bfsim record import --resize` makes smaller ones"
        ) from None
