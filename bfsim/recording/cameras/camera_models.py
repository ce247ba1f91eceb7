"""What OpenCV fits to the corners of chessboards: pinhole cameras with distortion, or fisheye cameras.

The pinhole model has a focal length for each axis, a principal point, two radial and two tangential terms [OpenCV,
calib3d]; the fisheye model, for lenses of 100° and more, has four terms of the angle off the axis in place of these
[Kannala and Brandt 2006]. Both rectify to pinhole pictures.
"""

from __future__ import annotations

import importlib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError

Floats = NDArray[np.float64]

FARTHEST_CORNER_RAD = np.radians(80)
"""Where the fit of a fisheye begins to seek the corner farthest off the axis. At 90 and more there is no way back from it."""


@dataclass(frozen=True, slots=True)
class FittedCamera:
    """A camera: its matrix (3, 3) and the terms of its distortion."""

    matrix: Floats
    distortion: Floats


@dataclass(frozen=True, slots=True)
class Fit:
    """One camera, or two: from the left one's axes `rotation` (3, 3) and `shift` (3,) in mm lead to the right one's.

    residuals_px (cameras, views, corners, 2) are the corners found less those of the fitted cameras.
    """

    cameras: tuple[FittedCamera, ...]
    rotation: Floats
    shift: Floats
    residuals_px: Floats

    @property
    def errors_px(self) -> Floats:
        """RMS distance of the corners found from those of the fitted cameras (cameras, views)."""
        errors_px: Floats = np.sqrt(np.square(self.residuals_px).sum(axis=3).mean(axis=2))
        return errors_px


class CameraModel(ABC):
    """How a lens bends light, and how to find by how much."""

    def __init__(self) -> None:
        self.cv2 = load_opencv()

    def fit(self, board: Floats, sides: Sequence[Sequence[Floats]], size: tuple[int, int]) -> Fit:
        """Fit the cameras to the corners of each view of each side; `board` (corners, 3) is in mm.

        Raises RecordingError where they cannot be fitted.
        """
        try:
            if len(sides) == 1:
                camera, poses = self.fit_one(board, sides[0], size)
                cameras: tuple[FittedCamera, ...] = (camera,)
                rotation, shift = np.eye(3), np.zeros(3)
            else:
                alone = [self.fit_one(board, side, size)[0] for side in sides]
                cameras, rotation, shift, poses = self.fit_pair(board, sides, size, alone)
        except self.cv2.error as error:
            raise RecordingError(
                "cameras must be such as the chessboards tell, but nothing fits these; take them at other angles, and "
                f"all over the picture ({str(error).splitlines()[0]})"
            ) from None
        turns = (np.eye(3), rotation)
        residuals = [
            [
                points - self.project(board, *_moved(self.cv2, pose, turn, moved), camera)
                for points, pose in zip(side, poses, strict=True)
            ]
            for side, camera, turn, moved in zip(sides, cameras, turns, (np.zeros(3), shift), strict=False)
        ]
        return Fit(cameras, rotation, shift, np.array(residuals))

    @abstractmethod
    def fit_one(
        self, board: Floats, side: Sequence[Floats], size: tuple[int, int]
    ) -> tuple[FittedCamera, list[Any]]:
        """Fit one camera; return it and the pose of the board in each view."""

    @abstractmethod
    def fit_pair(
        self,
        board: Floats,
        sides: Sequence[Sequence[Floats]],
        size: tuple[int, int],
        alone: Sequence[FittedCamera],
    ) -> tuple[tuple[FittedCamera, ...], Floats, Floats, list[Any]]:
        """Fit both cameras from what each is `alone`; return also the rotation, the shift, and the poses."""

    @abstractmethod
    def project(self, board: Floats, turn: Floats, shift: Floats, camera: FittedCamera) -> Floats:
        """Return where the camera shows the corners (count, 2)."""

    @abstractmethod
    def rectified(self, points: Floats, camera: FittedCamera, turn: Floats, target: Floats) -> Floats:
        """Return where recorded points (count, 2) are in the rectified picture."""

    @abstractmethod
    def sources(
        self, camera: FittedCamera, turn: Floats, target: Floats, size: tuple[int, int]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the source column and row (height, width) of each rectified pixel."""


class Pinhole(CameraModel):
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
        return _flat(points)

    def rectified(self, points: Floats, camera: FittedCamera, turn: Floats, target: Floats) -> Floats:
        """Return where recorded points are in the rectified picture."""
        return _flat(
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


class Fisheye(CameraModel):
    """Lenses of 100° and more."""

    @property
    def _refine(self) -> int:
        """Flags of a fit that begins with given cameras. OpenCV 4 has them beside this model, 5 among all others."""
        flags = self.cv2.fisheye if hasattr(self.cv2.fisheye, "CALIB_FIX_SKEW") else self.cv2
        return int(flags.CALIB_USE_INTRINSIC_GUESS | flags.CALIB_RECOMPUTE_EXTRINSIC | flags.CALIB_FIX_SKEW)

    def fit_one(
        self, board: Floats, side: Sequence[Floats], size: tuple[int, int]
    ) -> tuple[FittedCamera, list[Any]]:
        """Fit one camera, from one that sees all corners before it: OpenCV's own start fails on most wide lenses."""
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
        return _flat(points)

    def rectified(self, points: Floats, camera: FittedCamera, turn: Floats, target: Floats) -> Floats:
        """Return where recorded points are in the rectified picture."""
        return _flat(
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


def load_opencv(purpose: str = "to calibrate and rectify cameras") -> Any:
    """Return OpenCV, which little needs. Raises RecordingError, with the purpose, where it is not installed."""
    try:
        cv2 = importlib.import_module("cv2")
    except ImportError as error:
        raise RecordingError(f'OpenCV must be installed {purpose}: pip install "bfsim[opencv]"') from error
    # Threads would add up in another order every time.
    cv2.setNumThreads(1)
    return cv2


def _moved(cv2: Any, pose: tuple[Floats, Floats], turn: Floats, shift: Floats) -> tuple[Floats, Floats]:
    """Return the pose (rotation vector, shift) of a board in the axes that `turn` and `shift` lead to."""
    matrix, _ = cv2.Rodrigues(np.asarray(pose[0], np.float64).reshape(3, 1))
    vector, _ = cv2.Rodrigues(turn @ matrix)
    return vector, turn @ np.asarray(pose[1], np.float64).ravel() + shift


def _singles(views: Sequence[NDArray[Any]]) -> list[NDArray[np.float32]]:
    return [np.ascontiguousarray(points, np.float32) for points in views]


def _rows(views: Sequence[NDArray[Any]]) -> list[Floats]:
    return [np.ascontiguousarray(points, np.float64)[None] for points in views]


def _flat(points: NDArray[Any]) -> Floats:
    return points.reshape(-1, 2).astype(np.float64)
