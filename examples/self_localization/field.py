"""The map: what of the field a robot can know itself by, in mm from the field's middle, x towards the blue goal, y to the left."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tinyphoon.scenes.soccer import GOAL, LINES

Points = NDArray[np.float64]

HALF_LENGTH_MM, HALF_WIDTH_MM = 750.0, 650.0  # the feet of the walls
POST_MM = GOAL.width_mm / 2 + GOAL.panel_mm  # its outer side


@dataclass(frozen=True, slots=True)
class Field:
    """Landmarks. `posts`: feet of the goal's left and right post (2, 2), as seen from the field. `goal_line`: ends of the goal's bottom
    line (2, 2). `borders`: starts and ends (n, 2, 2) of where bright paint or a wall begins on the floor, the bright side on the left.
    """

    posts: Points
    goal_line: Points
    borders: Points


def soccer_field() -> Field:
    """Return the field of the built-in recording."""
    return Field(
        posts=np.array([(GOAL.line_x_mm, POST_MM), (GOAL.line_x_mm, -POST_MM)]),
        goal_line=np.array([(GOAL.line_x_mm, GOAL.width_mm / 2), (GOAL.line_x_mm, -GOAL.width_mm / 2)]),
        borders=np.array([*_painted(), *_walls()]),
    )


def _painted() -> Iterator[Points]:
    """Yield both borders of each painted line."""
    for line in LINES:
        ends = np.array([line.start_mm, line.end_mm])
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        aside = np.array([-along[1], along[0]]) * line.width_mm / 2  # to the left
        yield ends - aside
        yield ends[::-1] + aside


def _walls() -> Iterator[Points]:
    """Yield the feet of the walls: they run round the field with the walls on the left, but for the mouth of the blue goal."""
    x, y = HALF_LENGTH_MM, HALF_WIDTH_MM
    for start, end in (
        ((-x, y), (x, y)),
        ((x, y), (x, POST_MM)),
        ((x, -POST_MM), (x, -y)),
        ((x, -y), (-x, -y)),
    ):
        yield np.array([start, end])
