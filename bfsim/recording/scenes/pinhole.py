"""The ideal pinhole camera of the synthetic scenes: exactly where a world point lies in the picture.

Ground truth refers to ideal cameras. A recording that is rendered without a lens is rectified by construction; one that
is rendered through a lens, or with misaligned cameras, is so after rectification.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.frames import StereoGeometry

Vector = NDArray[np.float64]

WIDTH_PX, HEIGHT_PX = 320, 240


@dataclass(frozen=True, slots=True, eq=False)
class Pinhole:
    """A camera in the world; the rows of `rotation` are its right, down and forward."""

    position_mm: Vector
    rotation: Vector
    focal_px: float
    width_px: int = WIDTH_PX
    height_px: int = HEIGHT_PX

    @property
    def centre_px(self) -> Vector:
        """Return the principal point (x, y): the middle of the picture."""
        return np.array([(self.width_px - 1) / 2, (self.height_px - 1) / 2])

    @property
    def horizontal_view_deg(self) -> float:
        """Return the angle from the left border of the picture to the right one."""
        return 2 * math.degrees(math.atan(self.width_px / 2 / self.focal_px))

    def from_world(self, points_mm: Vector) -> Vector:
        """Turn world points (..., 3) into camera points (..., 3): right, down and depth in mm."""
        inside: Vector = (points_mm - self.position_mm) @ self.rotation.T
        return inside

    def project(self, points_mm: Vector) -> Vector:
        """Project world points (..., 3), all of them in front of the camera, to pixels (..., 2)."""
        inside = self.from_world(points_mm)
        projected: Vector = self.centre_px + self.focal_px * inside[..., :2] / inside[..., 2:]
        return projected

    def faces(self, points_mm: Vector) -> bool:
        """Whether all world points (..., 3) are in front of the camera."""
        return bool((self.from_world(points_mm)[..., 2] > 0).all())

    def rays(self) -> Vector:
        """Return the world directions (height, width, 3) of all pixel centres, with unit depth."""
        columns, rows = np.meshgrid(np.arange(self.width_px), np.arange(self.height_px))
        slopes = (np.stack([columns, rows], axis=-1) - self.centre_px) / self.focal_px
        rays: Vector = slopes @ self.rotation[:2] + self.rotation[2]
        return rays

    def clip(self, ends_mm: Vector) -> Vector | None:
        """Cut a world segment (2, 3) to the part inside the picture; None if there is none."""
        start, end = self.from_world(ends_mm)
        first, last = 0.0, 1.0
        for normal in self._borders():
            at_start, at_end = normal @ start, normal @ end
            if at_start < 0 and at_end < 0:
                return None
            if at_start < 0:
                first = max(first, at_start / (at_start - at_end))
            elif at_end < 0:
                last = min(last, at_start / (at_start - at_end))
        if first >= last:
            return None
        clipped: Vector = ends_mm[0] + np.array([[first], [last]]) * (ends_mm[1] - ends_mm[0])
        return clipped

    def _borders(self) -> tuple[Vector, ...]:
        """Return the inward normals (camera frame) of the planes through the outermost pixel centres."""
        half_x, half_y = self.centre_px
        return tuple(
            np.array(normal)
            for normal in (
                (self.focal_px, 0.0, half_x),
                (-self.focal_px, 0.0, half_x),
                (0.0, self.focal_px, half_y),
                (0.0, -self.focal_px, half_y),
            )
        )


def stereo_pair(
    middle_mm: Vector, *, heading_deg: float, geometry: StereoGeometry
) -> tuple[Pinhole, Pinhole]:
    """Return the left and the right camera, parallel, around `middle_mm` (3,)."""
    heading, tilt = math.radians(heading_deg), math.radians(geometry.stance[1])
    forward = np.array(
        [math.cos(tilt) * math.cos(heading), math.cos(tilt) * math.sin(heading), -math.sin(tilt)]
    )
    right = np.array([math.sin(heading), -math.cos(heading), 0.0])
    rotation = np.stack([right, np.cross(forward, right), forward])
    aside_mm = right * geometry.baseline_mm / 2
    return (
        Pinhole(middle_mm - aside_mm, rotation, geometry.focal_px),
        Pinhole(middle_mm + aside_mm, rotation, geometry.focal_px),
    )
