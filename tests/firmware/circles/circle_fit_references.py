"""What the fit of a circle to its outline must give, in whole numbers and in plain Python; shares no code with the firmware.

Points and vectors are (x, y).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isqrt

import numpy as np

from tests.firmware import references

Point = tuple[int, int]
FINE = 64
Circle = tuple[int, int, int]  # centre and radius in 1/64 px


def distance(point: Point, centre: Point) -> int:
    """Rounded down."""
    return isqrt((point[0] - centre[0]) ** 2 + (point[1] - centre[1]) ** 2)


Breadth = tuple[int, int]  # how much an outline rises, and its rises times the squares of their distances


def nearer(limit: int, radius: int) -> int:
    """How far from the circle points may be in the next round: half as far, but 4.7 eighths of a pixel or a sixteenth of the radius."""
    return max(limit // 2, min(max(int(4.7 * FINE / 8), radius // 16), limit))


def without_blur(circle: Circle, breadth: Breadth) -> Circle:
    """A circle whose radius is larger by the variance of the outline's blur over twice the radius."""
    x, y, radius = circle
    whole, square = breadth
    variance = max(square // max(whole // FINE, 1) - FINE // 6, 0)
    return x, y, radius + int(FINE * variance / (2 * max(radius, FINE)) + 0.5)


Weights = tuple[int, int]  # what a point counts inside the circle, and outside


def weights(steep: Sequence[int]) -> list[Weights]:
    """One over the variance of each point's place, of 255 for an eighth of a pixel.

    With noise of 2 levels, and inside the circle half a pixel of shade for each time that the outline could be steeper.
    """
    mean = sum(each**2 for each in steep) // max(len(steep), 1)
    squares = [each**2 for each in steep]
    return [
        (255 * each // (each + 256 + 16 * max(mean - each, 0)), 255 * each // (each + 256))
        for each in squares
    ]


Bulge = tuple[
    int, int
]  # by how much a radius grows along the picture's axes and along its diagonals, in 1/4096


def bulge_of(circle: Circle, focal_px: int, size: tuple[int, int]) -> Bulge:
    """How far the image of a sphere is from a circle, whose centre is so far from the middle of a picture."""
    x, y = (
        min(max((each - 32 * (pixels - 1)) // 64, -511), 511)
        for each, pixels in zip(circle[:2], size, strict=True)
    )
    square = max((focal_px + isqrt(focal_px**2 + x * x + y * y)) ** 2, 1)
    return 4096 * (x * x - y * y) // square, 4096 * 2 * x * y // square


def off_outline(point: Point, circle: Circle, bulge: Bulge) -> tuple[int, int, int]:
    """The unit vector from the centre to a point, in 1/128, and how far the point is outside the outline, in 1/64 px."""
    x, y, radius = circle
    away = max(distance(point, (x, y)), 1)
    nx, ny = (point[0] - x) * 128 // away, (point[1] - y) * 128 // away
    more = (bulge[0] * (nx * nx - ny * ny) + 2 * bulge[1] * nx * ny) >> 14
    return nx, ny, away - radius - (radius * more >> 12)


def refined(
    circle: Circle, points: Sequence[Point], counts: Sequence[Weights], limit: int, bulge: Bulge = (0, 0)
) -> Circle:
    """One round of the fit over the points nearer to the circle than `limit`: the nearer, the more they count, up to 32."""
    x, y, radius = circle
    rows = []
    for point, count in zip(points, counts, strict=True):
        nx, ny, off = off_outline(point, circle, bulge)
        if abs(off) < limit:
            near = ((limit**2 - off**2) * ((64 << 16) // limit**2)) >> 16
            rows.append(((near * count[off > 0] + 256) >> 9, nx, ny, off))
    weight = sum(row[0] for row in rows)
    if not weight:
        return circle

    def total(*columns: int) -> int:
        return sum(int(np.prod([row[0], *(row[column] for column in columns)])) for row in rows)

    def spread(first: int, second: int) -> int:
        return (total(first, second) - total(first) * total(second) // weight) // weight

    xx, xy, yy = spread(1, 1) >> 2, spread(1, 2) >> 2, spread(2, 2) >> 2
    xe, ye = 2 * spread(1, 3), 2 * spread(2, 3)
    size = (xx * yy - xy * xy) >> 4
    dx = dy = 0
    if size >= 1024:
        dx = min(max((xe * yy - ye * xy + size // 2) // size, -limit), limit)
        dy = min(max((ye * xx - xe * xy + size // 2) // size, -limit), limit)
    towards = ((total(1) >> 1) * dx + (total(2) >> 1) * dy) >> 6
    return x + dx, y + dy, radius + (2 * (total(3) - towards) + weight) // (2 * weight)


def settled(
    circle: Circle,
    points: Sequence[Point],
    counts: Sequence[Weights],
    limit: int,
    rounds: int,
    bulge: Bulge = (0, 0),
) -> Circle:
    """The circle after some rounds, or when none of its numbers moves by more than a thirtieth of a pixel any more."""
    for _ in range(rounds):
        before, circle = circle, refined(circle, points, counts, limit, bulge)
        closer = nearer(limit, circle[2])
        if closer == limit and max(abs(one - other) for one, other in zip(before, circle, strict=True)) <= 2:
            break
        limit = closer
    return circle


def arc(circle: Circle, points: Sequence[Point], bulge: Bulge = (0, 0)) -> int:
    """How much of an outline has a point within a pixel, in 1/256: 8 for each of its 32 sectors."""
    x, y, _ = circle
    near = [each for each in points if abs(off_outline(each, circle, bulge)[2]) <= FINE]
    if not near:
        return 0
    off = np.array(near) - (x, y)
    return 8 * len(set((references.angle(off[:, 0], off[:, 1]) // 8).tolist()))
