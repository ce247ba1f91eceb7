"""PPI and camera: a picture arrives word by word, at the pace of the camera's own oscillator, in a frame buffer in memory."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.chip.ppi_registers import check_ppi_clk
from bfsim.chip.spec import BoardSpec, CameraSpec, SensorMode
from bfsim.clocks import PeriodicEdges
from bfsim.machine import bus_state as w
from bfsim.machine.bus import Bus, Pace, Walk
from bfsim.machine.memories import Memories, Row
from bfsim.machine.oscillator import Oscillator
from bfsim.machine.ppi_status import PpiStatus
from bfsim.machine.settling import CameraSettings, Settling


class Ppi:
    """One parallel peripheral interface with the camera on it. `status` is what the chip's PPI_STATUS shows."""

    def __init__(
        self,
        board: BoardSpec,
        mode: SensorMode,
        camera: CameraSpec,
        bus: Bus,
        memories: Memories,
        *,
        number: int,
        outside: int,
    ) -> None:
        """`number`: 0 or 1. `outside`: where in the arena two pictures stand while they come in.

        Two, since the next one may begin before the bus has taken the last words of the one before.
        """
        self._bus = bus
        self._memories = memories
        self._master = w.PPI0 + number
        self._outside = outside, outside + 2 * mode.width_px * mode.height_px
        self._word_bytes = (
            board.chip.dma.word_bytes
        )  # PPI_CONTROL with PACK_EN, and DMA32 where DMA has 32 bits
        self.oscillator = Oscillator(board.clocks, mode, camera)
        check_ppi_clk(mode.ppi_clk_hz, board.clocks.sclk_hz)
        ppi_clk_ticks = board.clocks.tick_hz / self.oscillator.ppi_clk_hz
        self._word_ticks = ppi_clk_ticks * self._word_bytes
        self._line_ticks: Fraction = ppi_clk_ticks * mode.line_clocks
        lines = PeriodicEdges(self._line_ticks)
        self.picture_ticks = lines.after(mode.height_px - 1) + PeriodicEdges(ppi_clk_ticks).after(
            mode.active_clocks
        )
        """Ticks from the first byte of a picture to its last one."""
        self.frame_ticks = lines.after(mode.frame_lines)
        """Ticks from one picture's first line to the next one's, vertical blanking included."""
        self.status = PpiStatus(f"PPI{number}", mode.height_px, mode.active_clocks)
        # a change of settings is what the firmware asks for; a run begins with settled cameras
        self._settling = Settling(
            camera, CameraSettings(exposure_lines=0, gain=0, red_gain=0, blue_gain=0), camera.settling_frames
        )
        self._lost = 0
        self.through: simpy.Event | None = None
        """The event at which the last picture that was begun is in its frame buffer."""

    def change(self, settings: CameraSettings) -> None:
        """Give the camera new settings: the next pictures are off until they have worked."""
        self._settling.change(settings)

    def skip(self, picture: NDArray[np.uint8]) -> None:
        """Let a picture go by: the camera sends it and goes on settling, but nobody takes it."""
        self._settling.next_picture(picture)

    def receive(self, picture: NDArray[np.uint8], rows: Sequence[Row], start: int) -> simpy.Event:
        """Write `picture` (height, 2 · width) to `rows`; its first line begins at tick `start`. Return the event at its end."""
        words = picture.shape[1] // self._word_bytes
        self.status.frame_sync()
        for line in picture:
            self.status.line(len(line))
        picture = self._settling.next_picture(picture)
        outside, other = self._outside
        self._outside = other, outside
        self._memories.bytes_from(outside, picture.nbytes)[:] = picture.reshape(-1)
        plan = self._bus.plan_receive(
            self._master,
            Walk(outside, words, self._word_bytes, self._word_bytes),
            Walk(rows[0].offset, words, self._word_bytes, self._word_bytes),
            words * len(rows),
            element_bytes=self._word_bytes,
            pace=Pace(start, words, self._word_ticks, self._line_ticks),
        )
        self.through = self._bus.when_done(self._bus.post(plan))
        return self.through

    def take_lost(self) -> int:
        """Return how many words found the FIFO full since the last time; any of them sets OVR."""
        total = self._bus.lost_by(self._master)
        lost, self._lost = total - self._lost, total
        if lost:
            self.status.overrun(lost * self._word_bytes)
        return lost
