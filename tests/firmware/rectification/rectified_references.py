"""What rectified features must be, in plain Python and numpy; shares no code with the firmware."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import floor

import numpy as np

Table = Sequence[Sequence[tuple[int, int]]]
"""Places of nodes, eight pixels apart, in sixteenths of a pixel: rows of (column, row)."""


def between(table: Table, x: int, y: int) -> tuple[Fraction, Fraction]:
    """Where a point lies by the four nodes around it, or beyond the outermost ones; exact, in sixteenths."""
    column = min(max(x // 128, 0), len(table[0]) - 2)
    row = min(max(y // 128, 0), len(table) - 2)
    right, below = Fraction(x, 128) - column, Fraction(y, 128) - row
    place = []
    for axis in (0, 1):
        upper, lower = (
            table[row + step][column][axis] * (1 - right) + table[row + step][column + 1][axis] * right
            for step in (0, 1)
        )
        place.append(upper * (1 - below) + lower * below)
    return place[0], place[1]


def nearest(value: Fraction) -> int:
    """The nearest whole number, halves upwards."""
    return floor(value + Fraction(1, 2))


def rectified(table: Table, corner: tuple[int, int], x: int, y: int) -> tuple[int, int]:
    """Where a point of an area lies in it, both in sixteenths of a pixel from its `corner`, which is in pixels."""
    place = between(table, x + 16 * corner[0], y + 16 * corner[1])
    return nearest(place[0]) - 16 * corner[0], nearest(place[1]) - 16 * corner[1]


Edges = Sequence[Sequence[tuple[int, int, int]]]
"""Rows of (gradient, direction, column)."""


def moved_edges(table: Table, corner: tuple[int, int], edges: Edges, width: int) -> Edges:
    """The edges in their new rows, from left to right, of several in a pixel the strongest, of those the one seen first."""
    found: dict[tuple[int, int], tuple[int, int]] = {}
    for y, row in enumerate(edges):
        for gradient, direction, x in row:
            place = between(table, 16 * (x + corner[0]), 16 * (y + corner[1]))
            to = nearest(place[1] / 16) - corner[1], nearest(place[0] / 16) - corner[0]
            if 0 <= to[0] < len(edges) and 0 <= to[1] < width:
                known = found.get(to)
                if known is None or (-gradient, direction) < (-known[0], known[1]):
                    found[to] = gradient, direction
    return [[(*found[y, x], x) for x in range(width) if (y, x) in found] for y in range(len(edges))]


def straight_line(table: Table, corner: tuple[int, int], ends: np.ndarray) -> np.ndarray:
    """A line through points all along it, least squares across, from the foot of one end to that of the other (2, 2)."""
    shares = (np.arange(64) + 0.5) / 64
    along = ends[0] + shares[:, None] * (ends[1] - ends[0])
    shift = 16 * np.array(corner)

    def move(points: np.ndarray) -> np.ndarray:
        places = [between(table, *(round(each) for each in point + shift)) for point in points]
        return np.array(places, float) - shift

    points = move(along)
    middle = points.mean(axis=0)
    direction = np.linalg.svd(points - middle)[2][0]
    return middle + np.outer((move(ends) - middle) @ direction, direction)
