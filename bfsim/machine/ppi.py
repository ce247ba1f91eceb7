"""PPI and camera: a picture arrives word by word, at the sensor's pace, in a frame buffer in memory."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.chip.spec import BoardSpec, SensorMode
from bfsim.clocks import PeriodicEdges
from bfsim.machine.bus import Bus, Pace, Walk
from bfsim.machine.memories import Memories, Row
from bfsim.machine.simulation import Simulation

WORD_BYTES = 4  # PPI_CONTROL with PACK_EN and DMA32


class Ppi:
    """One parallel peripheral interface with the camera on it."""

    def __init__(
        self,
        env: Simulation,
        board: BoardSpec,
        mode: SensorMode,
        bus: Bus,
        memories: Memories,
        *,
        master: int,
        outside: int,
    ) -> None:
        """`outside`: where in the arena a picture stands while it comes in."""
        self._env = env
        self._bus = bus
        self._memories = memories
        self._master = master
        self._outside = outside
        ppi_clk_ticks = board.clocks.tick_hz / mode.ppi_clk_hz
        self._word_ticks = ppi_clk_ticks * WORD_BYTES
        self._line_ticks: Fraction = ppi_clk_ticks * mode.line_clocks
        lines = PeriodicEdges(self._line_ticks)
        self.picture_ticks = lines.after(mode.height_px - 1) + PeriodicEdges(self._word_ticks).after(
            2 * mode.width_px // WORD_BYTES
        )
        """Ticks from the start of a picture to its last byte."""
        self.frame_ticks = lines.after(mode.frame_lines)
        """Ticks from one picture's first line to the next one's, vertical blanking included."""

    def receive(self, picture: NDArray[np.uint8], rows: Sequence[Row], start: int) -> simpy.Event:
        """Write `picture` (height, 2 · width) to `rows`; its first line begins at tick `start`. Return the event at its end."""
        words = picture.shape[1] // WORD_BYTES
        self._memories.bytes_from(self._outside, picture.nbytes)[:] = picture.reshape(-1)
        plan = self._bus.plan_receive(
            self._master,
            Walk(self._outside, words, WORD_BYTES, WORD_BYTES),
            Walk(rows[0].offset, words, WORD_BYTES, WORD_BYTES),
            words * len(rows),
            element_bytes=WORD_BYTES,
            pace=Pace(start, words, self._word_ticks, self._line_ticks),
        )
        return self._bus.when_done(self._bus.post(plan))
