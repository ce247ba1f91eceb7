"""From a message of the vision sensor to what a robot can compare with its map.

Ground coordinates of the robot: forward and left, in mm, from the middle between its cameras.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from field import Points
from numpy.typing import NDArray

from tinyphoon.strategy.models import MODELS, Shape
from tinyphoon.strategy_unit.decoding import Results, Side

GOALS = {each.number for each in MODELS if each.shape == Shape.GOAL and each.name == "blue goal"}
SIDES = (Side.LEFT, Side.RIGHT)

FLOOR_MM = 12.0  # so far from the floor may a line be that lies on it: a disparity off by a pixel and a half, a metre away
SHORTEST_MM = 30.0
FARTHEST_MM = 1500.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Eye:
    """The left camera: focal length and principal point in pixels, baseline and height in mm, tilt in radians."""

    focal_px: float
    centre_px: tuple[float, float]
    baseline_mm: float
    height_mm: float
    tilt: float

    @property
    def aside_mm(self) -> float:
        """How far left of the middle between the cameras it is."""
        return self.baseline_mm / 2

    def ways(self, pixels: Points) -> Points:
        """Return where pixels (..., 2) lie: forward, left and down (..., 3), in any length."""
        right, down = np.moveaxis((pixels - np.array(self.centre_px)) / self.focal_px, -1, 0)
        sine, cosine = math.sin(self.tilt), math.cos(self.tilt)
        return np.stack([cosine - down * sine, -right, sine + down * cosine], axis=-1)

    def on_floor(self, ways: Points) -> Points:
        """Return where ways (..., 3) meet the floor (..., 2); all must go down."""
        met: Points = ways[..., :2] * (self.height_mm / ways[..., 2:])
        return met + np.array([0, self.aside_mm])

    def pixels_of(self, places_mm: Points) -> Points:
        """Return where places in the camera's frame (..., 3) are in the picture."""
        return np.array(self.centre_px) + self.focal_px * places_mm[..., :2] / places_mm[..., 2:]

    def heights_mm(self, places_mm: Points) -> NDArray[np.float64]:
        """Return how high over the floor places in the camera's frame (..., 3) are."""
        return (
            self.height_mm - places_mm[..., 2] * math.sin(self.tilt) - places_mm[..., 1] * math.cos(self.tilt)
        )


@dataclass(frozen=True, slots=True)
class Sight:
    """What a frame tells. `posts`: which post (0 is the left one) and its bearing to the left from the camera, in radians, which is
    `aside_mm` left of the robot's middle. `goal_lines`: ends of the goal's bottom line on the floor (n, 2, 2); `borders`: ends of
    lines on the floor (n, 2, 2), the bright side on the left.
    """

    posts: tuple[tuple[int, float], ...]
    aside_mm: float
    goal_lines: Points
    borders: Points


def sight_of(results: Results, eye: Eye) -> Sight:
    """Return what a message tells of posts, bottom line and 3-D lines.

    The bearing of a post is known well, and not how far away it is (T §6.5). Lines on the floor are placed by their
    pixels and the floor, which is more exact than their disparity; that tells which lines are on the floor.
    """
    posts, goal_lines = [], []
    for line in results.lines:
        ends = np.array(line.ends_px).reshape(2, 2)
        ways = eye.ways(ends)
        if line.model in GOALS and line.side in SIDES:
            middle = ways.mean(axis=0)
            posts.append((SIDES.index(line.side), math.atan2(middle[1], middle[0])))
        elif line.model in GOALS and line.side == Side.BOTTOM and (ways[:, 2] > 0).all():
            goal_lines.append(eye.on_floor(ways))
    places = results.lines_3d.astype(float)
    lying = places[(np.abs(eye.heights_mm(places)) < FLOOR_MM).all(axis=1)]
    borders = eye.on_floor(eye.ways(eye.pixels_of(lying)))
    lengths = np.linalg.norm(borders[:, 1] - borders[:, 0], axis=-1)
    near = (np.linalg.norm(borders, axis=-1) < FARTHEST_MM).all(axis=1)
    return Sight(
        tuple(posts),
        eye.aside_mm,
        np.array(goal_lines).reshape(-1, 2, 2),
        borders[(lengths > SHORTEST_MM) & near],
    )
