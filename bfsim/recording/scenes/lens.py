"""A real pair of cameras: lenses that bend straight lines, and a misaligned right camera.

The lens is that of Brown and Conrady with two radial and two tangential terms, as in OpenCV. The scene is rendered
ideally, finer and with a wider view, and then sampled along the bent rays.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError
from bfsim.recording.cameras.rectifying import rectified_rotation
from bfsim.recording.scenes.pinhole import Pinhole, Vector

Light = NDArray[np.float32]
"""Radiance of each colour that reaches each pixel: shape (height, width, colours)."""

# Parts of a pixel along each side, each sampled separately in the ideal picture. [assumed]
FINENESS = 3
_STEPS = 60
_TOLERANCE = 1e-8


@dataclass(frozen=True, slots=True)
class Lens:
    """Distortion of points on the plane one unit before the camera, radial (k1, k2) and tangential (p1, p2)."""

    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    def distort(self, points: Vector) -> Vector:
        """Return where the lens moves the ideal points (..., 2), right and down."""
        x, y = points[..., 0], points[..., 1]
        square = x * x + y * y
        radial = 1 + square * (self.k1 + square * self.k2)
        moved_x = x * radial + 2 * self.p1 * x * y + self.p2 * (square + 2 * x * x)
        moved_y = y * radial + self.p1 * (square + 2 * y * y) + 2 * self.p2 * x * y
        return np.stack([moved_x, moved_y], axis=-1)

    def undistort(self, points: Vector) -> Vector:
        """Return the ideal points (..., 2) that the lens moves to these. Raises RecordingError if it cannot."""
        ideal = points.copy()
        for _ in range(_STEPS):
            off = points - self.distort(ideal)
            if np.abs(off).max() < _TOLERANCE:
                return ideal
            ideal += off
            if not np.abs(ideal).max() < 10 * max(1.0, np.abs(points).max()):
                break
        raise RecordingError(
            f"lens must bend the picture less than k1 {self.k1:g}, k2 {self.k2:g}, p1 {self.p1:g}, p2 {self.p2:g}: "
            "with these, rays cross within the picture"
        )


@dataclass(frozen=True, slots=True)
class Misfit:
    """How a real pair differs from the ideal one: its lenses, and the right camera's rotation and shift.

    The turn (degrees, right-handed, in the order given) is round, and the shift (mm) along, the camera's right, down
    and forward axes.
    """

    lens: Lens = Lens()
    turn_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shift_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name, value in (("turn", self.turn_deg), ("shift", self.shift_mm)):
            if not all(map(math.isfinite, value)):
                raise RecordingError(f"{name} of the right camera must be finite numbers, not {value}")

    def misplaced(self, ideal: Pinhole) -> Pinhole:
        """Return the right camera in its real position."""
        rotation = ideal.rotation
        for axis, angle_deg in enumerate(self.turn_deg):
            rotation = turned(rotation, axis, angle_deg)
        return replace(
            ideal,
            position_mm=ideal.position_mm + np.array(self.shift_mm) @ ideal.rotation,
            rotation=rotation,
        )


def rectified(cameras: dict[str, Pinhole]) -> dict[str, Pinhole]:
    """Return the ideal pair that rectification makes of a real one: at the same places, with parallel axes."""
    left, right = cameras["left"], cameras["right"]
    rotation = rectified_rotation(right.position_mm - left.position_mm, left.rotation[2])
    return {side: replace(camera, rotation=rotation) for side, camera in cameras.items()}


def through(lens: Lens, camera: Pinhole, look: Callable[[Pinhole], Light]) -> Light:
    """Return the light (height, width, colours) that a camera gets through a lens.

    `look` returns the light that reaches an ideal camera; it is called for a finer and wider picture.
    """
    bent = bent_points(lens, camera.focal_px, camera.width_px, camera.height_px, FINENESS)
    view = _wide_view(camera, bent)
    columns, rows = np.moveaxis(np.rint(bent * view.focal_px + view.centre_px).astype(int), -1, 0)
    return mean_of_parts(look(view)[rows, columns], FINENESS)


@lru_cache(maxsize=2)
def bent_points(lens: Lens, focal_px: float, width_px: int, height_px: int, fineness: int) -> Vector:
    """Return the ideal points, right and down at unit depth, that a picture shows through a lens.

    Each pixel has fineness x fineness parts: shape (fineness * height, fineness * width, 2).
    """
    sizes = width_px, height_px
    grid = np.meshgrid(*((np.arange(size * fineness) + 0.5) / fineness - size / 2 for size in sizes))
    return lens.undistort(np.stack(grid, axis=-1) / focal_px)


def mean_of_parts(light: Light, fineness: int) -> Light:
    """Return the light (height, width, colours) of pixels from that of their fineness x fineness parts."""
    height, width, colours = light.shape
    parts = light.reshape(height // fineness, fineness, width // fineness, fineness, colours)
    mean: Light = parts.mean(axis=3).mean(axis=1)
    return mean


def _wide_view(camera: Pinhole, bent: Vector) -> Pinhole:
    """Return the finer and wider ideal camera whose picture holds all the bent pixels."""
    focal_px = camera.focal_px * FINENESS
    half_x, half_y = (math.ceil(np.abs(bent[..., axis]).max() * focal_px) + 1 for axis in (0, 1))
    return replace(camera, focal_px=focal_px, width_px=2 * half_x, height_px=2 * half_y)


def turned(rotation: Vector, axis: int, angle_deg: float) -> Vector:
    """Return a camera's rotation after a turn round one of its own axes: right, down, forward."""
    angle = math.radians(angle_deg)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[[first, second], [first, second]] = math.cos(angle)
    turn[first, second], turn[second, first] = math.sin(angle), -math.sin(angle)
    return turn @ rotation
