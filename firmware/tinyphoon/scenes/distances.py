"""A box and a ball at known distances, as in T Tables 6.2 and 6.3: a frame for each distance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from bfsim.recording.scenes import Box, Pose, Scene, SceneAtDistances, StereoGeometry
from tinyphoon.scenes.soccer import BALL, FLOOR, RED, SOCCER

# Both borders are in both pictures at the shortest distance. [assumed]
_BOX_MM = (80.0, 100.0, 100.0)

_THING_X_MM = 600.0
_BOX = Box(foot_mm=(_THING_X_MM + _BOX_MM[0] / 2, 0, 0), size_mm=_BOX_MM, colour=RED)
_BALL = replace(BALL, x_mm=_THING_X_MM, y_mm=0)

# Wide and empty: only the thing has edges. [assumed]
_FLOOR = replace(FLOOR, size_mm=(4000.0, 4000.0), lines=())


def _box_at(distances_mm: Sequence[float], geometry: StereoGeometry) -> Scene:
    """Return a box between the axes of the cameras; its front is at each of `distances_mm`, over the floor."""
    return replace(
        SOCCER,
        description=f"T Table 6.2: a box with its front {_listed(distances_mm)} mm before the cameras.",
        things={"box": _BOX},
        floor=_FLOOR,
        geometry=geometry,
        poses=tuple(Pose(x_mm=_THING_X_MM - distance, y_mm=0, heading_deg=0) for distance in distances_mm),
        samples=64,
        seed=602,
    )


def _ball_at(distances_mm: Sequence[float], geometry: StereoGeometry) -> Scene:
    """Return a ball of 6 cm between the axes of the cameras; its centre is at each of `distances_mm` in depth.

    Depth is along the axes, as T Eq. 4.1 measures it.
    """
    tilt = math.radians(geometry.tilt_deg)
    lower_mm = geometry.height_mm - _BALL.radius_mm
    ways_mm = [(distance - lower_mm * math.sin(tilt)) / math.cos(tilt) for distance in distances_mm]
    return replace(
        SOCCER,
        description=f"T Table 6.3: a ball of 6 cm with its centre {_listed(distances_mm)} mm deep.",
        things={"ball": _BALL},
        floor=_FLOOR,
        geometry=geometry,
        poses=tuple(Pose(x_mm=_THING_X_MM - way_mm, y_mm=0, heading_deg=0) for way_mm in ways_mm),
        samples=64,
        seed=603,
    )


def _listed(distances_mm: Sequence[float]) -> str:
    return ", ".join(f"{distance:g}" for distance in distances_mm)


# Distances, focal length and baseline of the synthetic pictures: [T 6.2], [T 6.3.1]. The thesis gives the focal length
# in mm and uses it in px. Height and tilt: [assumed]; level for the box, so that its upright edges are as deep at the
# top as at the bottom, and as on the robot for the ball [T 6.4].
BOX_DISTANCES = SceneAtDistances(
    at=_box_at,
    distances_mm=(250.0, 300.0, 350.0, 400.0, 450.0, 500.0, 600.0, 700.0, 800.0, 1000.0),
    geometry=StereoGeometry(focal_px=311.0, baseline_mm=30.0, height_mm=60.0, tilt_deg=0.0),
)
BALL_DISTANCES = SceneAtDistances(
    at=_ball_at,
    distances_mm=(300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0, 1100.0),
    geometry=StereoGeometry(focal_px=311.0, baseline_mm=30.0, height_mm=120.0, tilt_deg=10.0),
)
