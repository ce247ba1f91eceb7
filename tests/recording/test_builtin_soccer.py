"""The built-in recording shows what its ground truth says, judged from the pixels, without the renderer."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bfsim.errors import RecordingError
from bfsim.recording import StereoFrame, StereoGeometry
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.reader import RecordingReader
from bfsim.recording.scenes.drive import Drive
from bfsim.recording.scenes.renderer import Renderer
from bfsim.recording.scenes.sensor import FULL_WELL_ELECTRONS, READ_NOISE_ELECTRONS, expose

GEOMETRY = StereoGeometry(focal_px=386.0, baseline_mm=30.47, height_mm=120.0, tilt_deg=10.0)
SIDES = ("left", "right")
ROWS, COLUMNS = np.mgrid[:240, :320].astype(float)

# Directions of (U - 128, V - 128) of the paints of the scene.
YELLOW_DEG, BLUE_DEG, RED_DEG = 158.0, -46.0, 115.0


@dataclass(frozen=True)
class Picture:
    """One picture (240, 320): what is in it, and each pixel's brightness, hue and strength of colour."""

    truth: dict[str, Any]
    luma: NDArray[np.float64]
    hue_deg: NDArray[np.float64]
    chroma: NDArray[np.float64]

    def has_hue(self, hue_deg: float) -> NDArray[np.bool_]:
        """Pixels with a clear colour within 12 degrees of a hue."""
        off_deg = (self.hue_deg - hue_deg + 180) % 360 - 180
        return (np.abs(off_deg) < 12) & (self.chroma > 14)

    def around(self, x: float, y: float, reach: int = 1) -> NDArray[np.float64]:
        """Brightness of the pixels up to `reach` from (x, y)."""
        column, row = round(x), round(y)
        return self.luma[max(0, row - reach) : row + reach + 1, max(0, column - reach) : column + reach + 1]

    def ball_distance(self) -> NDArray[np.float64]:
        """Distance of each pixel from the middle of the ball's outline, in its mean radii."""
        x, y = self.truth["ball"]["outline_centre_px"]
        radius_px: float = sum(self.truth["ball"]["outline_half_axes_px"]) / 2
        distance: NDArray[np.float64] = np.hypot(COLUMNS - x, ROWS - y) / radius_px
        return distance


def picture(frame: StereoFrame, side: str) -> Picture:
    """The picture of one side, with the ground truth of that side."""
    assert frame.truth is not None
    planes = YuvPlanes.from_uyvy(frame.left if side == "left" else frame.right)
    u, v = (np.repeat(plane, 2, axis=1).astype(float) - 128 for plane in (planes.u, planes.v))
    truth = {name: frame.truth[name][side] for name in ("ball", "goal", "robot")}
    truth["lines"] = [line[side] for line in frame.truth["lines"] if line[side] is not None]
    return Picture(truth, planes.y.astype(float), np.degrees(np.arctan2(v, u)), np.hypot(u, v))


@pytest.fixture(scope="module")
def recording() -> Iterator[RecordingReader]:
    """The recording as the package ships it."""
    shipped = resources.files("bfsim.recording") / "builtin" / "soccer.mcap"
    with resources.as_file(shipped) as path, RecordingReader(path) as opened:
        yield opened


@pytest.fixture(scope="module")
def frames(recording: RecordingReader) -> list[StereoFrame]:
    """All its frames."""
    return list(recording.frames())


@pytest.fixture(scope="module")
def pictures(frames: list[StereoFrame]) -> list[Picture]:
    """All its pictures, left and right in turn."""
    return [picture(frame, side) for frame in frames for side in SIDES]


def test_it_is_what_the_robot_records(recording: RecordingReader, frames: list[StereoFrame]) -> None:
    """Eight stereo frames in the robot's geometry; the description says how they were made."""
    assert (recording.width, recording.height, len(frames)) == (320, 240, 8)
    assert recording.geometry == GEOMETRY
    assert recording.rectification is None
    assert "mitsuba 3" in recording.description
    assert "192 samples a pixel, seed 561" in recording.description


def test_cameras_run_at_30_frames_a_second_out_of_phase(frames: list[StereoFrame]) -> None:
    """Left stamps are 1/30 s apart and the right camera lags by the same few milliseconds every time."""
    left_ns = np.array([frame.left_ns for frame in frames])
    lag_ns = np.array([frame.right_ns for frame in frames]) - left_ns
    assert np.all(np.diff(left_ns) == 33_333_333)
    assert np.all(lag_ns == lag_ns[0])
    assert 0 < lag_ns[0] < 10_000_000


def test_ball_is_yellow_inside_its_outline_only(pictures: list[Picture]) -> None:
    """Nearly all pixels within the outline have the ball's hue, and nearly none in the ring round it.

    The lower half is left out: there the ball is in its own shade and the floor mirrors it.
    """
    for seen in pictures:
        upper = seen.truth["ball"]["outline_centre_px"][1] > ROWS
        yellow, distance = seen.has_hue(YELLOW_DEG), seen.ball_distance()
        assert yellow[upper & (distance < 0.9)].mean() > 0.99
        assert yellow[upper & (distance > 1.1) & (distance < 1.5)].mean() < 0.02


def test_outline_of_the_ball_is_where_its_colour_ends(pictures: list[Picture]) -> None:
    """Left, right and top end of the yellow are those of the ellipse, to two pixels (one colour sample)."""
    for seen in pictures:
        (x, y), (long_px, short_px) = (
            seen.truth["ball"][key] for key in ("outline_centre_px", "outline_half_axes_px")
        )
        ball = seen.has_hue(YELLOW_DEG) & (seen.ball_distance() < 1.2) & (y + short_px / 2 > ROWS)
        rows, columns = np.nonzero(ball)
        found = [columns.min(), columns.max(), rows.min()]
        assert found == pytest.approx([x - long_px, x + long_px, y - short_px], abs=2.0)


def test_disparity_of_the_ball_is_focal_length_times_baseline_over_depth(frames: list[StereoFrame]) -> None:
    """Disparity, depth and camera poses of the truth agree, and so do the yellow areas of the pictures."""
    for frame in frames:
        assert frame.truth is not None
        ball, cameras = frame.truth["ball"], frame.truth["cameras"]
        off_mm = np.subtract(ball["centre_mm"], cameras["left"]["position_mm"])
        depth_mm = np.array(cameras["left"]["rotation"])[2] @ off_mm
        assert ball["left"]["camera_mm"][2] == pytest.approx(depth_mm)
        assert ball["disparity_px"] == pytest.approx(GEOMETRY.focal_px * GEOMETRY.baseline_mm / depth_mm)
        left_px, right_px = (_middle_of_yellow(picture(frame, side)) for side in SIDES)
        assert left_px - right_px == pytest.approx(ball["disparity_px"], abs=0.5)


def _middle_of_yellow(seen: Picture) -> float:
    """Column of the centre of mass of the ball's upper half."""
    upper = seen.truth["ball"]["outline_centre_px"][1] > ROWS
    return float(COLUMNS[seen.has_hue(YELLOW_DEG) & upper & (seen.ball_distance() < 1.2)].mean())


def test_visible_line_ends_are_bright_and_hidden_ones_are_not(pictures: list[Picture]) -> None:
    """A field line's end lies on white paint unless the truth says that something stands before it."""
    ends = [
        (seen.around(*end_px).max(), visible)
        for seen in pictures
        for line in seen.truth["lines"]
        for end_px, visible in zip(line["ends_px"], line["visible"], strict=True)
    ]
    assert min(luma for luma, visible in ends if visible) > 80
    assert max(luma for luma, visible in ends if not visible) < 60


def test_floor_beside_the_lines_is_dark(pictures: list[Picture]) -> None:
    """The field is black, as in the thesis: most of it is darker than a fifth of full scale."""
    for seen in pictures:
        assert np.median(seen.luma[120:]) < 51


def test_goal_is_blue_up_to_its_corners(pictures: list[Picture]) -> None:
    """Just inside the upper corners of the mouth is the goal's colour, and just above them the dark room."""
    for seen in pictures:
        _, _, (right_x, right_y), (left_x, left_y) = seen.truth["goal"]["mouth_px"]
        blue = seen.has_hue(BLUE_DEG)
        for x, y in ((left_x, left_y), (right_x, right_y)):
            assert blue[round(y) + 3, round(x)]
            assert seen.around(x, y - 4).max() < 40


def test_other_robot_wears_a_red_mark(pictures: list[Picture]) -> None:
    """The box round the mark's corners is full of red, and nothing outside it is."""
    for seen in pictures:
        corners_px = np.array(seen.truth["robot"]["mark_corners_px"])
        (left, top), (right, bottom) = corners_px.min(axis=0), corners_px.max(axis=0)
        red = seen.has_hue(RED_DEG)
        assert red[round(top) + 3 : round(bottom) - 4, round(left) + 4 : round(right) - 4].mean() > 0.97
        outside = (left - 3 > COLUMNS) | (right + 3 < COLUMNS) | (top - 3 > ROWS)
        assert red[outside].mean() < 0.001


def test_pictures_are_noisy_and_no_two_alike(pictures: list[Picture]) -> None:
    """The empty room above the scene is uniform but for noise, which is drawn anew for every picture."""
    room = np.array([seen.luma[:40] for seen in pictures])
    assert np.all((room.std(axis=(1, 2)) > 0.5) & (room.std(axis=(1, 2)) < 5))
    correlation = np.corrcoef(room.reshape(len(pictures), -1))
    assert np.abs(correlation - np.eye(len(pictures))).max() < 0.05


def test_sensor_has_shot_noise_and_read_noise() -> None:
    """The noise of a half-full pixel is that of its electrons and its reading, and a full pixel saturates."""
    half = np.full((200, 200, 3), 0.5, np.float32)
    levels = expose(half, np.random.default_rng(1))
    slope = 255 * 1.099 * 0.45 * 0.5**-0.55 / FULL_WELL_ELECTRONS
    expected = slope * np.hypot(np.sqrt(FULL_WELL_ELECTRONS / 2), READ_NOISE_ELECTRONS)
    assert np.hypot(expected, 12**-0.5) == pytest.approx(levels.std(), rel=0.03)  # 8-bit steps add 1/12
    assert np.array_equal(levels, expose(half, np.random.default_rng(1)))
    assert np.all(expose(half * 3, np.random.default_rng(1)) == 255)


def test_drive_turns_on_a_circle() -> None:
    """After a quarter turn the robot is one radius ahead and one to the left, looking left and down."""
    drive = Drive(x_mm=0, y_mm=0, heading_deg=0, speed_mm_per_s=50 * np.pi, turn_deg_per_s=90)
    cameras = drive.pose(1.0).cameras(GEOMETRY)
    left_mm, right_mm = (cameras[side].position_mm for side in SIDES)
    assert (left_mm + right_mm) / 2 == pytest.approx([100, 100, 120])
    assert right_mm - left_mm == pytest.approx([30.47, 0, 0], abs=1e-9)
    assert cameras["left"].rotation[2] == pytest.approx(
        [0, np.cos(np.radians(10)), -np.sin(np.radians(10))], abs=1e-9
    )


def test_pinhole_projects_and_clips() -> None:
    """The axis meets the middle of the picture; a segment is cut at the border; one out of view is None."""
    camera = (
        Drive(x_mm=0, y_mm=0, heading_deg=0, speed_mm_per_s=0, turn_deg_per_s=0)
        .pose(0)
        .cameras(GEOMETRY)["left"]
    )
    ahead_mm = camera.position_mm + 500 * camera.rotation[2]
    aside_mm = 2000 * camera.rotation[0]
    assert camera.project(ahead_mm) == pytest.approx([159.5, 119.5])
    clipped = camera.clip(np.array([ahead_mm - aside_mm, ahead_mm]))
    assert clipped is not None
    assert camera.project(clipped) == pytest.approx(np.array([[0, 119.5], [159.5, 119.5]]))
    assert camera.clip(np.array([ahead_mm + aside_mm, ahead_mm + 2 * aside_mm])) is None
    assert camera.clip(np.array([-ahead_mm, -2 * ahead_mm])) is None


def test_missing_renderer_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without mitsuba the renderer is a RecordingError that names the extra to install."""
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    with pytest.raises(RecordingError, match=r'mitsuba must be installed .* pip install "bfsim\[scenes\]"'):
        Renderer({})
