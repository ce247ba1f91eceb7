"""Ordinary lenses: a focal length for each axis, a principal point, two radial and two tangential terms [OpenCV, calib3d]."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.cameras.camera_model import CameraModel, FittedCamera, Floats, flat


class PinholeModel(CameraModel):
    """Ordinary lenses."""

    def fit_one(
        self, board: Floats, side: Sequence[Floats], size: tuple[int, int]
    ) -> tuple[FittedCamera, list[Any]]:
        """Fit one camera."""
        cv2 = self.cv2
        _, matrix, distortion, turns, shifts = cv2.calibrateCamera(
            _singles([board] * len(side)), _singles(side), size, None, None, flags=cv2.CALIB_FIX_K3
        )
        return FittedCamera(matrix, distortion), list(zip(turns, shifts, strict=True))

    def fit_pair(
        self,
        board: Floats,
        sides: Sequence[Sequence[Floats]],
        size: tuple[int, int],
        alone: Sequence[FittedCamera],
    ) -> tuple[tuple[FittedCamera, ...], Floats, Floats, list[Any]]:
        """Fit both cameras."""
        cv2 = self.cv2
        start = [part for camera in alone for part in (camera.matrix, camera.distortion)]
        _, *fitted, rotation, shift, _, _, turns, shifts, _ = cv2.stereoCalibrateExtended(
            _singles([board] * len(sides[0])),
            *(_singles(side) for side in sides),
            *start,
            size,
            np.eye(3),
            np.zeros(3),
            flags=cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_K3,
        )
        cameras = (FittedCamera(fitted[0], fitted[1]), FittedCamera(fitted[2], fitted[3]))
        return cameras, rotation, shift.ravel(), list(zip(turns, shifts, strict=True))

    def project(self, board: Floats, turn: Floats, shift: Floats, camera: FittedCamera) -> Floats:
        """Return where the camera shows the corners."""
        points, _ = self.cv2.projectPoints(board, turn, shift, camera.matrix, camera.distortion)
        return flat(points)

    def rectified(self, points: Floats, camera: FittedCamera, turn: Floats, target: Floats) -> Floats:
        """Return where recorded points are in the rectified picture."""
        return flat(
            self.cv2.undistortPoints(points[:, None], camera.matrix, camera.distortion, R=turn, P=target)
        )

    def sources(
        self, camera: FittedCamera, turn: Floats, target: Floats, size: tuple[int, int]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the source column and row of each rectified pixel."""
        columns, rows = self.cv2.initUndistortRectifyMap(
            camera.matrix, camera.distortion, turn, target, size, self.cv2.CV_32FC1
        )
        return columns, rows


def _singles(views: Sequence[NDArray[Any]]) -> list[NDArray[np.float32]]:
    return [np.ascontiguousarray(points, np.float32) for points in views]
