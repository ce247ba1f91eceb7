"""A camera's own oscillator: the times of its frames and lines, in ticks of the board. Nothing synchronises two cameras."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from bfsim.chip.sensor_spec import CameraSpec, SensorMode
from bfsim.clocks import Clocks, PeriodicEdges


@dataclass(frozen=True, slots=True)
class Oscillator:
    """The free-running time of one camera in one mode. Frames, and lines of a picture, are counted from 0.

    Every time is a tick, rounded up separately from an exact fraction, so nothing drifts.
    """

    clocks: Clocks
    mode: SensorMode
    camera: CameraSpec
    ppi_clk_hz: Fraction = field(init=False)
    """The actual rate of PPI_CLK."""
    _cycles: PeriodicEdges = field(init=False)

    def __post_init__(self) -> None:
        hz = self.mode.ppi_clk_hz * (1 + self.camera.offset_ppm / 1_000_000)
        phase_cycles = self.camera.phase_frames * self.mode.frame_clocks
        object.__setattr__(self, "ppi_clk_hz", hz)
        object.__setattr__(self, "_cycles", PeriodicEdges.of(self.clocks, hz, offset_cycles=phase_cycles))

    @property
    def frames(self) -> PeriodicEdges:
        """The frame syncs."""
        period_ticks = self.mode.frame_clocks * self._cycles.period_ticks
        return PeriodicEdges(period_ticks, self._cycles.offset_ticks)

    def line_start(self, frame: int, line: int) -> int:
        """Return the tick of the first byte of a line of the picture."""
        return self._cycles.after(self._cycles_before(frame, line))

    def line_end(self, frame: int, line: int) -> int:
        """Return the tick at which the last byte of a line of the picture has been sent, before its blanking."""
        return self._cycles.after(self._cycles_before(frame, line) + self.mode.active_clocks)

    def _cycles_before(self, frame: int, line: int) -> int:
        lines = frame * self.mode.frame_lines + self.mode.lines_before + line
        return lines * self.mode.line_clocks
