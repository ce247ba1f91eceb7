"""ROS's camera_info: the geometry of the cameras, and the tables that rectify their pictures.

K is the camera's matrix, D its distortion, R its turn into the rectified axes, P the matrix of the rectified pair, whose
fourth column holds the baseline [sensor_msgs/CameraInfo]. Geometry and tables are for pictures with the principal point
in the middle, as `bfsim record calibrate` makes them, so P's own principal point is not kept.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bfsim.errors import RecordingError, shown
from bfsim.recording.cameras.camera_model import FittedCamera, Floats
from bfsim.recording.cameras.fisheye_model import FisheyeModel
from bfsim.recording.cameras.pinhole_model import PinholeModel
from bfsim.recording.cameras.rectifying import nearest_table
from bfsim.recording.frames import RectificationTables, StereoGeometry

CAMERA_INFO = "sensor_msgs/msg/CameraInfo"

_TERMS = {"plumb_bob": (4, 5), "rational_polynomial": (8,), "equidistant": (4,), "fisheye": (4,), "": (0,)}
"""The number of distortion terms of each model: sensor_msgs/distortion_models, in OpenCV's order."""
_FISHEYES = ("equidistant", "fisheye")
_SAME_PX = 0.01
"""If rectification moves no pixel by more, pictures are left as they are."""


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """One camera as its topic describes it: `matrix` K (9 numbers), `turn` R (9), `projection` P (12, in px and m).

    `is_window`: the pictures are binned, or cut out of those that it describes. `is_rectified`: it describes other
    pictures than the rectified ones in the bag.
    """

    topic: str
    size: tuple[int, int]
    model: str
    distortion: tuple[float, ...]
    matrix: tuple[float, ...]
    turn: tuple[float, ...]
    projection: tuple[float, ...]
    is_window: bool
    is_rectified: bool

    @classmethod
    def of(cls, message: Any, topic: str, *, is_rectified: bool) -> CameraInfo:
        """Return the content of a message; in ROS 1 the letters are capitals."""
        d, k, r, p = (
            tuple(float(each) for each in getattr(message, name, getattr(message, name.upper(), ())))
            for name in "dkrp"
        )
        window = message.roi
        is_window = max(message.binning_x, message.binning_y) > 1 or any((window.x_offset, window.y_offset))
        size = message.width, message.height
        return cls(topic, size, message.distortion_model, d, k, r, p, is_window, is_rectified)

    @property
    def lens(self) -> FittedCamera:
        """The matrix (3, 3) and the distortion of the pictures in the bag."""
        if self.is_rectified:
            return FittedCamera(np.reshape(self.projection, (3, 4))[:, :3], np.zeros(4))
        distortion = self.distortion if any(self.distortion) else (0.0,) * 4
        return FittedCamera(np.reshape(self.matrix, (3, 3)), np.array(distortion))

    @property
    def rotation(self) -> Floats:
        """The rotation (3, 3) of the pictures in the bag into the rectified axes."""
        return np.eye(3) if self.is_rectified else np.reshape(self.turn, (3, 3))

    def problem(self, size: tuple[int, int]) -> str:
        """Say why it cannot be used for pictures of that size; "" if it can."""
        return next(self._problems(size), "")

    def _problems(self, size: tuple[int, int]) -> Iterator[str]:
        rotation, projection = np.reshape(self.turn, (3, 3)), np.reshape(self.projection, (3, 4))
        if not np.isfinite(self.matrix).all() or min(self.matrix[0], self.matrix[4]) <= 0:
            yield "has no camera matrix K: the camera is not calibrated"
        if not np.isfinite((*self.turn, *self.projection, *self.distortion)).all():
            yield "has a number in R, P or D that is not finite"
        if min(projection[0, 0], projection[1, 1]) <= 0:
            yield "has no projection P: the camera is not calibrated"
        if self.size != size:
            yield f"is for pictures of {self.size[0]}x{self.size[1]}, and these are {size[0]}x{size[1]}"
        if self.is_window:
            yield "is for pictures that are binned or cut out of larger ones"
        if self.model not in _TERMS:
            known = ", ".join(filter(None, _TERMS))
            yield f"has the distortion model {shown(self.model)}, and bfsim knows {known}"
        elif len(self.distortion) not in _TERMS[self.model] and any(self.distortion):
            yield f"has {len(self.distortion)} terms of distortion, which is no {shown(self.model)}"
        if not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-3) or np.linalg.det(rotation) < 0:
            yield "has an R that is no rotation"
        if projection[1, 3]:
            yield "is of cameras one above the other, and bfsim knows those side by side"


@dataclass(frozen=True, slots=True)
class Rig:
    """Geometry and tables, given or made from camera_info, and notes on them."""

    geometry: StereoGeometry | None
    tables: RectificationTables | None
    notes: tuple[str, ...]


def rig_of(
    cameras: tuple[CameraInfo | None, ...],
    sizes: tuple[tuple[int, int], ...],
    fits: tuple[Floats, ...],
    size: tuple[int, int],
    given: Rig,
) -> Rig:
    """Return geometry and tables for pictures of `size`, of one camera or of a left and a right one.

    `sizes` are those of the pictures in the bag, and `fits` (3, 3) map their pixels to the recorded ones. Whatever is
    `given` is kept; a geometry gets the focal length of the tables. Raises RecordingError if the cameras are swapped,
    or if OpenCV is needed but not installed.
    """
    known = [each for each in cameras if each]
    if len(known) < len(cameras):
        return given
    nothing = "neither geometry nor rectification is taken from it."
    problems = [
        f"{each.topic} {why}: {nothing}"
        for each, own in zip(known, sizes, strict=True)
        if (why := each.problem(own))
    ]
    baseline_mm = None if problems else _baseline_mm(known)
    if baseline_mm is None and not (problems or given.geometry):
        problems.append(f"{known[-1].topic} has no baseline in P: {nothing}")
    if problems:
        return replace(given, notes=tuple(dict.fromkeys(problems)))
    geometry, tables = given.geometry, given.tables
    notes = []
    if geometry is None:
        projected = fits[0] @ np.reshape(known[0].projection, (3, 4))[:, :3]
        geometry = StereoGeometry(float(projected[0, 0] + projected[1, 1]) / 2, baseline_mm or 0.0)
        notes.append(f"Geometry of {' and '.join(each.topic for each in known)}: {geometry}.")
    if tables is None:
        tables = _tables(known, fits, size, geometry.focal_px)
        notes.append(_tables_in_words(known) if tables else "The pictures are rectified already.")
    return Rig(geometry, tables, tuple(notes))


def _tables_in_words(cameras: list[CameraInfo]) -> str:
    models = dict.fromkeys(each.model or "no distortion" for each in cameras if not each.is_rectified)
    of_models = f" ({', '.join(models)})" if models else ""
    topics = " and ".join(each.topic for each in cameras)
    return f"Rectification tables of {topics}{of_models}: they lead to a principal point in the middle."


def _baseline_mm(cameras: list[CameraInfo]) -> float | None:
    """Return the baseline, 0 for one camera, or None if P does not have it."""
    if len(cameras) == 1:
        return 0.0
    left, right = (each.projection[3] / each.projection[0] for each in cameras)
    metres = left - right
    if metres < 0:
        raise RecordingError(
            f"{cameras[1].topic}: the right camera must be to the right of the left one, but is {-1000 * metres:.4g} mm to "
            "the left; `--topics LEFT RIGHT` says which is which"
        )
    return 1000 * metres or None


def _tables(
    cameras: list[CameraInfo], fits: tuple[Floats, ...], size: tuple[int, int], focal_px: float
) -> RectificationTables | None:
    """Return the tables for one focal length and a centred principal point, or None if no pixel would move."""
    width, height = size
    target = np.array([[focal_px, 0, (width - 1) / 2], [0, focal_px, (height - 1) / 2], [0, 0, 1]])
    lenses = [
        FittedCamera(fit @ each.lens.matrix, each.lens.distortion)
        for each, fit in zip(cameras, fits, strict=True)
    ]
    if all(
        not each.lens.distortion.any()
        and np.allclose(each.rotation, np.eye(3), atol=1e-6)
        and np.abs(lens.matrix - target).max() < _SAME_PX
        for each, lens in zip(cameras, lenses, strict=True)
    ):
        return None
    tables = [
        nearest_table(
            FisheyeModel() if each.model in _FISHEYES and not each.is_rectified else PinholeModel(),
            lens,
            each.rotation,
            target,
            size,
        )
        for each, lens in zip(cameras, lenses, strict=True)
    ]
    return RectificationTables(tables[0], tables[-1])
