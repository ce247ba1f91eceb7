"""From pictures of a chessboard, taken by both cameras at once, to rectification tables.

OpenCV finds the corners and fits the cameras: a focal length for each axis, a principal point, two radial and two
tangential terms of distortion for each, and where the right camera is. Loaded only here; the optional extra
`calibration` installs it.
"""

from __future__ import annotations

import importlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError
from bfsim.recording.frames import RectificationTables, StereoGeometry
from bfsim.recording.images import image_paths, load_image
from bfsim.recording.planes import Plane, YuvPlanes
from bfsim.recording.reader import RecordingReader
from bfsim.recording.rectifying import rectified_rotation
from bfsim.recording.writer import RecordingWriter

Corners = NDArray[np.float32]

# Fewer views than this leave the distortion to chance. [assumed]
FEWEST_PAIRS = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class StereoCalibration:
    """What the chessboards tell of the cameras.

    reprojection_px is the RMS distance of the corners found from those of the fitted cameras; vertical_rms_px and
    vertical_worst_px are how far the rows of a corner differ between the rectified pictures, and
    vertical_before_px (RMS) between the recorded ones. focal_px is that of the rectified pictures, whose
    principal point is their middle; baseline_mm is as right as the size of the squares.
    """

    tables: RectificationTables
    pair_count: int
    reprojection_px: float
    vertical_before_px: float
    vertical_rms_px: float
    vertical_worst_px: float
    focal_px: float
    baseline_mm: float


@dataclass(frozen=True, slots=True)
class _Camera:
    """A fitted camera: its matrix (3, 3), distortion, and rotation (3, 3) into the rectified frame."""

    matrix: NDArray[np.float64]
    distortion: NDArray[np.float64]
    turn: NDArray[np.float64]


def calibrate_recording(
    chessboards: str | os.PathLike[str],
    recording: str | os.PathLike[str],
    output: str | os.PathLike[str] | None = None,
    *,
    corners: tuple[int, int],
    square_mm: float,
) -> StereoCalibration:
    """Write `recording` with the rectification tables of its cameras to `output`, or in its own place.

    The folder `chessboards` holds pictures left* and right*, in pairs by the order of their names, of a board with
    `corners` (across, down) inner corners. The recording's focal length is kept, if it has one, and its baseline
    becomes the measured one. Pictures, time stamps and ground truth stay as they are. Raises RecordingError.
    """
    with RecordingReader(recording) as reader:
        size, geometry, text = (reader.width, reader.height), reader.geometry, reader.description
        if output is None and reader.other_topics:
            raise RecordingError(
                f"{reader.path}: recording must hold nothing but bfsim's topics to be calibrated in place, not "
                f"{', '.join(reader.other_topics)}, which would be lost; `--output` writes another file"
            )
    calibration = calibrate(
        chessboards,
        size,
        corners=corners,
        square_mm=square_mm,
        focal_px=geometry.focal_px if geometry else None,
    )
    if geometry is not None:
        geometry = StereoGeometry(
            calibration.focal_px, calibration.baseline_mm, geometry.height_mm, geometry.tilt_deg
        )
    writer = RecordingWriter(
        output or recording,
        width=size[0],
        height=size[1],
        geometry=geometry,
        description=text,
        rectification=calibration.tables,
    )
    # The reader closes before the writer takes its file's place.
    with writer, RecordingReader(recording) as reader:
        for frame in reader.frames():
            writer.add(
                frame.left, frame.right, frame.left_ns, frame.right_ns, frame.truth, frame.disparity_px
            )
    return calibration


def calibrate(
    chessboards: str | os.PathLike[str],
    size: tuple[int, int],
    *,
    corners: tuple[int, int],
    square_mm: float,
    focal_px: float | None = None,
) -> StereoCalibration:
    """Calibrate two cameras with pictures of `size` (width, height) from a folder of chessboard pairs.

    `focal_px` is the focal length to rectify to; without it, the mean of the left camera's. Raises RecordingError.
    """
    cv2 = _load_opencv()
    if min(corners) < 3 or square_mm <= 0:
        raise RecordingError(
            f"chessboard must have at least 3x3 inner corners and squares above 0 mm, not {corners[0]}x{corners[1]} "
            f"and {square_mm:g} mm"
        )
    pairs = _find_pairs(cv2, Path(chessboards), size, corners)
    left_points, right_points = (list(side) for side in zip(*pairs, strict=True))
    board = np.zeros((corners[0] * corners[1], 3), np.float32)
    board[:, :2] = np.mgrid[: corners[0], : corners[1]].T.reshape(-1, 2) * square_mm
    error_px, fitted, rotation, shift = _fit(cv2, [board] * len(pairs), (left_points, right_points), size)
    # From the left camera, the right one's optical centre is at -R't.
    turn = rectified_rotation(-(rotation.T @ shift).ravel(), np.array([0.0, 0.0, 1.0]))
    left, right = (
        _Camera(matrix, distortion, turn @ back)
        for (matrix, distortion), back in zip(fitted, (np.eye(3), rotation.T), strict=True)
    )
    focal = focal_px or float(np.trace(left.matrix[:2, :2]) / 2)
    target = np.array([[focal, 0, (size[0] - 1) / 2], [0, focal, (size[1] - 1) / 2], [0, 0, 1]])
    before = np.concatenate([(a - b)[:, 1] for a, b in pairs])
    after = np.concatenate(
        [(_rectify(cv2, a, left, target) - _rectify(cv2, b, right, target))[:, 1] for a, b in pairs]
    )
    return StereoCalibration(
        tables=RectificationTables(_table(cv2, left, target, size), _table(cv2, right, target, size)),
        pair_count=len(pairs),
        reprojection_px=error_px,
        vertical_before_px=_rms(before),
        vertical_rms_px=_rms(after),
        vertical_worst_px=float(np.abs(after).max()),
        focal_px=focal,
        baseline_mm=float(np.linalg.norm(shift)),
    )


def _find_pairs(
    cv2: Any, folder: Path, size: tuple[int, int], corners: tuple[int, int]
) -> list[tuple[Corners, Corners]]:
    """Return the corners (count, 2) of each pair of pictures, in the same order in both."""
    lefts, rights = (image_paths(str(folder / f"{side}*")) for side in ("left", "right"))
    if len(lefts) != len(rights):
        raise RecordingError(
            f"{folder}: chessboard pictures must be in pairs, not {len(lefts)} left* and {len(rights)} right*"
        )
    if len(lefts) < FEWEST_PAIRS:
        raise RecordingError(
            f"{folder}: chessboard pairs must be at least {FEWEST_PAIRS}, not {len(lefts)} "
            f"({lefts[0].name} to {lefts[-1].name})"
        )
    pairs = []
    for left_path, right_path in zip(lefts, rights, strict=True):
        left, right = (_find_corners(cv2, path, size, corners) for path in (left_path, right_path))
        # A board turned by half a circle looks the same: begin at the same end in both.
        if (left[-1] - left[0]) @ (right[-1] - right[0]) < 0:
            right = right[::-1]
        pairs.append((left, right))
    return pairs


def _find_corners(cv2: Any, path: Path, size: tuple[int, int], corners: tuple[int, int]) -> Corners:
    grey = _grey(path, size)
    found, points = cv2.findChessboardCornersSB(grey, corners, flags=cv2.CALIB_CB_ACCURACY)
    if not found:
        raise RecordingError(
            f"{path}: picture must show a whole chessboard of {corners[0]}x{corners[1]} inner corners, but none is "
            "found; `--corners` says how many it has"
        )
    flat: Corners = points.reshape(-1, 2)
    return flat


def _grey(path: Path, size: tuple[int, int]) -> Plane:
    image = load_image(path)
    if image.size != size:
        raise RecordingError(
            f"{path}: chessboard picture must be {size[0]}x{size[1]} like the recording, "
            f"not {image.width}x{image.height}"
        )
    return np.ascontiguousarray(YuvPlanes.from_image(image).y)


def _fit(
    cv2: Any, boards: list[Corners], points: tuple[list[Corners], list[Corners]], size: tuple[int, int]
) -> tuple[float, list[tuple[Any, Any]], Any, Any]:
    """Return the RMS error, matrix and distortion of both cameras, and the rotation and shift to the right one."""
    alone = [
        cv2.calibrateCamera(boards, side, size, None, None, flags=cv2.CALIB_FIX_K3)[1:3] for side in points
    ]
    error_px, *fitted, rotation, shift, _, _ = cv2.stereoCalibrate(
        boards, *points, *alone[0], *alone[1], size, flags=cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_K3
    )
    return error_px, [(fitted[0], fitted[1]), (fitted[2], fitted[3])], rotation, shift


def _rectify(cv2: Any, points: Corners, camera: _Camera, target: NDArray[np.float64]) -> Corners:
    """Return where recorded points (count, 2) are in the rectified picture."""
    moved = cv2.undistortPoints(points[:, None], camera.matrix, camera.distortion, R=camera.turn, P=target)
    flat: Corners = moved.reshape(-1, 2)
    return flat


def _table(
    cv2: Any, camera: _Camera, target: NDArray[np.float64], size: tuple[int, int]
) -> NDArray[np.int32]:
    """Return the nearest source row and column of each rectified pixel (2, height, width), -1 outside."""
    columns, rows = cv2.initUndistortRectifyMap(
        camera.matrix, camera.distortion, camera.turn, target, size, cv2.CV_32FC1
    )
    table = np.rint(np.stack([rows, columns])).astype(np.int32)
    bounds = np.array(size[::-1])[:, None, None]
    return np.where(((table >= 0) & (table < bounds)).all(axis=0), table, np.int32(-1))


def _rms(values: NDArray[Any]) -> float:
    return float(np.sqrt(np.mean(np.square(values, dtype=np.float64))))


def _load_opencv() -> Any:
    try:
        cv2 = importlib.import_module("cv2")
    except ImportError as error:
        raise RecordingError(
            'OpenCV must be installed to calibrate cameras: pip install "bfsim[opencv]"'
        ) from error
    # Threads would add up in another order every time.
    cv2.setNumThreads(1)
    return cv2
