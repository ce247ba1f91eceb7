"""What the 3-D lines must be, in plain Python; shares no code with the firmware's kernels. Edges: `stereo_edge_references.py`.

Lines are rows of t_Line's words, in 1/16 px. Numbers are fractions and are rounded where the firmware rounds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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

    def disparity(self, depth: int) -> int:
        """The disparity of what is so many mm away, in 1/16 px."""
        return rounded(Fraction(self.focal * self.baseline, 1000 * depth))


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
Partners = Mapping[Edge, Edge]


def elected(
    lines_3d: Sequence[Line3D],
    lefts: Sequence[Words],
    rights: Sequence[Words],
    partners: Sequence[Partners],
    edge_range: int,
) -> list[Line3D]:
    """The 3-D lines that more edges are for than against; `partners` are those of each row."""

    def majority(line: Words, other: Words) -> int:
        top, bottom = rows(line)
        votes = [
            abs(16 * (edge[0] - own[0]) - column(line, 16 * y) + column(other, 16 * y)) <= edge_range
            for y, pairs in enumerate(partners)
            if top <= 16 * y <= bottom
            for edge, own in pairs.items()
            if abs(16 * edge[0] - column(line, 16 * y)) <= edge_range
        ]
        return sum(1 if each else -1 for each in votes)

    return [each for each in lines_3d if majority(lefts[each[6]], rights[each[7]]) > 0]
