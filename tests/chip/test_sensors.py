"""Sensors: numbers that fit each other, the rates that their documents state, and two cameras that are not alike."""

from __future__ import annotations

from fractions import Fraction

import pytest

from bfsim.chip.boards import BOARDS
from bfsim.chip.ppi_registers import check_ppi_clk
from bfsim.chip.sensor_spec import CameraSpec, SensorMode, SensorSpec
from bfsim.chip.sensors import (
    LEFT_CAMERA,
    OV7648,
    OV7660,
    OV7670,
    OV7725,
    OV9650,
    OV9655,
    RIGHT_CAMERA,
    SENSORS,
)

EVERY_MODE = [
    pytest.param(mode, id=f"{sensor.name.split()[-1]}-{mode.width_px}")
    for sensor in SENSORS
    for mode in sensor.modes
]
each_camera = pytest.mark.parametrize("camera", [LEFT_CAMERA, RIGHT_CAMERA], ids=lambda each: each.name)


@pytest.mark.parametrize("mode", EVERY_MODE)
def test_lines_and_frames_add_up(mode: SensorMode) -> None:
    """Pixels and blanking fill a line, picture and blanking fill a frame, and there is some of each."""
    assert mode.active_clocks == 2 * mode.width_px
    assert mode.active_clocks < mode.line_clocks
    assert 0 < mode.lines_before < mode.blank_lines == mode.frame_lines - mode.height_px
    assert mode.frame_clocks * mode.frame_hz == mode.ppi_clk_hz


@pytest.mark.parametrize(
    ("sensor", "width", "frames_hz"),
    [
        (OV7648, 640, 30),
        (OV7648, 320, 30),
        (OV7660, 640, 30),
        (OV7670, 640, 30),
        (OV7670, 320, 30),
        (OV7670, 160, 30),
        (OV7725, 640, 60),
        (OV7725, 320, 60),
        (OV9650, 640, 30),
        (OV9650, 320, 60),
        (OV9650, 160, 60),
        (OV9655, 640, 30),
    ],
)
def test_frame_rates_of_the_documents(sensor: SensorSpec, width: int, frames_hz: int) -> None:
    """The documents round their rates; a wrong number of lines or clocks is off by more than half a percent."""
    assert float(sensor.mode(width, width * 3 // 4).frame_hz) == pytest.approx(frames_hz, rel=5e-3)


@pytest.mark.parametrize("mode", EVERY_MODE)
@pytest.mark.parametrize("board", BOARDS)
def test_ppi_keeps_up_with_every_mode(board: str, mode: SensorMode) -> None:
    """Even 48 MHz is below half of every board's SCLK."""
    check_ppi_clk(mode.ppi_clk_hz, BOARDS[board].clocks.sclk_hz)


@pytest.mark.parametrize(("width", "height"), [(2, 1), (16, 8), (64, 48), (160, 120), (1280, 1024)])
def test_foreign_sizes_share_their_blank_lines_likewise(width: int, height: int) -> None:
    """As many blank lines in proportion before the picture as in the largest mode, and never more than there are."""
    mode = OV7725.mode(width, height)
    assert 0 <= mode.lines_before <= mode.blank_lines
    assert mode.lines_before == pytest.approx(Fraction(20, 30) * mode.blank_lines, abs=1)


@each_camera
def test_cameras_are_within_what_is_known_of_them(camera: CameraSpec) -> None:
    """Quartz of up to 50 ppm, and five to ten pictures to settle (T Figure 6.8)."""
    assert abs(camera.offset_ppm) <= 50
    assert 0 <= camera.phase_frames < 1
    assert 5 <= camera.settling_frames <= 10


def test_cameras_differ_in_everything() -> None:
    """Nothing locks them to each other, and they do not settle together."""
    assert LEFT_CAMERA.offset_ppm != RIGHT_CAMERA.offset_ppm
    assert LEFT_CAMERA.phase_frames != RIGHT_CAMERA.phase_frames
    assert LEFT_CAMERA.settling_frames != RIGHT_CAMERA.settling_frames
