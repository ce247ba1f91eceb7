"""What is known about a sensor, and about the camera that it is in. See `spec`."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorMode:
    """One picture size of a sensor, in PPI_CLK cycles and in lines; two cycles carry one UYVY pixel.

    A line is `line_clocks` cycles, its pixels first and then its blanking (HREF, the line sync, rises
    with the first pixel). A frame is `frame_lines` lines: `lines_before` blank ones from the frame sync on,
    the picture, and the blank rest.
    """

    width_px: int
    height_px: int
    ppi_clk_hz: Fraction
    line_clocks: int
    frame_lines: int
    lines_before: int

    @property
    def active_clocks(self) -> int:
        """PPI_CLK cycles of a line that carry pixels."""
        return 2 * self.width_px

    @property
    def blank_lines(self) -> int:
        """Lines of a frame without a picture: the vertical blanking."""
        return self.frame_lines - self.height_px

    @property
    def frame_clocks(self) -> int:
        """PPI_CLK cycles of a frame."""
        return self.line_clocks * self.frame_lines

    @property
    def frame_hz(self) -> Fraction:
        """Frames per second."""
        return self.ppi_clk_hz / self.frame_clocks


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorSpec:
    """A camera with a UYVY output of two PPI_CLK cycles a pixel."""

    name: str
    modes: tuple[SensorMode, ...]

    def mode(self, width_px: int, height_px: int) -> SensorMode:
        """Return the mode of that size.

        A size that the sensor does not have is timed like its largest mode: the same blanking in proportion, and
        the same frame rate. That is an assumption for pictures of other cameras, not a property of the sensor.
        """
        for each in self.modes:
            if (each.width_px, each.height_px) == (width_px, height_px):
                return each
        full = max(self.modes, key=lambda each: each.width_px)
        line_clocks = -(-full.line_clocks * width_px // full.width_px)
        frame_lines = -(-full.frame_lines * height_px // full.height_px)
        return SensorMode(
            width_px=width_px,
            height_px=height_px,
            ppi_clk_hz=full.frame_hz * line_clocks * frame_lines,
            line_clocks=line_clocks,
            frame_lines=frame_lines,
            lines_before=full.lines_before * (frame_lines - height_px) // full.blank_lines,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraSpec:
    """What a camera has besides its sensor: its oscillator, and how it settles after new settings.

    The oscillator runs `offset_ppm` millionths fast (below 0: slow), and its first frame sync comes
    `phase_frames` (0 to 1) of a frame after the board's start. After a change of its settings, the next
    `settling_frames` pictures are off: for each frame still to go, they are `y_step_256ths` / 256 too bright, and
    their U and V differ by `u_step_levels` and `v_step_levels`.
    """

    name: str
    offset_ppm: Fraction
    phase_frames: Fraction
    settling_frames: int
    y_step_256ths: int
    u_step_levels: int
    v_step_levels: int
