"""The things of a robot-soccer scene: plain data, and the positions of their corners in the world."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bfsim.recording.scenes.pinhole import Vector

Colour = tuple[float, float, float]  # linear reflectance of red, green and blue light, 0..1

# Height of painted lines above the floor: in one plane, paint and floor would hide each other at random.
PAINT_MM = 0.3

# A chord of a circle of 250 mm then deviates by 0.1 mm, less than the camera can see.
ARC_STEP_DEG = 3.0


def placed(centre_mm: Vector, half_size_mm: Vector, heading_deg: float = 0.0) -> Vector:
    """Return the 4x4 matrix that scales -1..1 to `half_size_mm`, turns it round z and moves it."""
    turn = math.radians(heading_deg)
    rotation = np.array(
        [[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * half_size_mm
    matrix[:3, 3] = centre_mm
    return matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class Ball:
    """A ball that rests on the floor at (x, y), with the seam of a tennis ball if the seam has a colour."""

    x_mm: float
    y_mm: float
    radius_mm: float
    colour: Colour
    seam_colour: Colour | None = None
    seam_turn_deg: float = 0.0

    @property
    def centre_mm(self) -> Vector:
        """Return the centre in the world (3,)."""
        return np.array([self.x_mm, self.y_mm, self.radius_mm])


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A box with the middle of its bottom at `foot_mm`; its size is along its heading, across it, and up."""

    foot_mm: tuple[float, float, float]
    size_mm: tuple[float, float, float]
    colour: Colour
    heading_deg: float = 0.0

    @property
    def matrix(self) -> Vector:
        """Return the 4x4 matrix that maps the cube -1..1 to this box in the world."""
        half_mm = np.array(self.size_mm) / 2
        return placed(np.add(self.foot_mm, (0, 0, half_mm[2])), half_mm, self.heading_deg)

    @property
    def corners_mm(self) -> Vector:
        """Return the world corners (8, 3): the four at the bottom, then those above them."""
        cube = np.array([(x, y, z, 1) for z in (-1, 1) for x, y in ((-1, 1), (-1, -1), (1, -1), (1, 1))])
        corners: Vector = (cube @ self.matrix.T)[:, :3]
        return corners


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """A cube-shaped player: a dark body from the floor up, and on top of it its coloured mark."""

    x_mm: float
    y_mm: float
    heading_deg: float
    side_mm: float
    body_height_mm: float
    body_colour: Colour
    mark_height_mm: float
    mark_colour: Colour

    @property
    def body(self) -> Box:
        """Return the part below the mark."""
        size_mm = (self.side_mm, self.side_mm, self.body_height_mm)
        return Box(
            foot_mm=(self.x_mm, self.y_mm, 0),
            size_mm=size_mm,
            colour=self.body_colour,
            heading_deg=self.heading_deg,
        )

    @property
    def mark(self) -> Box:
        """Return the coloured mark."""
        foot_mm = (self.x_mm, self.y_mm, self.body_height_mm)
        size_mm = (self.side_mm, self.side_mm, self.mark_height_mm)
        return Box(foot_mm=foot_mm, size_mm=size_mm, colour=self.mark_colour, heading_deg=self.heading_deg)


@dataclass(frozen=True, slots=True, kw_only=True)
class Goal:
    """Three panels round a mouth that opens towards -x, in the middle of the goal line, without a top."""

    line_x_mm: float
    width_mm: float
    depth_mm: float
    height_mm: float
    panel_mm: float
    colour: Colour

    @property
    def mouth_mm(self) -> Vector:
        """Return the world corners of the mouth (4, 3): bottom left, bottom right, top right, top left."""
        half_mm, top_mm = self.width_mm / 2, self.height_mm
        corners = ((half_mm, 0), (-half_mm, 0), (-half_mm, top_mm), (half_mm, top_mm))
        return np.array([(self.line_x_mm, y_mm, z_mm) for y_mm, z_mm in corners], dtype=float)

    @property
    def panels(self) -> dict[str, Box]:
        """Return the back and the sides."""
        aside_mm = (self.width_mm + self.panel_mm) / 2
        side_x_mm = self.line_x_mm + self.depth_mm / 2
        side_size_mm = (self.depth_mm, self.panel_mm, self.height_mm)
        back_x_mm = self.line_x_mm + self.depth_mm + self.panel_mm / 2
        back_size_mm = (self.panel_mm, self.width_mm + 2 * self.panel_mm, self.height_mm)
        return {
            "back": Box(foot_mm=(back_x_mm, 0, 0), size_mm=back_size_mm, colour=self.colour),
            "left": Box(foot_mm=(side_x_mm, aside_mm, 0), size_mm=side_size_mm, colour=self.colour),
            "right": Box(foot_mm=(side_x_mm, -aside_mm, 0), size_mm=side_size_mm, colour=self.colour),
        }


@dataclass(frozen=True, slots=True)
class FieldLine:
    """A straight painted line; its ends are in the middle of the stroke."""

    name: str
    start_mm: tuple[float, float]
    end_mm: tuple[float, float]
    width_mm: float

    @property
    def ends_mm(self) -> Vector:
        """Return the world end points (2, 3)."""
        return np.array([(*self.start_mm, PAINT_MM), (*self.end_mm, PAINT_MM)])


@dataclass(frozen=True, slots=True)
class FieldArc:
    """A painted arc of a circle; its radius is to the middle of the stroke."""

    centre_mm: tuple[float, float]
    radius_mm: float
    from_deg: float
    to_deg: float
    width_mm: float

    @property
    def strokes(self) -> list[FieldLine]:
        """Return the arc as short straight strokes, one each ARC_STEP_DEG or less."""
        count = math.ceil((self.to_deg - self.from_deg) / ARC_STEP_DEG)
        angles = np.radians(np.linspace(self.from_deg, self.to_deg, count + 1))
        x_mm = (self.centre_mm[0] + self.radius_mm * np.cos(angles)).tolist()
        y_mm = (self.centre_mm[1] + self.radius_mm * np.sin(angles)).tolist()
        points = list(zip(x_mm, y_mm, strict=True))
        return [FieldLine("stroke", start, end, self.width_mm) for start, end in pairwise(points)]


Thing = Ball | Box | Robot | Goal


@dataclass(frozen=True, slots=True)
class Lamp:
    """A white panel under the ceiling that shines straight down; its size is along x and y."""

    centre_mm: tuple[float, float, float]
    size_mm: tuple[float, float]
    radiance: float
