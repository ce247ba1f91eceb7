"""What the 3-D lines and edges must be, in plain Python on lines and edges; shares no code with the firmware's kernels.

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
Rows = Sequence[Sequence[Edge]]
Partners = Mapping[Edge, Edge]
NEVER = 65535


@dataclass(slots=True)
class Choice:
    """The best pair of an edge as pairs come in, and the score of its best rival."""

    best: int = NEVER
    partner: Edge | None = None
    rival: int = NEVER

    def see(self, score: int, partner: Edge) -> None:
        """Look at a pair. What is a pixel beside the best so far is no rival of it."""
        is_apart = self.partner is None or abs(partner[0] - self.partner[0]) > 1
        if score < self.best:
            self.rival = self.best if is_apart else self.rival
            self.best, self.partner = score, partner
        elif is_apart:
            self.rival = min(self.rival, score)


@dataclass(frozen=True, slots=True)
class Path:
    """Pairs of a row in one order, and what they are worth."""

    value: int = 0
    pairs: tuple[tuple[Edge, Edge], ...] = ()

    def with_pair(self, edge: Edge, other: Edge, score: int) -> Path:
        """With one more: a pixel of disparity from the last pair costs 4."""
        step = 0
        if self.pairs:
            before, partner = self.pairs[-1]
            step = abs(edge[0] - other[0] - (before[0] - partner[0]))
        return Path(self.value + NEVER - score - 4 * step, (*self.pairs, (edge, other)))


def path_of(left: Sequence[Edge], right: Sequence[Edge], scores: Mapping[tuple[Edge, Edge], int]) -> Path:
    """The best path of those that go on from the best ones before; of equals the one that was there first.

    `up_to[n]` is the best one to the first n right edges.
    """
    up_to = [Path()] * (len(right) + 1)
    for edge in left:
        with_edge = {
            place: up_to[place].with_pair(edge, other, scores[edge, other])
            for place, other in enumerate(right)
            if (edge, other) in scores
        }
        for place in sorted(with_edge, reverse=True):
            path = with_edge[place]
            for end in range(place + 1, len(up_to)):
                if up_to[end].value >= path.value:
                    break
                up_to[end] = path
    return up_to[-1]


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgeLimits:
    """As in the mode of the firmware."""

    is_mutual: bool
    level_range: int
    direction_range: int
    nearest_mm: int
    farthest_mm: int
    lack: int
    margin: int
    follow_range: int = 0

    def disparities(self, rig: Rig) -> range:
        """Those that are wanted."""
        least, most = (rig.disparity(depth) // 16 for depth in (self.farthest_mm, self.nearest_mm))
        return range(least + 1, most + 1)

    def unlike(self, edge: Edge, other: Edge, most: int | None = None) -> int | None:
        """How unlike two edges are; None if too much: turned by more than the range, or `most`."""
        off = turn(edge[1], other[1])
        limit = self.direction_range if most is None else most
        return 2 * off + abs(edge[2] - other[2]) if off <= limit else None

    def around(self, left: Rows, right: Rows, y: int, x: int, disparity: int) -> int:
        """How unlike the most similar pairs of this disparity are in the four rows around."""
        total = 0
        for row in (y - 2, y - 1, y + 1, y + 2):
            pairs = [
                self.unlike(edge, other)
                for edge in (left[row] if 0 <= row < len(left) else ())
                if abs(edge[0] - x) <= abs(row - y)
                for other in right[row]
                if edge[0] - other[0] == disparity
            ]
            total += min([self.lack, *(each for each in pairs if each is not None)])
        return total

    def supported(self, left: Rows, right: Rows, y: int, most: int) -> dict[Edge, Edge]:
        """The partners of left edges of a row: those of the path that are best of each other by a margin, or a pixel beside, with support."""
        lefts = {edge: Choice() for edge in left[y]}
        rights = {other: Choice() for other in right[y]}
        support, scores = {}, {}
        for edge in left[y]:
            for other in reversed(right[y]):
                disparity, own = edge[0] - other[0], self.unlike(edge, other)
                if 0 <= disparity <= most and own is not None:
                    around = self.around(left, right, y, edge[0], disparity)
                    support[edge, other] = around < 4 * self.lack
                    scores[edge, other] = own + around
                    lefts[edge].see(own + around, other)
                    rights[other].see(own + around, edge)
        found = {}
        for edge, other in path_of(left[y], right[y], scores).pairs:
            mine, theirs = lefts[edge], rights[other]
            if (
                mine.partner
                and theirs.partner
                and support[edge, mine.partner]
                and abs(mine.partner[0] - other[0]) <= 1
                and abs(theirs.partner[0] - edge[0]) <= 1
                and all(each.best + self.margin <= each.rival for each in (mine, theirs))
            ):
                found[edge] = other
        return found

    def settled(
        self, matched: Sequence[dict[Edge, Edge]], left: Rows, right: Rows, most: int
    ) -> list[Partners]:
        """The partners that two rows around believe, and of edges that follow these: from the bottom row on."""
        found = [dict(each) for each in matched]

        def beside(row: int, edge: Edge, reach: int) -> list[int]:
            """The disparities of the edges of a row that are near a column."""
            pairs = found[row].items() if 0 <= row < len(found) else ()
            return [one[0] - partner[0] for one, partner in pairs if abs(one[0] - edge[0]) <= reach]

        for y in reversed(range(len(found))):
            found[y] = {
                edge: other
                for edge, other in found[y].items()
                if sum(
                    any(abs(each - edge[0] + other[0]) <= 1 for each in beside(y + step, edge, abs(step)))
                    for step in (-2, -1, 1, 2)
                )
                >= 2
            }
            for edge in left[y]:
                if edge not in found[y]:
                    known = [each for row in (y, y + 1, y + 2) for each in beside(row, edge, 12)]
                    near = dict.fromkeys(known, 0) | {
                        each + step: 16 for each in known for step in (-1, 1) if each + step not in known
                    }
                    offers = [
                        (off + near[edge[0] - other[0]], edge[0] - other[0], other)
                        for other in right[y]
                        if edge[0] - other[0] in near.keys() & set(range(most + 1))
                        and other not in found[y].values()
                        and (off := self.unlike(edge, other, self.follow_range)) is not None
                    ]
                    if offers:
                        found[y][edge] = min(offers)[2]
        return [dict(sorted(each.items())) for each in found]

    def nearest(self, left: Sequence[Edge], right: Sequence[Edge], wanted: range) -> dict[Edge, Edge]:
        """T §5.2.8: the partners with the least disparity."""
        found = {}
        for edge in left:
            fitting = [
                (edge[0] - other[0], other)
                for other in right
                if edge[0] - other[0] in wanted and self.unlike(edge, other) is not None
            ]
            if fitting:
                found[edge] = min(fitting)[1]
        return found

    def is_level(self, edge: Edge) -> bool:
        """Whether a gradient is too near to up or down."""
        return min(turn(edge[1], 64), turn(edge[1], 192)) < self.level_range


def partners_of(rig: Rig, left: Rows, right: Rows, limits: EdgeLimits) -> list[Partners]:
    """The left edges of each row that have a partner, and that."""
    wanted = limits.disparities(rig)
    steep = [[[edge for edge in row if not limits.is_level(edge)] for row in rows] for rows in (left, right)]
    if limits.is_mutual:
        matched = [limits.supported(*steep, y, wanted.stop - 1) for y in range(len(left))]
        return limits.settled(matched, *steep, wanted.stop - 1)
    return [limits.nearest(*pair, wanted) for pair in zip(*steep, strict=True)]


def edges_3d(rig: Rig, left: Rows, right: Rows, limits: EdgeLimits) -> list[tuple[int, ...]]:
    """3-D edges from the bottom row on: X, Y, Z and the number of the left edge in the store."""
    found = []
    wanted = limits.disparities(rig)
    for y, partners in reversed([*enumerate(partners_of(rig, left, right, limits))]):
        first = sum(len(row) for row in left[:y])
        for edge, other in partners.items():
            point = rig.point(16 * edge[0], 16 * y, 16 * (edge[0] - other[0]))
            if point and edge[0] - other[0] in wanted:
                found.append((*point, first + left[y].index(edge)))
    return found


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
