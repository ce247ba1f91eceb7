"""The content of a recording as plain data: stereo frames, stereo geometry, rectification tables."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError

UyvyImage = NDArray[np.uint8]
"""One picture as the camera sends it: shape (height, 2 * width), bytes U0 Y0 V0 Y1 for each two pixels."""

DisparityImage = NDArray[np.float32]
"""Exact disparity of each pixel of the left picture in px, shape (height, width)."""


@dataclass(frozen=True, slots=True)
class StereoGeometry:
    """The positions of the two cameras: equal, parallel, side by side; or of the one that feeds both sides.

    focal_px is the focal length after rectification, in pixels of the recorded image; baseline_mm is the distance
    between the optical centres, 0 for a single camera; height_mm is their height above the floor; tilt_deg is how far
    they look down. The last two are None if nobody has measured them, as after a calibration.
    """

    focal_px: float
    baseline_mm: float
    height_mm: float | None = None
    tilt_deg: float | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None and not math.isfinite(value):
                raise RecordingError(f"stereo geometry: {field.name} must be a finite number, not {value}")
        if self.focal_px <= 0:
            raise RecordingError(f"stereo geometry: focal_px must be above 0, not {self.focal_px}")
        if self.baseline_mm < 0:
            raise RecordingError(
                f"stereo geometry: baseline_mm must be above 0, or 0 for a single camera, not {self.baseline_mm}"
            )
        if self.tilt_deg is not None and not -90 <= self.tilt_deg <= 90:
            raise RecordingError(f"stereo geometry: tilt_deg must be -90 to 90, not {self.tilt_deg}")

    def __str__(self) -> str:
        height, tilt = self.height_mm, self.tilt_deg
        return ", ".join(
            (
                f"focal length {self.focal_px:.6g} px",
                f"baseline {self.baseline_mm:.6g} mm" if self.baseline_mm else "a single camera",
                "height unknown" if height is None else f"height {height:g} mm",
                "tilt unknown" if tilt is None else f"looking down {tilt:g}°",
            )
        )

    @property
    def stance(self) -> tuple[float, float]:
        """Height in mm and tilt in degrees, for those who need both. Raises RecordingError if one is unknown."""
        if self.height_mm is None or self.tilt_deg is None:
            raise RecordingError("stereo geometry: height_mm and tilt_deg must both be known")
        return self.height_mm, self.tilt_deg


@dataclass(frozen=True, slots=True)
class RectificationTables:
    """For each camera, the source pixel of each rectified pixel: `rectified[y, x] = picture[row[y, x], column[y, x]]`.

    left and right are int32 of shape (2, height, width): the source rows, then the source columns. Both are -1 where
    the camera saw nothing of a rectified pixel.
    """

    left: NDArray[np.int32]
    right: NDArray[np.int32]

    def check(self, width: int, height: int) -> None:
        """Raise RecordingError unless both tables fit pictures of width x height pixels."""
        shape = (2, height, width)
        for side, table in (("left", self.left), ("right", self.right)):
            if table.dtype != np.int32 or table.shape != shape:
                raise RecordingError(
                    f"{side} rectification table must be int32 of shape {shape} for "
                    f"{width}x{height} pixels, not {table.dtype} of shape {table.shape}"
                )
            rows, columns = table
            inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
            if not (inside | ((rows == -1) & (columns == -1))).all():
                y, x = (int(index) for index in np.argwhere(~inside & ((rows != -1) | (columns != -1)))[0])
                raise RecordingError(
                    f"{side} rectification table must point at rows 0 to {height - 1} and columns 0 to "
                    f"{width - 1}, or at -1 and -1 for nothing, not at row {rows[y, x]} and column "
                    f"{columns[y, x]} (pixel x {x}, y {y})"
                )


@dataclass(frozen=True, slots=True)
class StereoFrame:
    """One picture of each camera, with its time and, if known, what is in the scene.

    left and right may be read-only. left_ns and right_ns are nanoseconds since the recording's own epoch; they differ
    if the cameras are not locked to each other. disparity_px, float32 of shape (height, width), is how much farther
    left the right picture shows what each left pixel shows, 0 at infinite distance.
    """

    index: int
    left: UyvyImage
    right: UyvyImage
    left_ns: int
    right_ns: int
    truth: Mapping[str, Any] | None
    disparity_px: DisparityImage | None = None
