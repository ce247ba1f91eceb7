"""What the 3-D edges must be, in plain Python on edges; shares no code with the firmware's kernels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from tests.firmware.stereo.stereo_references import Edge, Partners, Rig, rounded, turn

Rows = Sequence[Sequence[Edge]]
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


BEYOND = 16383
"""What a path gains by each edge that lies beyond the other picture's border."""


def path_of(
    left: Sequence[Edge], right: Sequence[Edge], scores: Mapping[tuple[Edge, Edge], int], width: int
) -> Path:
    """The best path of those that begin or go on from the best ones before; of equals the one that was there first.

    `up_to[n]` is the best one to the first n right edges, without what lies beyond its end.
    """
    up_to = [Path()] * (len(right) + 1)
    whole, most = Path(), 0
    for edge in left:
        with_edge = {}
        for place, other in enumerate(right):
            if (edge, other) in scores:
                begun = Path(BEYOND * sum(each[0] < edge[0] - other[0] for each in left))
                ways = [each.with_pair(edge, other, scores[edge, other]) for each in (begun, up_to[place])]
                with_edge[place] = max(ways, key=lambda each: each.value)
        for place in sorted(with_edge, reverse=True):
            path = with_edge[place]
            unseen = sum(each[0] + edge[0] - right[place][0] >= width for each in right)
            if path.value + BEYOND * unseen > most:
                whole, most = path, path.value + BEYOND * unseen
            for end in range(place + 1, len(up_to)):
                if up_to[end].value >= path.value:
                    break
                up_to[end] = path
    return whole


AROUND = (-2, -1, 1, 2)


@dataclass(frozen=True, slots=True)
class Pairs:
    """The left edges of a row that have a partner, and that: sure, or only on the path."""

    sure: dict[Edge, Edge] = field(default_factory=dict)
    unsure: dict[Edge, Edge] = field(default_factory=dict)

    def near(self, edge: Edge, reach: int) -> list[int]:
        """The sure disparities of the edges near a column."""
        return [one[0] - its[0] for one, its in self.sure.items() if abs(one[0] - edge[0]) <= reach]

    def likes(self, edge: Edge, other: Edge, reach: int) -> list[int]:
        """The disparities, sure or not, of the edges near a column that are that of a pair, to a pixel; from left to right."""
        every = Pairs(dict(sorted((self.sure | self.unsure).items())))
        return [each for each in every.near(edge, reach) if abs(each - edge[0] + other[0]) <= 1]

    def keep_believed(self, around: Mapping[int, Pairs]) -> None:
        """Leave out the sure pairs that are like no sure ones in two of the rows around."""
        for edge, other in [*self.sure.items()]:
            believers = [
                away for away, row in around.items() if Pairs(row.sure).likes(edge, other, abs(away))
            ]
            if len(believers) < 2:
                del self.sure[edge]

    def believe_beside(self, edges: Sequence[Edge], around: Mapping[int, Pairs]) -> None:
        """Make pairs sure that all rows around have and the last sure edge before, going through the row."""
        last = None
        for edge in edges:
            other = self.unsure.get(edge)
            if (
                other
                and last is not None
                and abs(edge[0] - other[0] - last) <= 1
                and other not in self.sure.values()
                and len(around) == len(AROUND)
                and all(row.likes(edge, other, abs(away)) for away, row in around.items())
            ):
                self.sure[edge] = self.unsure.pop(edge)
            if edge in self.sure:
                last = edge[0] - self.sure[edge][0]


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

    def supported(self, left: Rows, right: Rows, y: int, most: int, width: int) -> Pairs:
        """The partners of left edges of a row on its path: sure if best of each other by a margin, or a pixel beside, with support."""
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
        pairs = Pairs()
        for edge, other in path_of(left[y], right[y], scores, width).pairs:
            mine, theirs = lefts[edge], rights[other]
            is_sure = (
                mine.partner
                and theirs.partner
                and support[edge, mine.partner]
                and abs(mine.partner[0] - other[0]) <= 1
                and abs(theirs.partner[0] - edge[0]) <= 1
                and all(each.best + self.margin <= each.rival for each in (mine, theirs))
            )
            (pairs.sure if is_sure else pairs.unsure)[edge] = other
        return pairs

    def settled(self, matched: Sequence[Pairs], left: Rows, right: Rows, most: int) -> list[Pairs]:
        """The pairs of each row when the rows around have had their say, from the bottom row on."""
        rows = [Pairs(dict(each.sure), dict(each.unsure)) for each in matched]
        for y in reversed(range(len(rows))):
            around = {away: rows[y + away] for away in AROUND if 0 <= y + away < len(rows)}
            rows[y].keep_believed(around)
            for edges in (left[y], left[y][::-1]):
                rows[y].believe_beside(edges, around)
            for edge in left[y]:
                if edge not in rows[y].sure:
                    self.follow(edge, right[y], rows[y : y + 3], most)
        return [Pairs(dict(sorted(each.sure.items())), each.unsure) for each in rows]

    def follow(self, edge: Edge, others: Sequence[Edge], rows: Sequence[Pairs], most: int) -> None:
        """Give an edge of the first row the most similar of its right edges at the disparities near it in all rows."""
        pairs = rows[0]
        known = [each for row in rows for each in row.near(edge, 12)]
        near = dict.fromkeys(known, 0) | {
            each + step: 16 for each in known for step in (-1, 1) if each + step not in known
        }
        offers = [
            (off + near[edge[0] - other[0]], edge[0] - other[0], other)
            for other in others
            if edge[0] - other[0] in near.keys() & set(range(most + 1))
            and other not in pairs.sure.values()
            and (off := self.unlike(edge, other, self.follow_range)) is not None
        ]
        if offers:
            pairs.sure[edge] = min(offers)[2]
            pairs.unsure.pop(edge, None)

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


def pairs_of(rig: Rig, left: Rows, right: Rows, limits: EdgeLimits) -> tuple[list[Pairs], list[Pairs]]:
    """The pairs of each row: as they match, and as they are settled."""
    wanted = limits.disparities(rig)
    steep = [[[edge for edge in row if not limits.is_level(edge)] for row in rows] for rows in (left, right)]
    if limits.is_mutual:
        matched = [limits.supported(*steep, y, wanted.stop - 1, rig.width) for y in range(len(left))]
        return matched, limits.settled(matched, *steep, wanted.stop - 1)
    nearest = [Pairs(limits.nearest(*pair, wanted)) for pair in zip(*steep, strict=True)]
    return nearest, nearest


def partners_of(rig: Rig, left: Rows, right: Rows, limits: EdgeLimits) -> list[Partners]:
    """The left edges of each row that have a partner in the end, and that."""
    return [each.sure for each in pairs_of(rig, left, right, limits)[1]]


def mean_disparity(edge: Edge, other: Edge, around: Mapping[int, Pairs]) -> int:
    """The mean of a pair's disparity and of the first like it in each row around, so many rows away; in 1/16 px."""
    likes = [edge[0] - other[0]]
    for away, pairs in around.items():
        likes += pairs.likes(edge, other, abs(away))[:1]
    return rounded(Fraction(16 * sum(likes), len(likes)))


def edges_3d(rig: Rig, left: Rows, right: Rows, limits: EdgeLimits) -> list[tuple[int, ...]]:
    """3-D edges from the bottom row on: X, Y, Z and the number of the left edge in the store."""
    found = []
    farthest = rig.disparity(limits.farthest_mm)
    matched, settled = pairs_of(rig, left, right, limits)
    for y, pairs in reversed([*enumerate(settled)]):
        first = sum(len(row) for row in left[:y])
        around = {
            away: (settled if away > 0 else matched)[y + away]
            for away in AROUND
            if limits.is_mutual and 0 <= y + away < len(left)
        }
        for edge, other in pairs.sure.items():
            disparity = mean_disparity(edge, other, around)
            point = rig.point(16 * edge[0], 16 * y, disparity)
            if point and disparity > farthest:
                found.append((*point, first + left[y].index(edge)))
    return found
