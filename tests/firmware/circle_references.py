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

Picture = NDArray[Any]
Edge = tuple[int, int, int]  # x, y, direction
Point = tuple[int, int]

FINE = 64


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
    dark_too: bool,
) -> list[Edge]:
    """The edges in a box (left, right, top, bottom) that pass both filters."""
    covered = references.erode((opened & colours != 0).astype(np.uint32)) != 0
    left, right, top, bottom = box
    kept = []
    for x, y, direction in edges:
        if left <= x <= right and top <= y <= bottom and not covered[y, x]:
            to_mass = int(references.angle(np.array([mass[0] - x]), np.array([mass[1] - y]))[0])
            off = turn(direction, to_mass)
            if off <= angle_range or (dark_too and off >= 128 - angle_range):
                kept.append((x, y, direction))
    return kept


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


def distance(point: Point, centre: Point) -> int:
    """Rounded down."""
    return isqrt((point[0] - centre[0]) ** 2 + (point[1] - centre[1]) ** 2)


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


def outline_offset(profile: Sequence[int]) -> int:
    """Where the greatest step of a profile lies, in 1/64 px from its middle, slopes taken off; 4 values before, 5 behind."""
    rises = [int(after) - int(before) for before, after in pairwise(profile)]
    place = max(range(2, 6), key=lambda each: rises[each])  # of equal ones the first
    dark, before, middle, after, bright = rises[place - 2 : place + 3]
    dark, bright = max(dark, 0), max(bright, 0)
    before, after = max(before - dark, 0), max(after - bright, 0)
    whole = before + after + max(middle - (dark + bright) // 2, 0)
    aside = (2 * FINE * (after - before) + whole) // (2 * whole) if whole else 0
    return FINE * (place - 4) + FINE // 2 + aside


def point_of(edge: Edge, luma: Picture) -> Point:
    """The point on the outline at an edge, in 1/64 px."""
    x, y, direction = edge
    steep = is_steep(direction)
    way = (1 if direction < 128 else -1) if steep else (1 if direction < 64 or direction >= 192 else -1)
    steps = way * np.arange(-4, 6)
    height, width = luma.shape
    if steep:
        profile = luma[np.clip(y + steps, 0, height - 1), x]
        return FINE * x, max(FINE * y + way * outline_offset(profile.tolist()), 0)
    profile = luma[y, np.clip(x + steps, 0, width - 1)]
    return max(FINE * x + way * outline_offset(profile.tolist()), 0), FINE * y


Circle = tuple[int, int, int]  # centre and radius in 1/64 px


def refined(circle: Circle, points: Sequence[Point], limit: int) -> Circle:
    """One round of the fit over the points not further than `limit` from the circle."""
    x, y, radius = circle
    rows = []
    for point in points:
        away = distance(point, (x, y))
        if away and abs(away - radius) <= limit:
            nx, ny = (point[0] - x) * 256 // away, (point[1] - y) * 256 // away
            rows.append((8 if away > radius else 1, nx, ny, away - radius))
    weight = sum(row[0] for row in rows)
    if not weight:
        return circle

    def total(*columns: int) -> int:
        return sum(int(np.prod([row[0], *(row[column] for column in columns)])) for row in rows)

    def spread(first: int, second: int) -> int:
        return (total(first, second) - total(first) * total(second) // weight) // weight

    xx, xy, yy = spread(1, 1) >> 4, spread(1, 2) >> 4, spread(2, 2) >> 4
    xe, ye = spread(1, 3), spread(2, 3)
    size = (xx * yy - xy * xy) >> 4
    dx = dy = 0
    if size >= 1024:
        dx = min(max((xe * yy - ye * xy + size // 2) // size, -limit), limit)
        dy = min(max((ye * xx - xe * xy + size // 2) // size, -limit), limit)
    towards = (total(1) * dx + total(2) * dy) >> 8
    return x + dx, y + dy, radius + (2 * (total(3) - towards) + weight) // (2 * weight)


def arc(circle: Circle, points: Sequence[Point]) -> int:
    """How much of a circle has a point within a pixel, in 1/256: 8 for each of its 32 sectors."""
    x, y, radius = circle
    near = [each for each in points if abs(distance(each, (x, y)) - radius) <= FINE]
    if not near:
        return 0
    off = np.array(near) - (x, y)
    return 8 * len(set((references.angle(off[:, 0], off[:, 1]) // 8).tolist()))


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
    number: int, blob: Blob, edges: Sequence[Edge], opened: Picture, luma: Picture, colours: int, limits: Any
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
    found = selected(edges, opened, colours, wide, mass, limits.angle_range, limits.dark_balls)
    found = found[: 3 * width]
    record = [(32 * each + blob.pixels) // (2 * blob.pixels) for each in blob.sums]
    record += [0, number, len(found), 0, 0, 0, 0]
    if len(found) < max(limits.min_edges, 1):
        return record
    reach = min((max(right - left, bottom - top) + 1) // 2, limits.patch_reach)
    around = min(limits.peak_reach, reach)
    patch = votes(found, mass, reach)
    row, column, size = peak(patch, around)
    record[5] = min(256 * size // (len(found) * (2 * around + 1)), 255)
    if not size or record[5] < limits.centre_share:
        return record
    square = patch[row - around : row + around + 1, column - around : column + around + 1]
    x = FINE * (mass[0] - reach + column) + mean_offset(square.sum(axis=0).tolist())
    y = FINE * (mass[1] - reach + row) + mean_offset(square.sum(axis=1).tolist())
    record[7] = 1
    _, size, radius = radius_peak(histogram(found, (x, y), width), limits.peak_reach)
    record[6] = min(256 * size // len(found), 255)
    if size and size >= limits.min_peak and record[6] >= limits.radius_share:
        record[7] = 3
        if limits.fit_rounds:
            limit = FINE * limits.fit_range
            close = [
                edge
                for edge in found
                if abs(distance((FINE * edge[0], FINE * edge[1]), (x, y)) - radius) <= limit
            ]
            points = [point_of(edge, luma) for edge in close]
            for _ in range(limits.fit_rounds):
                x, y, radius = refined((x, y, radius), points, limit)
                limit = max(limit // 2, FINE)
            record[8] = arc((x, y, radius), points)
    record[:3] = [(each + 2) // 4 for each in (x, y, radius)]
    return record
