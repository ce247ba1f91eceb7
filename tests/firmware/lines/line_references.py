"""What the line detection must find, in plain Python on lists of edges; shares no code with the firmware.

A picture's edges are rows of (x, direction), from left to right. Means are fractions, and sums have no width.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import floor

Row = Sequence[tuple[int, int]]
Point = tuple[int, int]


@dataclass(slots=True, kw_only=True)
class Thresholds:
    """As in the mode of the firmware."""

    angle_range: int = 16
    mean_edges: int = 8
    min_length: int = 8
    near_angle: int = 8
    near_gap: int = 4
    muff_range: int = 4
    far_gap: int = 24


@dataclass(slots=True, eq=False)
class Segment:
    """Its edges with their turns from the first one's direction, its outermost ones, and where it is kept."""

    place: int
    direction: int
    start: Point
    end: Point
    points: list[Point] = field(default_factory=list)
    turns: list[int] = field(default_factory=list)

    @property
    def is_flat(self) -> bool:
        """Whether the gradient of its first edge looks more up or down than to a side."""
        return 32 <= self.direction % 128 < 96

    @property
    def length(self) -> int:
        """Its edges, or the pixels from start to end if these are fewer."""
        sides = (abs(a - b) for a, b in zip(self.start, self.end, strict=True))
        return min(len(self.points), max(sides) + 1)

    def mean(self, edges: int) -> Fraction:
        """Mean direction of its first edges."""
        first = self.turns[:edges]
        return self.direction + Fraction(sum(first), len(first))


def turn(angle: int | Fraction, reference: int | Fraction) -> int | Fraction:
    """How far the reference turns to the angle, -128 to 128."""
    return (angle - reference + 128) % 256 - 128


def runs(row: Row, wanted: Thresholds) -> list[Row]:
    """Cut a row into edges that lie side by side and keep to the mean of the run's first ones."""
    found: list[list[tuple[int, int]]] = []
    for x, direction in row:
        if found and found[-1][-1][0] == x - 1:
            first = found[-1][0][1]
            turns = [turn(each, first) for _, each in found[-1][: wanted.mean_edges]]
            if abs(turn(direction, first) - Fraction(sum(turns), len(turns))) <= wanted.angle_range:
                found[-1].append((x, direction))
                continue
        found.append([(x, direction)])
    return found


@dataclass(slots=True)
class Scan:
    """Segments by their places, and the edges that had no place."""

    places: list[Segment | None]
    unplaced: int = 0


def scan(rows: Sequence[Row], capacity: int, wanted: Thresholds) -> Scan:
    """Collect segments row by row. Places are taken from a stack and given back by segments that end too short."""
    result = Scan([None] * capacity)
    free = list(reversed(range(capacity)))
    above: dict[int, Segment] = {}
    for y, row in enumerate(rows):
        here: dict[int, Segment] = {}
        for run in runs(row, wanted):
            segment = _touched(run, above, wanted)
            if segment is None and free:
                x, direction = run[0]
                segment = Segment(free.pop(), direction, (x, y), (x, y))
                result.places[segment.place] = segment
            if segment is None:
                result.unplaced += len(run)
                continue
            for x, direction in run:
                _add(segment, x, y, direction)
                here[x] = segment
        for x in sorted(above):
            old = above[x]
            ended = old not in here.values() and result.places[old.place] is old
            if ended and old.length < wanted.min_length:
                result.places[old.place] = None
                free.append(old.place)
        above = here
    return result


def _touched(run: Row, above: dict[int, Segment], wanted: Thresholds) -> Segment | None:
    """The first segment above a run, or beside that by one, whose mean direction is the run's."""
    first = run[0][1]
    turns = [turn(direction, first) for _, direction in run[: wanted.mean_edges]]
    for x in range(run[0][0] - 1, run[-1][0] + 2):
        if x in above:
            segment = above[x]
            own = turn(first, segment.direction) + Fraction(sum(turns), len(turns))
            theirs = segment.mean(wanted.mean_edges) - segment.direction
            if abs(own - theirs) <= wanted.angle_range:
                return segment
    return None


def _add(segment: Segment, x: int, y: int, direction: int) -> None:
    """Add an edge; flat segments end at their leftmost and rightmost edge, others at their first and last."""
    segment.points.append((x, y))
    segment.turns.append(int(turn(direction, segment.direction)))
    if not segment.is_flat or x > segment.end[0]:
        segment.end = (x, y)
    if segment.is_flat and x < segment.start[0]:
        segment.start = (x, y)


@dataclass(slots=True, eq=False)
class Kept:
    """A segment with its bright side on the left."""

    points: list[Point]
    start: Point
    end: Point
    direction: int


def keep(places: Sequence[Segment | None], wanted: Thresholds) -> list[Kept]:
    """Take what is long enough, orient it and round its mean direction."""
    kept = []
    for segment in places:
        if segment is not None and segment.length >= wanted.min_length:
            ends = [segment.start, segment.end]
            # what was collected to the right must be bright above, what was collected downwards bright on the right
            bright = 192 if segment.is_flat else 0
            if not -32 <= turn(segment.direction, bright) < 32:
                ends.reverse()
            mean = floor(segment.mean(wanted.mean_edges) + Fraction(1, 2)) % 256
            kept.append(Kept(segment.points, *ends, mean))
    return kept


def gap(first: Kept, second: Kept) -> int:
    """Chessboard distance from an end to a start."""
    return max(abs(a - b) for a, b in zip(first.end, second.start, strict=True))


def is_ahead(first: Kept, second: Kept) -> bool:
    """Whether the second goes on beyond the end of the first."""
    way = [end - start for start, end in zip(first.start, first.end, strict=True)]
    further = [b - a for a, b in zip(first.end, second.end, strict=True)]
    return sum(a * b for a, b in zip(way, further, strict=True)) > 0


def connect(segments: list[Kept], fits, max_gap: int) -> list[Kept]:
    """Join each with the nearest one ahead that `fits`; the last takes the place of one that was joined."""
    segments, first = list(segments), 0
    while first < len(segments):
        one = segments[first]
        near = [
            (gap(one, other), number)
            for number, other in enumerate(segments)
            if other is not one and gap(one, other) <= max_gap and is_ahead(one, other) and fits(one, other)
        ]
        if not near:
            first += 1
            continue
        best = min(near)[1]
        other = segments[best]
        direction = other.direction if len(other.points) > len(one.points) else one.direction
        segments[first] = Kept(one.points + other.points, one.start, other.end, direction)
        last = segments.pop()
        if best < len(segments):
            segments[best] = last
        if first == len(segments):
            first = best
    return segments


def spread(a: Sequence[int], b: Sequence[int]) -> int:
    """Covariance times number, rounded up."""
    return sum(x * y for x, y in zip(a, b, strict=True)) - sum(a) * sum(b) // len(a)


def fit(segment: Kept) -> tuple[int, int, int, int]:
    """Ends of the least-squares line in sixteenths of a pixel: the outermost edges' feet and half a pixel more."""
    sums = list(zip(*segment.points, strict=True))
    axis = 0 if spread(sums[0], sums[0]) >= spread(sums[1], sums[1]) else 1
    along, across = sums[axis], sums[1 - axis]
    run, rise = spread(along, along), spread(along, across)
    while run >= 2**18:
        run, rise = run // 2, rise // 2
    slope = 4096 * rise // run if run else 0
    middle = [(16 * sum(each) + len(each) // 2) // len(each) for each in (along, across)]
    length = 4096 + slope * slope // 4096
    feet = []
    for point in (segment.start, segment.end):
        off = 16 * point[axis] - middle[0], 16 * point[1 - axis] - middle[1]
        feet.append((4096 * off[0] + slope * off[1] + length // 2) // length)
    reach = 8 if feet[0] <= feet[1] else -8
    ends: list[int] = []
    for foot in (feet[0] - reach, feet[1] + reach):
        place = middle[0] + foot, middle[1] + foot * slope // 4096
        ends += place if axis == 0 else place[::-1]
    return ends[0], ends[1], ends[2], ends[3]


def border(x: int, y: int, dx: int, dy: int, size: tuple[int, int]) -> int:
    """Where on the border, clockwise in pixels, the way from (x, y) in direction (dx, dy) meets it first."""
    right, bottom = 16 * (size[0] - 1), 16 * (size[1] - 1)
    room_x = max(right - x if dx > 0 else x, 0)
    room_y = max(bottom - y if dy > 0 else y, 0)
    if room_x * abs(dy) <= room_y * abs(dx):
        y += room_x * dy // abs(dx) if dx else 0
        place = right + y if dx > 0 else 2 * right + 2 * bottom - y
    else:
        x += room_y * dx // abs(dy)
        place = 2 * right + bottom - x if dy > 0 else x
    return place // 16


def muff(segment: Kept, size: tuple[int, int]) -> tuple[int, int]:
    """Where the line comes from and where it goes to."""
    x0, y0, x1, y1 = fit(segment)
    return border(x0, y0, x0 - x1, y0 - y1, size), border(x1, y1, x1 - x0, y1 - y0, size)


def record(segment: Kept, size: tuple[int, int], angle) -> list[int]:
    """The words of a line: ends, angle, edges, probability, Muff parameters."""
    x0, y0, x1, y1 = fit(segment)
    pixels = (max(abs(x1 - x0), abs(y1 - y0)) + 8) // 16
    edges = len(segment.points)
    return [
        *(x0, y0, x1, y1),
        angle(x1 - x0, y1 - y0),
        edges,
        min(256 * edges // pixels, 255),
        *muff(segment, size),
    ]


def lines(
    rows: Sequence[Row], size: tuple[int, int], capacity: int, wanted: Thresholds, angle
) -> tuple[list[list[int]], int]:
    """All lines of a picture, and the edges that were lost."""
    scanned = scan(rows, capacity, wanted)
    kept = keep(scanned.places, wanted)

    def alike(one: Kept, other: Kept) -> bool:
        return abs(turn(other.direction, one.direction)) <= wanted.near_angle

    def on_one_line(one: Kept, other: Kept) -> bool:
        perimeter = 2 * (size[0] + size[1] - 2)
        apart = [abs(a - b) for a, b in zip(muff(one, size), muff(other, size), strict=True)]
        return max(min(each, perimeter - each) for each in apart) <= wanted.muff_range

    near = connect(kept, alike, wanted.near_gap)
    far = connect(near, on_one_line, wanted.far_gap)
    return [record(each, size, angle) for each in far], scanned.unplaced
