"""Lenses of 100° and more: four terms in the angle from the axis [Kannala and Brandt 2006]."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.cameras.camera_model import CameraModel, FittedCamera, Floats, flat

FARTHEST_CORNER_RAD = np.radians(80)
"""Where the fit of a fisheye first places the corner farthest off the axis. From 90° and more it cannot return."""


class FisheyeModel(CameraModel):
    """Lenses of 100° and more."""

    @property
    def _refine(self) -> int:
        """Flags of a fit that starts from given cameras. OpenCV 4 has them in this model, OpenCV 5 among all others."""
        flags = self.cv2.fisheye if hasattr(self.cv2.fisheye, "CALIB_FIX_SKEW") else self.cv2
        return int(flags.CALIB_USE_INTRINSIC_GUESS | flags.CALIB_RECOMPUTE_EXTRINSIC | flags.CALIB_FIX_SKEW)

    def fit_one(
        self, board: Floats, side: Sequence[Floats], size: tuple[int, int]
    ) -> tuple[FittedCamera, list[Any]]:
        """Fit one camera, from one with all corners in front of it: OpenCV's own start fails on most wide lenses."""
        middle = (np.array(size) - 1) / 2
        focal_px = max(np.linalg.norm(points - middle, axis=1).max() for points in side) / FARTHEST_CORNER_RAD
        start = np.array([[focal_px, 0, middle[0]], [0, focal_px, middle[1]], [0, 0, 1]])
        _, matrix, distortion, turns, shifts = self.cv2.fisheye.calibrate(
            _rows([board] * len(side)), _rows(side), size, start, np.zeros((4, 1)), flags=self._refine
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
        start = [part for camera in alone for part in (camera.matrix, camera.distortion)]
        _, *fitted, rotation, shift, turns, shifts = self.cv2.fisheye.stereoCalibrate(
            _rows([board] * len(sides[0])), *(_rows(side) for side in sides), *start, size, flags=self._refine
        )
        cameras = (FittedCamera(fitted[0], fitted[1]), FittedCamera(fitted[2], fitted[3]))
        return cameras, rotation, shift.ravel(), list(zip(turns, shifts, strict=True))

    def project(self, board: Floats, turn: Floats, shift: Floats, camera: FittedCamera) -> Floats:
        """Return where the camera shows the corners."""
        points, _ = self.cv2.fisheye.projectPoints(
            board[None].astype(np.float64), turn, shift, camera.matrix, camera.distortion
        )
        return flat(points)

    def rectified(self, points: Floats, camera: FittedCamera, turn: Floats, target: Floats) -> Floats:
        """Return where recorded points are in the rectified picture."""
        return flat(
            self.cv2.fisheye.undistortPoints(
                points[:, None].astype(np.float64), camera.matrix, camera.distortion, R=turn, P=target
            )
        )

    def sources(
        self, camera: FittedCamera, turn: Floats, target: Floats, size: tuple[int, int]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the source column and row of each rectified pixel."""
        columns, rows = self.cv2.fisheye.initUndistortRectifyMap(
            camera.matrix, camera.distortion, turn, target, size, self.cv2.CV_32FC1
        )
        return columns, rows


def _rows(views: Sequence[NDArray[Any]]) -> list[Floats]:
    return [np.ascontiguousarray(points, np.float64)[None] for points in views]
