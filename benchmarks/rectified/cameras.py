"""Real cameras whose lenses are known exactly: where rectified pixels come from, and where pixels go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bfsim.api import SourcePixels
from bfsim.recording.scenes.lens import Lens, turned

Places = NDArray[np.float32]
"""Columns and rows of shape (height, width, 2)."""


@dataclass(frozen=True, slots=True)
class RealCameras:
    """Two cameras with one lens, the right one turned by degrees round its right, down and forward."""

    focal_px: float
    lens: Lens
    right_turn_deg: tuple[float, float, float]

    def sources(self, height: int, width: int, side: str) -> Places:
        """Return where each rectified pixel lies in the picture of a camera."""
        points, centre = self._points(height, width)
        seen = _rays(points) @ self._turn(side).T
        return (self.lens.distort(seen[..., :2] / seen[..., 2:]) * self.focal_px + centre).astype(np.float32)

    def targets(self, height: int, width: int, side: str) -> Places:
        """Return where each pixel of a camera lies in the rectified picture."""
        points, centre = self._points(height, width)
        ideal = _rays(self.lens.undistort(points)) @ self._turn(side)
        return (ideal[..., :2] / ideal[..., 2:] * self.focal_px + centre).astype(np.float32)

    def tables(self, height: int, width: int) -> dict[str, SourcePixels]:
        """Return the nearest source pixels of each side, -1 outside of the picture."""
        return {side: _nearest(self.sources(height, width, side)) for side in ("left", "right")}

    def _turn(self, side: str) -> NDArray[np.float64]:
        """Return the rotation of a camera against the rectified one."""
        rotation = np.eye(3)
        if side == "right":
            for axis, angle_deg in enumerate(self.right_turn_deg):
                rotation = turned(rotation, axis, angle_deg)
        return rotation

    def _points(self, height: int, width: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the pixels of a picture as points at unit depth, and its centre."""
        centre = np.array([width - 1, height - 1]) / 2
        columns, rows = np.meshgrid(np.arange(width), np.arange(height))
        return (np.stack([columns, rows], axis=-1) - centre) / self.focal_px, centre


def _rays(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points at unit depth as vectors."""
    return np.concatenate([points, np.ones_like(points[..., :1])], axis=-1)


def _nearest(places: Places) -> SourcePixels:
    columns, rows = np.moveaxis(np.rint(places).astype(np.int32), -1, 0)
    height, width = rows.shape
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    return SourcePixels(np.where(inside, rows, np.int32(-1)), np.where(inside, columns, np.int32(-1)))
