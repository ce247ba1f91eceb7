"""Camera sensors of the time: line and frame timing of each picture size."""

from __future__ import annotations

from fractions import Fraction

from bfsim.chip.spec import SensorMode, SensorSpec

MHZ = 1_000_000

OV9650 = SensorSpec(
    name="OmniVision OV9650",  # [assumed] the thesis names the maker only
    modes=(
        # OV9650 implementation guide p.45: VGA YUV 30 fps, PCLK 24 MHz, 1600 PCLK a line, 500 lines
        SensorMode(
            width_px=640, height_px=480, ppi_clk_hz=Fraction(24 * MHZ), line_clocks=1600, frame_lines=500
        ),
        # the same guide: QVGA 60 fps, PCLK 12 MHz, 800 PCLK a line, 250 lines
        SensorMode(
            width_px=320, height_px=240, ppi_clk_hz=Fraction(12 * MHZ), line_clocks=800, frame_lines=250
        ),
        # [assumed] QQVGA halves QVGA's lines, clocks and PCLK: 120 fps
        SensorMode(
            width_px=160, height_px=120, ppi_clk_hz=Fraction(6 * MHZ), line_clocks=400, frame_lines=125
        ),
    ),
)
