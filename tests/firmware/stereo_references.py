"""What the 3-D lines and edges must be, in plain Python on lines and edges; shares no code with the firmware's kernels.

Lines are rows of t_Line's words, in 1/16 px. Numbers are fractions and are rounded where the firmware rounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import floor

Words = Sequence[int]
Point = tuple[int, int, int]
Line3D = tuple[int, ...]
"""Start and end in mm, number of the left and of the right line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rig:
    """Focal length in 1/16 px, baseline in um, pictures in pixels."""

    focal: int
    baseline: int
    width: int
    height: int

    def point(self, x: int, y: int, disparity: int) -> Point | None:
        """The point that the left picture shows at (x, y), all in 1/16 px; None if it is nowhere or too far."""
        if disparity <= 0:
            return None
        z = rounded(Fraction(self.focal * self.baseline, 1000 * disparity))
        off_axis = (x - 8 * (self.width - 1), y - 8 * (self.height - 1))
        point = (*(rounded(Fraction(z * off, self.focal)) for off in off_axis), z)
        return point if z > 0 and max(map(abs, point)) <= 32767 else None


def rounded(number: Fraction) -> int:
    """The nearest integer, the upper one of two."""
    return floor(number + Fraction(1, 2))


def turn(a: int, b: int) -> int:
    """How far apart two 8-bit angles are."""
    return abs((a - b + 128) % 256 - 128)


def is_level(line: Words, min_rise: int) -> bool:
    """Whether a line is too near to a row."""
    x0, y0, x1, y1, *_ = line
    return y0 == y1 or abs(y1 - y0) * 256 < abs(x1 - x0) * min_rise


def column(line: Words, y: int) -> int:
    """Where a line crosses a row; the slope has twelve bits behind the point."""
    x0, y0, x1, y1, *_ = line
    slope = rounded(Fraction(4096 * (x1 - x0), y1 - y0))
    return x0 + rounded(Fraction(slope * (y - y0), 4096))


def rows(line: Words) -> tuple[int, int]:
    """Top and bottom of a line."""
    return min(line[1], line[3]), max(line[1], line[3])


def nearest(line: Words, others: Sequence[Words], angle_range: int, min_rise: int) -> int | None:
    """T §5.2.7: the nearest line across the row of the middle, of nearly the same angle."""
    x, y = (line[0] + line[2]) // 2, (line[1] + line[3]) // 2
    candidates = [
        (abs(column(other, y) - x), number)
        for number, other in enumerate(others)
        if not is_level(other, min_rise)
        and rows(other)[0] < y < rows(other)[1]
        and turn(other[4], line[4]) <= angle_range
    ]
    return min(candidates)[1] if candidates else None


def best(
    line: Words,
    others: Sequence[Words],
    side: int,
    angle_range: int,
    min_rise: int,
    disparities: tuple[int, int],
    min_common: int,
) -> int | None:
    """The line that has the most rows in common; then the one of the most similar angle, then the first."""
    y = (line[1] + line[3]) // 2
    candidates = []
    for number, other in enumerate(others):
        if is_level(other, min_rise) or turn(other[4], line[4]) > angle_range:
            continue
        disparity = side * (column(line, y) - column(other, y))
        (top, bottom), (other_top, other_bottom) = rows(line), rows(other)
        either = max(bottom, other_bottom) - min(top, other_top)
        common = max(0, min(bottom, other_bottom) - max(top, other_top))
        lacking = floor(Fraction(256 * (either - common), either))
        if disparities[0] <= disparity <= disparities[1]:
            candidates.append((256 * lacking + turn(other[4], line[4]), number))
    found = min(candidates, default=None)
    limit = 256 * (256 - min_common) + angle_range
    return found[1] if found and found[0] <= limit else None


def line_3d(rig: Rig, line: Words, other: Words) -> tuple[Point, Point] | None:
    """T Eq. 5.10 to 5.12, 3.16, 3.17."""
    ends = [rig.point(x, y, x - column(other, y)) for x, y in (line[0:2], line[2:4])]
    return (ends[0], ends[1]) if ends[0] and ends[1] else None


Edge = tuple[int, int, int]
"""x, direction, gradient."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgeLimits:
    """As in the mode of the firmware."""

    is_mutual: bool
    level_range: int
    direction_range: int
    min_disparity: int
    max_disparity: int

    def best(self, edge: Edge, others: Sequence[Edge], side: int) -> Edge | None:
        """The edge that corresponds: the nearest, or the most similar one and then the nearest."""
        x, direction, gradient = edge
        fitting = []
        for other in others:
            disparity, off = side * (x - other[0]), turn(other[1], direction)
            if (
                self.min_disparity <= disparity <= self.max_disparity
                and off <= self.direction_range
                and not self.is_level(other)
            ):
                unlike = 2 * off + abs(other[2] - gradient) if self.is_mutual else 0
                fitting.append((unlike, disparity, other))
        return min(fitting)[2] if fitting else None

    def is_level(self, edge: Edge) -> bool:
        """Whether a gradient is too near to up or down."""
        return min(turn(edge[1], 64), turn(edge[1], 192)) < self.level_range


def edges_3d(
    rig: Rig, left: Sequence[Sequence[Edge]], right: Sequence[Sequence[Edge]], limits: EdgeLimits
) -> list[tuple[int, ...]]:
    """3-D edges from the bottom row on: X, Y, Z and the number of the left edge in the store."""
    found = []
    for y in reversed(range(len(left))):
        first = sum(len(row) for row in left[:y])
        for number, edge in enumerate(left[y]):
            other = None if limits.is_level(edge) else limits.best(edge, right[y], 1)
            if other is None or (limits.is_mutual and limits.best(other, left[y], -1) != edge):
                continue
            point = rig.point(16 * edge[0], 16 * y, 16 * (edge[0] - other[0]))
            if point:
                found.append((*point, first + number))
    return found
