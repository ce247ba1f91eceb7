"""The ideal pair behind a real one: the direction of both cameras after rectification, and their source pixels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.cameras.camera_model import CameraModel, FittedCamera, Floats


def rectified_rotation(baseline: NDArray[np.float64], forward: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the one rotation (3, 3) of both rectified cameras; its rows are their right, down and forward.

    `baseline` (3,) points from the left optical centre to the right one, `forward` (3,) is where the left camera looks,
    both in any one frame, in which the rows are also given. Right is along the baseline, as rectification requires. The
    remaining freedom, a turn round the baseline, is used to look where the left camera looks, so that its tilt stays
    true; OpenCV splits that turn between the cameras.
    """
    right = baseline / np.linalg.norm(baseline)
    down = np.cross(forward, right)
    down /= np.linalg.norm(down)
    return np.stack([right, down, np.cross(right, down)])


def nearest_table(
    model: CameraModel, camera: FittedCamera, turn: Floats, target: Floats, size: tuple[int, int]
) -> NDArray[np.int32]:
    """Return the nearest source row and column of each rectified pixel (2, height, width), -1 outside."""
    columns, rows = model.sources(camera, turn, target, size)
    # Points outside a lens's view may be anywhere, even at infinity.
    nearest = np.rint(np.nan_to_num(np.stack([rows, columns]), nan=-1, posinf=-1, neginf=-1))
    bounds = np.array(size[::-1])[:, None, None]
    inside = ((nearest >= 0) & (nearest < bounds)).all(axis=0)
    return np.where(inside, nearest, -1).astype(np.int32)
