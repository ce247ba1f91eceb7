"""Models of cameras: exact corners of known cameras give these cameras back."""

from __future__ import annotations

import numpy as np
import pytest

from bfsim.errors import RecordingError
from bfsim.recording.cameras.camera_model import CameraModel, FittedCamera
from bfsim.recording.cameras.fisheye_model import FisheyeModel
from bfsim.recording.cameras.pinhole_model import PinholeModel

SIZE = (640, 480)
BOARD = np.zeros((54, 3))
BOARD[:, :2] = np.mgrid[:9, :6].T.reshape(-1, 2) * 25.0

LENSES = {
    # 130 degrees across, and an ordinary one
    FisheyeModel: FittedCamera(
        np.array([[280.0, 0, 322], [0, 281, 236], [0, 0, 1]]), np.array([[0.03, -0.01, 0.004, -0.001]]).T
    ),
    PinholeModel: FittedCamera(
        np.array([[530.0, 0, 322], [0, 531, 236], [0, 0, 1]]), np.array([[-0.25, 0.08, 0.001, -0.001, 0]])
    ),
}
TURN_DEG, SHIFT_MM = 2.0, np.array([-60.0, 1.0, 0.5])


@pytest.fixture(params=LENSES, ids=lambda kind: kind.__name__)
def model(request: pytest.FixtureRequest) -> CameraModel:
    """Each of the models."""
    pytest.importorskip("cv2", reason="calibration needs OpenCV")
    return request.param()


def turned_right() -> np.ndarray:
    """The rotation of the right camera against the left one."""
    angle = np.radians(TURN_DEG)
    return np.array(
        [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]], np.float64
    )


def corners_of(model: CameraModel, *, views: int = 15) -> list[list[np.ndarray]]:
    """What the lens of a model shows of boards that are held all about, for the left and the right camera."""
    lens, rng = LENSES[type(model)], np.random.default_rng(3)
    middle = BOARD.mean(axis=0)
    sides: list[list[np.ndarray]] = [[], []]
    for _ in range(views):
        turn, _ = model.cv2.Rodrigues(rng.uniform(-0.5, 0.5, 3))
        place = np.array([rng.uniform(-120, 120), rng.uniform(-80, 80), rng.uniform(300, 450)])
        shift = place - turn @ middle
        right = turned_right()
        for side, (turned, moved) in zip(
            sides, ((turn, shift), (right @ turn, right @ shift + SHIFT_MM)), strict=True
        ):
            vector, _ = model.cv2.Rodrigues(turned)
            side.append(model.project(BOARD, vector, moved, lens))
    return sides


def test_a_pair_is_found_again(model: CameraModel) -> None:
    """Matrix, rotation and shift, from corners without error."""
    fit = model.fit(BOARD, corners_of(model), SIZE)
    for camera in fit.cameras:
        np.testing.assert_allclose(camera.matrix, LENSES[type(model)].matrix, atol=0.5)
    np.testing.assert_allclose(fit.rotation, turned_right(), atol=1e-3)
    np.testing.assert_allclose(fit.shift, SHIFT_MM, atol=0.3)
    assert fit.errors_px.shape == (2, 15)
    assert fit.errors_px.max() < 0.02


def test_a_single_camera_is_found_again(model: CameraModel) -> None:
    """It has no rotation and no shift."""
    fit = model.fit(BOARD, corners_of(model)[:1], SIZE)
    np.testing.assert_allclose(fit.cameras[0].matrix, LENSES[type(model)].matrix, atol=0.5)
    assert fit.errors_px.max() < 0.02
    assert not fit.shift.any()


def test_tables_and_points_are_rectified_alike(model: CameraModel) -> None:
    """Where the table of a rectified pixel points, the recorded point comes back to that pixel."""
    lens, target = LENSES[type(model)], np.array([[300.0, 0, 319.5], [0, 300, 239.5], [0, 0, 1]])
    turn = turned_right()
    columns, rows = model.sources(lens, turn, target, SIZE)
    pixels = np.stack(np.meshgrid(np.arange(200, 440, 40), np.arange(160, 320, 40)), axis=-1).reshape(-1, 2)
    recorded = np.stack([columns[pixels[:, 1], pixels[:, 0]], rows[pixels[:, 1], pixels[:, 0]]], axis=1)
    np.testing.assert_allclose(model.rectified(recorded, lens, turn, target), pixels, atol=0.05)


def test_corners_that_no_camera_shows_are_refused() -> None:
    """Corners in one point: OpenCV's own error is told in words."""
    pytest.importorskip("cv2", reason="calibration needs OpenCV")
    with pytest.raises(RecordingError, match="but these fit none; take them at other angles"):
        FisheyeModel().fit(BOARD, [[np.full((54, 2), 100.0)] * 5], SIZE)


@pytest.mark.parametrize("seed", range(3))
def test_a_fisheye_is_found_from_boards_at_the_rim(seed: int) -> None:
    """Boards held near, up to 72 degrees off the axis: OpenCV's own start failed on all of these."""
    pytest.importorskip("cv2", reason="calibration needs OpenCV")
    model, rng = FisheyeModel(), np.random.default_rng(seed)
    lens = FittedCamera(
        np.array([[91.0, 0, 157], [0, 91, 122], [0, 0, 1]]), np.array([[0.02, -0.02, 0.015, -0.005]]).T
    )
    views: list[np.ndarray] = []
    while len(views) < 24:
        turn = rng.uniform(-0.7, 0.7, 3)
        matrix, _ = model.cv2.Rodrigues(turn)
        place = np.array([rng.uniform(-300, 300), rng.uniform(-200, 200), rng.uniform(120, 400)])
        seen = (BOARD - BOARD.mean(axis=0)) @ matrix.T + place
        if np.arctan2(np.hypot(seen[:, 0], seen[:, 1]), seen[:, 2]).max() < np.radians(72):
            views.append(model.project(BOARD, turn, place - matrix @ BOARD.mean(axis=0), lens))
    noisy = [points + rng.normal(0, 0.1, points.shape) for points in views]
    fit = model.fit(BOARD, [noisy], (320, 240))
    np.testing.assert_allclose(fit.cameras[0].matrix, lens.matrix, atol=0.5)
    assert fit.errors_px.max() < 0.25
