"""PPI and camera: a picture arrives line by line, at the sensor's pace, in a frame buffer in memory."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.chip.spec import ChipSpec, SensorMode
from bfsim.clocks import Clocks, PeriodicEdges
from bfsim.machine.ebiu import BurstRate, Ebiu
from bfsim.machine.memories import Row
from bfsim.machine.simulation import Simulation


class Ppi:
    """One parallel peripheral interface with the camera on it."""

    def __init__(
        self, env: Simulation, name: str, chip: ChipSpec, clocks: Clocks, mode: SensorMode, ebiu: Ebiu
    ) -> None:
        self.name = name
        self._env = env
        self._rate = BurstRate(chip.ppi_word_sclk)
        self._ebiu = ebiu
        self._lines = PeriodicEdges.of(clocks, mode.ppi_clk_hz, every=mode.line_clocks)
        self.frame_ticks = self._lines.after(mode.frame_lines)
        """Ticks from one picture's first line to the next one's, vertical blanking included."""

    def receive(
        self, picture: NDArray[np.uint8], rows: Sequence[Row], start: int
    ) -> Generator[simpy.Event, Any, None]:
        """Write `picture` (height, 2 · width) to `rows`, line n at the end of its time; its first line begins at `start`."""
        env = self._env
        for number, row in enumerate(rows):
            yield env.timeout(start + self._lines.after(number + 1) - env.tick)
            row.array[:] = picture[number]
            if row.pages:
                self._ebiu.burst(self.name, env.tick, row, self._rate, write=True)
