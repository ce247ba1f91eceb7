"""What firmware saw in space: objects, lines and edges, and where it assumes its cameras to be.

Points are in mm in the left camera's frame: x to the right, y down, z forward along its axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from bfsim.seen.in_pictures import Colour, Point

PointMm = tuple[float, float, float]


class Solid(StrEnum):
    """The solid that an object is drawn as."""

    SPHERE = "sphere"
    BOX = "box"


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenObject:
    """An object that the firmware knows.

    `accuracy` is 0 to 1. `place_mm` is its middle; with `is_direction`, only the direction is known, and the length means
    nothing. `image_px` is its middle and `image_size_px` its width and height in what `camera` looked at. `width_mm` and
    `height_mm` are those of its model. `tests` are the names of the tests passed. `age_frames` is 0 if it was seen in
    this frame.
    """

    name: str
    solid: Solid
    colour: Colour
    width_mm: float
    height_mm: float
    accuracy: float
    tests: tuple[str, ...]
    place_mm: PointMm
    is_direction: bool
    camera: str
    image_px: Point
    image_size_px: Point
    age_frames: int

    @property
    def distance_mm(self) -> float:
        """Distance of its middle from the left camera. Without meaning for a direction."""
        return float(np.linalg.norm(self.place_mm))

    @property
    def caption(self) -> str:
        """Text beside it: name, distance, accuracy, and when it was seen if that was before this frame."""
        how_far = "direction only" if self.is_direction else f"{self.distance_mm:.0f} mm"
        frames = "frame" if self.age_frames == 1 else "frames"
        age = f"  {self.age_frames} {frames} ago" if self.age_frames else ""
        return f"{self.name}  {how_far}  {100 * self.accuracy:.0f} %{age}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenLine3D:
    """A line in space, and the numbers of the lines in both pictures that it comes from."""

    start_mm: PointMm
    end_mm: PointMm
    left_line: int
    right_line: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenEdges3D:
    """Edges in space: `places_mm` of shape (n, 3), and the numbers of the left picture's edges that they come from."""

    places_mm: NDArray[np.int32]
    left_edges: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.places_mm)


def no_edges_3d() -> SeenEdges3D:
    """Return no edges in space."""
    return SeenEdges3D(places_mm=np.zeros((0, 3), np.int32), left_edges=np.zeros(0, np.int32))


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenGeometry:
    """Where the firmware assumes its cameras to be. They are equal, parallel and side by side.

    `focal_px` and `principal_px` refer to the picture that it looked at. The cameras are `baseline_mm` apart, `height_mm`
    above the floor, and look down by `tilt_deg`.
    """

    focal_px: float
    principal_px: Point
    baseline_mm: float
    height_mm: float
    tilt_deg: float
