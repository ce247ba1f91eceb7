"""PPI and camera: a picture arrives line by line, at the sensor's pace, in a frame buffer in memory."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.chip.spec import BoardSpec, SensorMode
from bfsim.clocks import PeriodicEdges
from bfsim.machine.ebiu import BurstRate, Ebiu
from bfsim.machine.memories import Row
from bfsim.machine.simulation import Simulation
from bfsim.machine.traffic import Account


class Ppi:
    """One parallel peripheral interface with the camera on it."""

    def __init__(
        self, env: Simulation, board: BoardSpec, mode: SensorMode, ebiu: Ebiu, account: Account
    ) -> None:
        """`account`: what it writes to SDRAM."""
        self._account = account
        self._env = env
        self._rate = BurstRate(board.chip.ppi_word_sclk)
        self._ebiu = ebiu
        lines = PeriodicEdges.of(board.clocks, mode.ppi_clk_hz, every=mode.line_clocks)
        self._line_ends = [lines.after(number + 1) for number in range(mode.height_px)]
        self.picture_ticks = self._line_ends[-1]
        """Ticks from the start of a picture to the end of its last line."""
        self.frame_ticks = lines.after(mode.frame_lines)
        """Ticks from one picture's first line to the next one's, vertical blanking included."""

    def receive(self, picture: NDArray[np.uint8], rows: Sequence[Row], start: int) -> simpy.Event:
        """Write `picture` (height, 2 · width) to `rows`, line n at the end of its time; its first line begins at `start`.

        Return the event at the end of the last line.
        """

        def line(number: int, now: int) -> None:
            row = rows[number]
            row.octets[:] = picture[number]
            if row.pages:
                self._ebiu.burst(self._account, now, row, self._rate, write=True)
            if number + 1 < len(rows):
                self._env.note(start + self._line_ends[number + 1], partial(line, number + 1))

        self._env.note(start + self._line_ends[0], partial(line, 0))
        return self._env.after(start + self.picture_ticks - self._env.tick)
