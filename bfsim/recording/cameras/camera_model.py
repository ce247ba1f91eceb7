"""What OpenCV fits to the corners of chessboards: cameras of one model, whose pictures it rectifies to pinhole pictures."""

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
        """RMS distance between the corners found and those of the fitted cameras (cameras, views)."""
        errors_px: Floats = np.sqrt(np.square(self.residuals_px).sum(axis=3).mean(axis=2))
        return errors_px


class CameraModel(ABC):
    """How a lens bends light, and how to fit its parameters."""

    def __init__(self) -> None:
        self.cv2 = load_opencv()

    def fit(self, board: Floats, sides: Sequence[Sequence[Floats]], size: tuple[int, int]) -> Fit:
        """Fit the cameras to the corners of each view of each side; `board` (corners, 3) is in mm.

        Raises RecordingError if they cannot be fitted.
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
                "chessboard pictures must fit some pair of cameras, but these fit none; take them at other angles, and "
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
        """Fit both cameras, starting from each one `alone`; also return the rotation, the shift, and the poses."""

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


def load_opencv(purpose: str = "to calibrate and rectify cameras") -> Any:
    """Return OpenCV, which few functions need. Raises RecordingError, with the purpose, if it is not installed."""
    try:
        cv2 = importlib.import_module("cv2")
    except ImportError as error:
        raise RecordingError(f'OpenCV must be installed {purpose}: pip install "bfsim[opencv]"') from error
    # Threads would add up in a different order each time.
    cv2.setNumThreads(1)
    return cv2


def _moved(cv2: Any, pose: tuple[Floats, Floats], turn: Floats, shift: Floats) -> tuple[Floats, Floats]:
    """Return the pose (rotation vector, shift) of a board in the axes reached by `turn` and `shift`."""
    matrix, _ = cv2.Rodrigues(np.asarray(pose[0], np.float64).reshape(3, 1))
    vector, _ = cv2.Rodrigues(turn @ matrix)
    return vector, turn @ np.asarray(pose[1], np.float64).ravel() + shift


def flat(points: NDArray[Any]) -> Floats:
    """Return points of OpenCV as an array (count, 2)."""
    return points.reshape(-1, 2).astype(np.float64)
