"""What the circle detection must find, in whole numbers of any size and in plain Python; shares no code with the firmware.

Points and vectors are (x, y); patches and pictures are indexed [y, x].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isqrt, pi, tan
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from tests.firmware import references
from tests.firmware.circles.circle_fit_references import (
    FINE,
    Breadth,
    Bulge,
    Circle,
    Point,
    arc,
    bulge_of,
    distance,
    settled,
    weights,
    without_blur,
)

Picture = NDArray[Any]
Edge = tuple[int, int, int]  # x, y, direction


def turn(angle: int, reference: int) -> int:
    """The 8-bit angle from one to another, without a sign."""
    return min((angle - reference) % 256, (reference - angle) % 256)


def selected(
    edges: Sequence[Edge],
    opened: Picture,
    colours: int,
    box: tuple[int, int, int, int],
    mass: Point,
    angle_range: int,
    beside_colour: bool,
) -> tuple[list[Edge], list[bool], int]:
    """The edges in a box (left, right, top, bottom) that pass both filters, which look away, and how many pass the first one."""
    coloured = (opened & colours != 0).astype(np.uint32)
    covered = references.erode(coloured) != 0
    around = np.pad(coloured, ((1, 1), (2, 2)), mode="edge")
    near = sliding_window_view(around, (3, 5)).any(axis=(2, 3))
    left, right, top, bottom = box
    kept, away, bordering = [], [], 0
    for x, y, direction in edges:
        within = left <= x <= right and top <= y <= bottom
        if within and not covered[y, x]:
            bordering += 1
            to_mass = int(references.angle(np.array([mass[0] - x]), np.array([mass[1] - y]))[0])
            off = turn(direction, to_mass)
            if off <= angle_range or (off >= 128 - angle_range and (near[y, x] or not beside_colour)):
                kept.append((x, y, direction))
                away.append(off > angle_range)
    return kept, away, bordering


def agreeing_on_side(edges: Sequence[Edge], away: Sequence[bool], mass: Point, reach: int) -> list[Edge]:
    """The edges without those that look another way than most, unless three quarters of these are near the circle of all."""
    side = 2 * sum(away) > len(edges)
    others = [edge for edge, each in zip(edges, away, strict=True) if each != side]
    if not others:
        return list(edges)
    circle, _ = consensus(edges, mass, reach, None)
    if circle and circle[2] > 0 and 4 * sum(is_near(each, circle) for each in others) >= 3 * len(others):
        return list(edges)
    return [edge for edge, each in zip(edges, away, strict=True) if each == side]


def is_steep(direction: int) -> bool:
    """Whether the line along a gradient is nearer to the y axis; a diagonal goes to the axis before it."""
    return direction % 128 in range(32, 96)


def slope(direction: int) -> int:
    """Tangent of the angle against the nearer axis in 1/4096, rounded, halves away from 0."""
    off = 64 - direction % 128 if is_steep(direction) else (direction + 64) % 128 - 64
    size = int(tan(abs(off) * pi / 128) * 4096 + 0.5)
    return size if off > 0 else -size


def votes(edges: Sequence[Edge], mass: Point, reach: int) -> Picture:
    """The patch of (2 reach + 1) cells square with a line for each edge."""
    patch = np.zeros((2 * reach + 1, 2 * reach + 1), int)
    for edge_x, edge_y, direction in edges:
        x, y = edge_x - mass[0] + reach, edge_y - mass[1] + reach
        for along in range(2 * reach + 1):
            if is_steep(direction):
                row, column = along, (x * 4096 + slope(direction) * (along - y) + 2048) // 4096
            else:
                row, column = (y * 4096 + slope(direction) * (along - x) + 2048) // 4096, along
            if 0 <= row <= 2 * reach and 0 <= column <= 2 * reach:
                patch[row, column] += 1
    return patch


def peak(patch: Picture, reach: int) -> tuple[int, int, int]:
    """Row and column of the middle of the square with the most votes, the first one, and their number."""
    sums = sliding_window_view(patch, (2 * reach + 1, 2 * reach + 1)).sum(axis=(2, 3))
    row, column = (int(each) for each in np.unravel_index(sums.argmax(), sums.shape))
    if sums.max() == 0:
        row = column = patch.shape[0] // 2 - reach
    return row + reach, column + reach, int(sums.max())


def mean_offset(values: Sequence[int]) -> int:
    """The mean place of values round the middle one, in 1/64, rounded."""
    middle = len(values) // 2
    moment = sum((place - middle) * value for place, value in enumerate(values))
    return (2 * FINE * moment + sum(values)) // (2 * sum(values))


def histogram(edges: Sequence[Edge], centre: Point, bins: int) -> list[int]:
    """How many edges lie at each distance in pixels."""
    counts = [0] * bins
    for x, y, _ in edges:
        radius = (distance((FINE * x, FINE * y), centre) + FINE // 2) // FINE
        if radius < bins:
            counts[radius] += 1
    return counts


def radius_peak(counts: Sequence[int], reach: int) -> tuple[int, int, int]:
    """The middle of the bins with the most edges, their number, and the mean radius in 1/64 px."""
    wide = [0] * reach + list(counts) + [0] * reach
    sums = [sum(wide[each : each + 2 * reach + 1]) for each in range(len(counts))]
    radius = sums.index(max(sums))
    if max(sums) == 0:
        return 0, 0, 0
    return radius, max(sums), FINE * radius + mean_offset(wide[radius : radius + 2 * reach + 1])


def outline_offset(profile: Sequence[int]) -> tuple[int, int, Breadth]:
    """Where the outline crosses a profile, in 1/64 px from its middle, how steep it is and how broad; 7 values before, 8 behind."""
    rises = [int(after) - int(before) for before, after in pairwise(profile)]
    place = max(
        range(5, 9), key=lambda each: sum(rises[each - 1 : each + 2]) + rises[each]
    )  # of equal ones the first
    before, after = (
        next((each for each in (1, 2, 3) if 2 * rises[place + way * each] <= rises[place]), 4)
        for way in (-1, 1)
    )
    dark, bright = max(rises[place - before - 1], 0), max(rises[place + after + 1], 0)
    steps = range(-before, after + 1)
    slopes = [dark if step < 0 else bright if step > 0 else (dark + bright) // 2 for step in steps]
    parts = [max(rises[place + step] - slope, 0) for step, slope in zip(steps, slopes, strict=True)]
    moment = sum(step * part for step, part in zip(steps, parts, strict=True))
    aside = (2 * FINE * moment + sum(parts)) // (2 * sum(parts)) if sum(parts) else 0
    ends = [dark * (before + 1) if step < 0 else bright * (after + 1) for step in steps]
    square = sum(
        abs(step) * (abs(step) * rises[place + step] - end) for step, end in zip(steps, ends, strict=True)
    )
    return (
        FINE * (place - 7) + FINE // 2 + aside,
        max(rises[place], 0),
        (sum(parts), max(square, 0)),
    )


def point_of(edge: Edge, luma: Picture) -> tuple[Point, int, Breadth]:
    """The point on the outline at an edge, in 1/64 px, and how steep and broad the outline is there."""
    x, y, direction = edge
    steep = is_steep(direction)
    way = (1 if direction < 128 else -1) if steep else (1 if direction < 64 or direction >= 192 else -1)
    steps = way * np.arange(-7, 9)
    height, width = luma.shape
    profile = (
        luma[np.clip(y + steps, 0, height - 1), x] if steep else luma[y, np.clip(x + steps, 0, width - 1)]
    )
    offset, *how = outline_offset(profile.tolist())
    if steep:
        return (FINE * x, max(FINE * y + way * offset, 0)), *how
    return (max(FINE * x + way * offset, 0), FINE * y), *how


def breadths(outline: Sequence[tuple[Point, int, Breadth]]) -> Breadth:
    """The sums of the breadths of points, each times how steep the outline is there."""
    return (
        sum(steep * whole for _, steep, (whole, _) in outline),
        sum(steep * square for _, steep, (_, square) in outline),
    )


def near_of(radius: int) -> int:
    """How far from a circle its points may be: a pixel or a sixteenth of its radius."""
    return max(FINE, radius // 16)


def is_near(edge: Edge, circle: Circle) -> bool:
    """Whether an edge is near a circle."""
    x, y, radius = circle
    near = near_of(radius)
    off = (FINE * edge[0] - x) ** 2 + (FINE * edge[1] - y) ** 2
    return max(radius - near, 0) ** 2 <= off <= (radius + near) ** 2


def consensus(
    edges: Sequence[Edge], mass: Point, reach: int, start: Circle | None
) -> tuple[Circle | None, int]:
    """The circle that most edges agree on, from one to begin with and those through 48 triples, and their share in 1/256."""
    judges = edges[:: -(-len(edges) // 64)]

    def share(circle: Circle) -> int:
        return 256 * sum(is_near(each, circle) for each in judges) // len(judges)

    best = (share(start), start) if start and start[2] > 0 else (0, None)
    count = len(edges)
    for number in range(48):
        first = number * count // 48
        second, third = (first + count // 3 + number) % count, (first + 2 * count // 3 + 3 * number) % count
        found = through(*(edges[each][:2] for each in (first, second, third)))
        if found and all(
            abs(each // FINE - middle) <= reach for each, middle in zip(found, mass, strict=False)
        ):
            best = max(best, (share(found), found), key=lambda each: each[0])
    return best[1], best[0]


def through(one: Point, two: Point, three: Point) -> Circle | None:
    """The circle through three points of whole pixels, rounded down from the first one on; none if they lie on a line."""
    (x2, y2), (x3, y3) = ((each[0] - one[0], each[1] - one[1]) for each in (two, three))
    twice = 2 * (x2 * y3 - y2 * x3)
    if twice == 0:
        return None
    right = y3 * (x2**2 + y2**2) - y2 * (x3**2 + y3**2)
    down = x2 * (x3**2 + y3**2) - x3 * (x2**2 + y2**2)
    dx, dy = (FINE * each // twice for each in (right, down))
    return FINE * one[0] + dx, FINE * one[1] + dy, isqrt(dx**2 + dy**2)


def middle(span: tuple[int, int], chord: int, pixels: int, mass: int) -> int:
    """Where the middle of a disc is along an axis: beyond the border that leaves less than half of it, by its height over the chord."""
    first, last = span
    seen = last - first + 1
    before, behind = first <= 1, last >= pixels - 2
    if before == behind or not chord / 7 <= seen < chord / 2:
        return mass
    radius = (chord**2 + 4 * seen**2) // (8 * seen)
    return last - radius if before else first + radius


@dataclass(frozen=True, slots=True)
class Blob:
    """What the stage wants of a blob's record."""

    colours: int
    pixels: int
    sums: Point
    box: tuple[int, int, int, int]
    mass: Point

    @classmethod
    def of(cls, words: Sequence[int]) -> Blob:
        """Read the eight words of a t_Blob."""
        colours, pixels, sum_x, sum_y, across, down, _, centre = words
        box = across & 0xFFFF, across >> 16, down & 0xFFFF, down >> 16
        return cls(colours, pixels, (sum_x, sum_y), box, (centre & 0xFFFF, centre >> 16))


def circle(
    number: int,
    blob: Blob,
    edges: Sequence[Edge],
    opened: Picture,
    luma: Picture,
    colours: int,
    limits: Any,
    focal_px: int,
) -> list[int]:
    """The words of the circle of blob `number`; `limits` are the stage's thresholds."""
    height, width = opened.shape
    left, right, top, bottom = blob.box
    wide = (
        max(left - limits.border, 0),
        min(right + limits.border, width - 1),
        max(top - limits.border, 0),
        min(bottom + limits.border, height - 1),
    )
    mass = (
        middle((left, right), bottom - top + 1, width, blob.mass[0]),
        middle((top, bottom), right - left + 1, height, blob.mass[1]),
    )
    found, away, bordering = selected(
        edges, opened, colours, wide, mass, limits.angle_range, limits.beside_colour
    )
    found = found[: 3 * width]
    reach = min((max(right - left, bottom - top) + 1) // 2, limits.patch_reach)
    if limits.fit_rounds:
        found = agreeing_on_side(found, away[: 3 * width], mass, reach)
    record = [(32 * each + blob.pixels) // (2 * blob.pixels) for each in blob.sums]
    record += [0, number, len(found), 0, 0, 0, 0]
    if len(found) < max(limits.min_edges, 1):
        return record
    around = min(limits.peak_reach, reach)
    patch = votes(found, mass, reach)
    row, column, size = peak(patch, around)
    record[5] = min(256 * size // (len(found) * (2 * around + 1)), 255)
    found_circle = None
    if size and record[5] >= limits.centre_share:
        square = patch[row - around : row + around + 1, column - around : column + around + 1]
        x = FINE * (mass[0] - reach + column) + mean_offset(square.sum(axis=0).tolist())
        y = FINE * (mass[1] - reach + row) + mean_offset(square.sum(axis=1).tolist())
        record[7] = 1
        _, size, radius = radius_peak(histogram(found, (x, y), width), limits.peak_reach)
        record[6] = min(256 * size // len(found), 255)
        if size and size >= limits.min_peak and record[6] >= limits.radius_share:
            record[7] = 3
            found_circle = x, y, radius
        record[:3] = [(each + 2) // 4 for each in (x, y, radius)]
    if not limits.fit_rounds:
        return record
    agreed, share = consensus(found, mass, reach, found_circle)
    share = share * len(found) // bordering
    if agreed is None or (record[7] != 3 and share <= limits.consensus_share):
        return record
    record[7] = 3
    fitted, arc_seen = fit(agreed, found, luma, limits, bulge_of(agreed, focal_px, (width, height)))
    return [*((each + 2) // 4 for each in fitted), *record[3:8], arc_seen]


def fit(
    circle: Circle, edges: Sequence[Edge], luma: Picture, limits: Any, bulge: Bulge
) -> tuple[Circle, int]:
    """The circle that fits the outline at the edges near one, and how much of it is seen."""
    x, y, radius = circle
    limit = FINE * limits.fit_range
    away = [distance((FINE * edge[0], FINE * edge[1]), (x, y)) for edge in edges]
    close = [edge for edge, each in zip(edges, away, strict=True) if abs(each - radius) <= limit]
    outline = [point_of(edge, luma) for edge in close]
    points = [point for point, *_ in outline]
    counts = weights([steep for _, steep, _ in outline])
    circle = settled(circle, points, counts, limit, limits.fit_rounds, bulge)
    circle = without_blur(circle, breadths(outline))
    return circle, arc(circle, points, bulge)
