"""The position and direction of the cameras, and their way over the floor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bfsim.recording.frames import StereoGeometry
from bfsim.recording.scenes.pinhole import Pinhole, stereo_pair


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """The point on the floor midway between the cameras, and where they look; 0 degrees is along x."""

    x_mm: float
    y_mm: float
    heading_deg: float

    def cameras(self, geometry: StereoGeometry) -> dict[str, Pinhole]:
        """Return the "left" and the "right" camera."""
        left, right = stereo_pair(
            np.array([self.x_mm, self.y_mm, geometry.stance[0]]),
            heading_deg=self.heading_deg,
            geometry=geometry,
        )
        return {"left": left, "right": right}


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """A drive at constant speed and turning rate, from an initial pose."""

    x_mm: float
    y_mm: float
    heading_deg: float
    speed_mm_per_s: float
    turn_deg_per_s: float

    def pose(self, seconds: float) -> Pose:
        """Return the pose `seconds` after the start."""
        turned_deg = self.turn_deg_per_s * seconds
        # The chord of an arc points half-way between the first heading and the last; sinc is chord over arc.
        chord = math.radians(self.heading_deg + turned_deg / 2)
        chord_mm = self.speed_mm_per_s * seconds * float(np.sinc(turned_deg / 360))
        return Pose(
            x_mm=self.x_mm + chord_mm * math.cos(chord),
            y_mm=self.y_mm + chord_mm * math.sin(chord),
            heading_deg=self.heading_deg + turned_deg,
        )

    def poses(self, count: int, period_ns: int) -> tuple[Pose, ...]:
        """Return `count` poses, one each period, from the start."""
        return tuple(self.pose(index * period_ns / 1e9) for index in range(count))
