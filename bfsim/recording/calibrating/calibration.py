"""From pictures of a chessboard, taken by both cameras at once or by the only one, to rectification tables.

OpenCV finds the corners and fits the cameras. Loaded only here; the optional extra `opencv` installs it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError, listed
from bfsim.recording.calibrating.boards import BoardView, find_views
from bfsim.recording.calibrating.residual_plot import draw_residuals
from bfsim.recording.calibration_report import (
    CalibrationReport,
    LensFit,
    LensName,
    ViewError,
    mean_focal_px,
)
from bfsim.recording.cameras.camera_model import CameraModel, Fit, FittedCamera, Floats
from bfsim.recording.cameras.fisheye_model import FisheyeModel
from bfsim.recording.cameras.pinhole_model import PinholeModel
from bfsim.recording.cameras.rectifying import nearest_table, rectified_rotation
from bfsim.recording.frames import RectificationTables
from bfsim.recording.importing.sources import Skipped

# Fewer views leave the distortion to chance. [assumed]
FEWEST_VIEWS = 5

OUTLIER_MEDIANS, LEAST_OUTLIER_PX = 3.0, 0.3
"""A view is left out if its error is more than this many times the median, and more than corner finders err in good
pictures. [assumed]
"""

_SKIPPED_LISTED = 5

_MODELS: dict[LensName, type[CameraModel]] = {"pinhole": PinholeModel, "fisheye": FisheyeModel}


@dataclass(frozen=True, slots=True)
class StereoCalibration:
    """The tables that rectify, the report on how they were found, and a plot (PNG) of the corners' residuals."""

    tables: RectificationTables
    report: CalibrationReport
    plot: bytes


def calibrate(
    chessboards: str | os.PathLike[str],
    size: tuple[int, int],
    *,
    corners: tuple[int, int],
    square_mm: float,
    focal_px: float | None = None,
    lens: LensName = "pinhole",
    mono: bool = False,
    resize: bool = False,
    bits: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> StereoCalibration:
    """Calibrate cameras with pictures of `size` (width, height) of a board with `corners` (across, down) inner corners.

    The folder `chessboards` holds pictures, or folders of pictures, whose names say left and right; the rest of the
    name tells which ones were taken at the same time. With `mono` it holds pictures of the only camera. Pictures
    without a whole board are skipped, and views that do not fit the others are left out; both are in the report. With
    `resize`, pictures of another size are scaled as by an import with `--resize`. `bits`: how many the cameras use of
    16-bit pixels. `focal_px` is the focal length after rectification; the default is the mean of the left camera's.
    `progress` is called with the number of views examined, and that of all. Raises RecordingError.
    """
    model = _MODELS[lens]()
    if min(corners) < 3 or square_mm <= 0:
        raise RecordingError(
            f"chessboard must have at least 3x3 inner corners and squares above 0 mm, not {corners[0]}x{corners[1]} "
            f"and {square_mm:g} mm"
        )
    folder = Path(chessboards)
    views, skipped = find_views(
        model.cv2, folder, size, corners, mono=mono, resize=resize, bits=bits, progress=progress
    )
    if len(views) < FEWEST_VIEWS:
        raise _too_few(folder, views, skipped, mono=mono)
    board = np.zeros((corners[0] * corners[1], 3))
    board[:, :2] = np.mgrid[: corners[0], : corners[1]].T.reshape(-1, 2) * square_mm
    fit, used, errors = _fit_without_outliers(model, board, views, size)
    turns = _turns(fit, folder)
    lenses = tuple(_lens_fit(camera) for camera in fit.cameras)
    focal = focal_px or mean_focal_px(lenses[0].focal_px)
    target = np.array([[focal, 0, (size[0] - 1) / 2], [0, focal, (size[1] - 1) / 2], [0, 0, 1]])
    pairs = list(zip(fit.cameras, turns, strict=True))
    tables = [nearest_table(model, camera, turn, target, size) for camera, turn in pairs]
    before, after = _row_differences(model, pairs, used, target, size)
    report = CalibrationReport(
        lens=lens,
        cameras=lenses,
        views=errors,
        skipped=tuple(skipped),
        reprojection_px=_rms(fit.errors_px),
        vertical_before_px=_rms(before),
        vertical_rms_px=_rms(after),
        vertical_worst_px=float(np.abs(after).max()),
        focal_px=focal,
        baseline_mm=float(np.linalg.norm(fit.shift)),
    )
    points = list(zip(*(view.points for view in used), strict=True))
    plot = draw_residuals(errors, points, fit.residuals_px, size)
    return StereoCalibration(RectificationTables(tables[0], tables[-1]), report, plot)


def _too_few(
    folder: Path, views: Sequence[BoardView], skipped: Sequence[Skipped], *, mono: bool
) -> RecordingError:
    what = "pictures" if mono else "pairs"
    names: dict[str, dict[str, None]] = {}
    for each in skipped:
        names.setdefault(each.reason, {})[each.name] = None  # a name may occur in both folders
    reasons = [f"{listed([*of_one], _SKIPPED_LISTED)}: {reason}" for reason, of_one in names.items()]
    more = (
        f"; and for {len(reasons) - _SKIPPED_LISTED} more reasons" if len(reasons) > _SKIPPED_LISTED else ""
    )
    left_out = f"; skipped were {'; '.join(reasons[:_SKIPPED_LISTED])}{more}" if skipped else ""
    return RecordingError(
        f"{folder}: chessboard {what} must be at least {FEWEST_VIEWS}, not {len(views)}{left_out}; "
        "`--corners` says how many inner corners the board has"
    )


def _fit_without_outliers(
    model: CameraModel, board: Floats, views: Sequence[BoardView], size: tuple[int, int]
) -> tuple[Fit, list[BoardView], tuple[ViewError, ...]]:
    """Fit the cameras repeatedly, each time without the views that fit none of the others.

    Also return the remaining views, and the errors of all views.
    """
    used, outliers = list(views), list[ViewError]()
    while True:
        fit, used, misfits = _fit_what_can_be(model, board, used, size)
        outliers += misfits
        errors_px = np.sqrt(np.square(fit.errors_px).mean(axis=0))
        is_out = errors_px > max(OUTLIER_MEDIANS * float(np.median(errors_px)), LEAST_OUTLIER_PX)
        all_errors = [
            ViewError(names=view.names, errors_px=tuple(map(float, each)), is_outlier=False)
            for view, each in zip(used, fit.errors_px.T, strict=True)
        ]
        if not is_out.any() or (~is_out).sum() < FEWEST_VIEWS:
            return fit, used, (*all_errors, *outliers)
        outliers += [
            ViewError(names=each.names, errors_px=each.errors_px, is_outlier=True)
            for each, out in zip(all_errors, is_out, strict=True)
            if out
        ]
        used = [view for view, out in zip(used, is_out, strict=True) if not out]


def _fit_what_can_be(
    model: CameraModel, board: Floats, views: Sequence[BoardView], size: tuple[int, int]
) -> tuple[Fit, list[BoardView], list[ViewError]]:
    """Fit the cameras to the views; if that fails, leave out those that fit ordinary lenses worst.

    One grossly wrong view makes the fit of fisheyes fail as a whole, but hardly ever that of ordinary lenses. The
    errors of views that are left out come from the latter. Raises RecordingError if too few views are left.
    """
    sides = list(zip(*(view.points for view in views), strict=True))
    try:
        return model.fit(board, sides, size), list(views), []
    except RecordingError:
        if len(views) <= FEWEST_VIEWS:
            raise
    errors_px = PinholeModel().fit(board, sides, size).errors_px
    worst = int(np.square(errors_px).mean(axis=0).argmax())
    fit, used, outliers = _fit_what_can_be(model, board, [*views[:worst], *views[worst + 1 :]], size)
    errors = tuple(map(float, errors_px[:, worst]))
    return fit, used, [*outliers, ViewError(names=views[worst].names, errors_px=errors, is_outlier=True)]


def _turns(fit: Fit, folder: Path) -> list[Floats]:
    """Return the rotation (3, 3) of each camera into the rectified frame; the only camera stays as it is."""
    if len(fit.cameras) == 1:
        return [np.eye(3)]
    # Seen from the left camera, the right one's optical centre is at -R't.
    centre = -(fit.rotation.T @ fit.shift)
    if centre[0] <= 0:
        raise RecordingError(
            f"{folder}: the right camera must be to the right of the left one, but is {-centre[0]:.0f} mm to the left; "
            "the names of the pictures may be swapped"
        )
    turn = rectified_rotation(centre, np.array([0.0, 0.0, 1.0]))
    return [turn, turn @ fit.rotation.T]


def _row_differences(
    model: CameraModel,
    pairs: Sequence[tuple[FittedCamera, Floats]],
    views: Sequence[BoardView],
    target: Floats,
    size: tuple[int, int],
) -> tuple[Floats, Floats]:
    """Return how far the rows of corners differ between both pictures, as recorded and as rectified.

    Only corners inside the rectified pictures count, or all if there are none.
    """
    if len(pairs) == 1:
        return np.zeros(1), np.zeros(1)
    recorded = [np.concatenate([view.points[side] for view in views]) for side in (0, 1)]
    left, right = (
        model.rectified(points, camera, turn, target)
        for points, (camera, turn) in zip(recorded, pairs, strict=True)
    )
    shown = np.all([(each >= 0) & (each < size) for each in (left, right)], axis=(0, 2))
    if not shown.any():
        shown[:] = True
    return (recorded[0] - recorded[1])[shown, 1], (left - right)[shown, 1]


def _lens_fit(camera: FittedCamera) -> LensFit:
    matrix = camera.matrix
    return LensFit(
        focal_px=(float(matrix[0, 0]), float(matrix[1, 1])),
        principal_px=(float(matrix[0, 2]), float(matrix[1, 2])),
        distortion=tuple(map(float, np.ravel(camera.distortion))),
    )


def _rms(values: NDArray[Any]) -> float:
    return float(np.sqrt(np.mean(np.square(values, dtype=np.float64))))
