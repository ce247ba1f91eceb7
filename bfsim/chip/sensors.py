"""Camera sensors of the time: line and frame timing of each picture size; and the robot's two cameras.

Sensors that skip lines send every second or fourth one of a full frame; where that leaves half a line, the frame is
rounded up to whole ones. [assumed] two thirds of the blank lines come before the picture, where nothing is said.
"""

from __future__ import annotations

from fractions import Fraction

from bfsim.chip.sensor_spec import CameraSpec, SensorMode, SensorSpec

MHZ = 1_000_000

_OV965X_MODES = (
    # OV9650 implementation guide 1.1: VGA YUV 30 fps with PCLK 24 MHz (Table 3-1); a line is 1600 PCLK, a frame
    # 500 lines (the dummy pixels and lines of Table 6-4).
    SensorMode(
        width_px=640,
        height_px=480,
        ppi_clk_hz=Fraction(24 * MHZ),
        line_clocks=1600,
        frame_lines=500,
        lines_before=13,
    ),
    # the same tables: QVGA 60 fps, PCLK 12 MHz, 250 lines, so 800 PCLK each
    SensorMode(
        width_px=320,
        height_px=240,
        ppi_clk_hz=Fraction(12 * MHZ),
        line_clocks=800,
        frame_lines=250,
        lines_before=6,
    ),
    # the same tables: QQVGA 60 fps, PCLK 6 MHz, 250 lines. [assumed] every second of them is sent
    SensorMode(
        width_px=160,
        height_px=120,
        ppi_clk_hz=Fraction(6 * MHZ),
        line_clocks=800,
        frame_lines=125,
        lines_before=3,
    ),
)

OV9650 = SensorSpec(
    name="OmniVision OV9650",  # [assumed] the thesis names the maker only
    modes=_OV965X_MODES,
)

OV9655 = SensorSpec(
    name="OmniVision OV9655",
    modes=_OV965X_MODES,  # VGA and QVGA at the OV9650's rates. [assumed] its lines too
)

_OV767X_MODES = (
    # a pixel is 2 PCLK, a line 784 pixels, a frame 510 lines: 3 of VSYNC, 17 before, 480, 10 after (data sheet of
    # the OV7670 by way of the Arduino forum; window registers of Linux ov7670.c)
    SensorMode(
        width_px=640,
        height_px=480,
        ppi_clk_hz=Fraction(24 * MHZ),
        line_clocks=1568,
        frame_lines=510,
        lines_before=20,
    ),
    # scaled down with PCLK divided by 2 and by 4 (registers COM14 and SCALING_PCLK_DIV), at the same frame rate.
    # [assumed] one line in two and in four is sent
    SensorMode(
        width_px=320,
        height_px=240,
        ppi_clk_hz=Fraction(12 * MHZ),
        line_clocks=1568,
        frame_lines=255,
        lines_before=10,
    ),
    SensorMode(
        width_px=160,
        height_px=120,
        ppi_clk_hz=Fraction(6 * MHZ),
        line_clocks=1568,
        frame_lines=128,
        lines_before=5,
    ),
)

OV7660 = SensorSpec(name="OmniVision OV7660", modes=_OV767X_MODES)
OV7670 = SensorSpec(name="OmniVision OV7670", modes=_OV767X_MODES)

OV7648 = SensorSpec(
    name="OmniVision OV7648",
    modes=(
        # data sheet: VGA at up to 30 fps. [assumed] lines as the OV7620 before it: 525 of 858 pixels at 13.5 MHz,
        # the raster of ITU-R BT.601
        SensorMode(
            width_px=640,
            height_px=480,
            ppi_clk_hz=Fraction(27 * MHZ),
            line_clocks=1716,
            frame_lines=525,
            lines_before=30,
        ),
        # [assumed] as the OV7620's data sheet has it: half the pixel rate, and one line in two is sent
        SensorMode(
            width_px=320,
            height_px=240,
            ppi_clk_hz=Fraction(27 * MHZ, 2),
            line_clocks=1716,
            frame_lines=263,
            lines_before=15,
        ),
    ),
)

OV7725 = SensorSpec(
    name="OmniVision OV7725",
    modes=(
        # 60 fps (SRV-1 ov7725.h, CLKRC 0); 510 lines (Linux ov772x.c). [assumed] PCLK 48 MHz, and 784 pixels a line and
        # the blank lines of the OV7670: that gives the 60 fps, and the 748 pixels of ov772x.c, likely its digits
        # swapped, do not
        SensorMode(
            width_px=640,
            height_px=480,
            ppi_clk_hz=Fraction(48 * MHZ),
            line_clocks=1568,
            frame_lines=510,
            lines_before=20,
        ),
        # 278 lines of 576 pixels (Linux ov772x.c). [assumed] 60 fps here too: PCLK 24 MHz x 4 / 5
        SensorMode(
            width_px=320,
            height_px=240,
            ppi_clk_hz=Fraction(96 * MHZ, 5),
            line_clocks=1152,
            frame_lines=278,
            lines_before=25,
        ),
    ),
)

SENSORS = (OV7648, OV7660, OV7670, OV7725, OV9650, OV9655)

# Oscillators: makers of quartz grade it as +-10, 20, 30 and 50 ppm. [assumed] one camera at each limit of +-30, and a third
# of a frame between their syncs: two cameras with nothing in common but the power switch.
# Settling: T Figure 6.8 and its text: five to ten pictures until the settings work, and a drift towards yellow (low U,
# somewhat high V). The brightness goes by 1/16 a frame: step of the exposure loop, OV9650 implementation guide p.16.
# [assumed] too bright rather than too dark (T §5.1.2: the automatic exposure overexposes), the frames of each camera
# within the thesis's range, and its steps of colour.
LEFT_CAMERA = CameraSpec(
    name="left",
    offset_ppm=Fraction(30),
    phase_frames=Fraction(0),
    settling_frames=6,
    y_step_256ths=16,
    u_step_levels=-6,
    v_step_levels=1,
)
RIGHT_CAMERA = CameraSpec(
    name="right",
    offset_ppm=Fraction(-30),
    phase_frames=Fraction(1, 3),
    settling_frames=9,
    y_step_256ths=16,
    u_step_levels=-5,
    v_step_levels=2,
)
