"""Lenses that bend, cameras out of line, and the ideal pair that rectification makes of them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import RecordingError
from bfsim.recording import StereoGeometry
from bfsim.recording.scenes.drive import Pose
from bfsim.recording.scenes.lens import Lens, Misfit, rectified, through
from bfsim.recording.scenes.pinhole import Pinhole, Vector

GEOMETRY = StereoGeometry(focal_px=386.0, baseline_mm=30.47, height_mm=120.0, tilt_deg=10.0)
CAMERAS = Pose(x_mm=0, y_mm=0, heading_deg=30).cameras(GEOMETRY)
POINTS_MM = CAMERAS["left"].position_mm + np.array(
    [[500, 200, -50], [400, 300, 0], [900, 500, 80], [300, 250, -90]], dtype=float
)


@given(
    st.builds(Lens, *(st.floats(-0.2, 0.2),) * 2, *(st.floats(-0.005, 0.005),) * 2),
    st.tuples(st.floats(-0.45, 0.45), st.floats(-0.35, 0.35)),
)
def test_undistort_undoes_distort(lens: Lens, point: tuple[float, float]) -> None:
    """What the lens moves comes back to where it was, to a ten-thousandth of a pixel."""
    ideal = np.array(point)
    assert lens.undistort(lens.distort(ideal)) == pytest.approx(ideal, abs=1e-4 / 386)


def test_barrel_pulls_in_and_tangential_terms_shift() -> None:
    """Radial distortion is along the radius, 1 + k1 r^2 + k2 r^4; at x only, p2 adds 3 x^2 and p1 adds x^2."""
    x = 0.4
    moved = Lens(-0.3, 0.1, 0.002, 0.003).distort(np.array([x, 0.0]))
    assert moved == pytest.approx([x * (1 - 0.3 * x**2 + 0.1 * x**4) + 0.003 * 3 * x**2, 0.002 * x**2])


def test_lens_that_folds_the_picture_is_refused() -> None:
    """A lens under which rays cross inside the picture has no way back and says so."""
    with pytest.raises(RecordingError, match="lens must bend the picture less than k1 -3"):
        Lens(k1=-3.0).undistort(np.array([[0.4, 0.3]]))


def test_misfit_must_be_of_numbers() -> None:
    """A camera turned by no number is nowhere."""
    with pytest.raises(RecordingError, match=r"turn of the right camera must be finite numbers, not \(nan"):
        Misfit(turn_deg=(float("nan"), 0.0, 0.0))


def ramp(view: Pinhole) -> Vector:
    """Light that is the ray's own slope, right and down."""
    columns, rows = np.meshgrid(np.arange(view.width_px), np.arange(view.height_px))
    return (np.stack([columns, rows], axis=-1) - view.centre_px) / view.focal_px


def test_picture_through_a_lens_shows_each_pixel_its_own_ray() -> None:
    """Each pixel gets the light of the ideal ray that the lens moves to it, to a tenth of a pixel."""
    lens = Lens(-0.25, 0.08, 0.001, -0.002)
    seen = through(lens, CAMERAS["left"], ramp)
    columns, rows = np.meshgrid(np.arange(320), np.arange(240))
    distorted = lens.distort(seen.astype(float)) * 386 + CAMERAS["left"].centre_px
    assert np.abs(distorted - np.stack([columns, rows], axis=-1)).max() < 0.25


def test_rectified_pair_of_an_ideal_one_is_itself() -> None:
    """Cameras that are in line stay as they are."""
    for side, camera in rectified(CAMERAS).items():
        assert camera.rotation == pytest.approx(CAMERAS[side].rotation)


@pytest.mark.parametrize("shift_mm", [(0.0, 0.0, 0.0), (0.5, 1.0, -0.7)])
def test_rectified_pair_sees_each_point_in_one_row(shift_mm: tuple[float, float, float]) -> None:
    """Whatever the right camera's turn and shift, rows agree and columns differ by f b / depth."""
    right = Misfit(turn_deg=(1.0, -2.0, 3.0), shift_mm=shift_mm).misplaced(CAMERAS["right"])
    ideal = rectified({"left": CAMERAS["left"], "right": right})
    left_px, right_px = (camera.project(POINTS_MM) for camera in ideal.values())
    assert left_px[:, 1] == pytest.approx(right_px[:, 1])
    baseline_mm = np.linalg.norm(right.position_mm - CAMERAS["left"].position_mm)
    depths_mm = ideal["left"].from_world(POINTS_MM)[:, 2]
    assert left_px[:, 0] - right_px[:, 0] == pytest.approx(386 * baseline_mm / depths_mm)
    # The left camera still looks as far down.
    assert ideal["left"].rotation[2] @ CAMERAS["left"].rotation[2] > np.cos(np.radians(2))


def test_misfit_turns_round_the_axis_and_shifts_along_it() -> None:
    """A turn round down moves a point ahead along the row; a shift forward brings it nearer."""
    right = CAMERAS["right"]
    ahead_mm = right.position_mm + 500 * right.rotation[2]
    turned = Misfit(turn_deg=(0, 1.0, 0)).misplaced(right)
    x, y = turned.project(ahead_mm) - turned.centre_px
    assert (abs(x), y) == pytest.approx((386 * np.tan(np.radians(1)), 0))
    nearer = Misfit(shift_mm=(1.0, 2.0, 3.0)).misplaced(right)
    assert nearer.from_world(ahead_mm) == pytest.approx([-1, -2, 497])
