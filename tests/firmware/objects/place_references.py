"""Where seen things stand, in plain Python with exact fractions; shares no code with the kernels.

Records are dictionaries by the names of their words.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import floor, isqrt
from typing import Any

FOCAL, BASELINE, HEIGHT_16, SINE, COSINE = 0, 1, 2, 4, 5  # of the geometry
BALL, GOAL, MARKER = 1, 2, 3
FARTHEST = 32767

Record = dict[str, int]


def rounded(value: Fraction) -> int:
    """The nearest integer, halves upwards."""
    return floor(value + Fraction(1, 2))


def horizon_distance(geometry: Sequence[int], row: int) -> int:
    """How far below the horizon a row is, in 1/16 px."""
    return rounded(Fraction(row * geometry[COSINE] + geometry[FOCAL] * geometry[SINE], 1 << 14))


def floor_depth(geometry: Sequence[int], row: int, floor_mm: int) -> int:
    """The depth of a point over the floor, 0 for none."""
    below = horizon_distance(geometry, row)
    above = geometry[HEIGHT_16] - 16 * floor_mm
    if above < 0:
        below, above = -below, -above
    if below <= 0:
        return 0
    depth = (geometry[FOCAL] * above // 16 + below // 2) // below
    return depth if depth <= FARTHEST else 0


def aside(geometry: Sequence[int], depth: int, off_axis: int) -> int:
    """X or Y of what is so far off the axis in the picture."""
    return rounded(Fraction(depth * off_axis, geometry[FOCAL]))


def placed(found: Record, geometry: Sequence[int], depth: int, size: tuple[int, int]) -> Record:
    """An object at a depth on the way through its image."""
    depth = depth or 4096
    width, height = size
    x, y = found["image_x"] - 8 * (width - 1), found["image_y"] - 8 * (height - 1)
    return found | {"x": aside(geometry, depth, x), "y": aside(geometry, depth, y), "z": depth}


def ball_at(
    found: Record,
    model: Any,
    circle: Record | None,
    geometry: Sequence[int],
    refined: bool,
    size: tuple[int, int],
) -> Record:
    """A ball by its circle."""
    depth = 0
    if circle is not None:
        found = found | {"image_x": circle["x"], "image_y": circle["y"]}
        if found["tests"] & 16:
            extent = 2 * circle["radius"]
            found = found | {"width": extent, "height": extent}
            if refined:
                found, extent = sphere(found, geometry, extent, size)
            if extent > 0:
                depth = (geometry[FOCAL] * model.width_mm + extent // 2) // extent
            depth = depth if depth <= FARTHEST else 0
            if depth:
                found = found | {"measures": 1, "extent": found["width"]}
                if refined:
                    depth = min((isqrt(4 * (depth**2 + (model.width_mm // 2) ** 2)) + 1) // 2, FARTHEST)
    return placed(found, geometry, depth, size)


def sphere(found: Record, geometry: Sequence[int], mean: int, size: tuple[int, int]) -> tuple[Record, int]:
    """A ball's image at its centre, and its size across, given the ellipse's middle and the mean of its axes."""
    focal = geometry[FOCAL]
    x, y = (found[name] - 8 * (each - 1) for name, each in zip(("image_x", "image_y"), size, strict=True))
    reach = focal + isqrt(focal**2 + x**2 + y**2)
    across = (focal * mean + (reach >> 2)) // (reach >> 1)
    square = (across >> 1) ** 2
    beyond = square // max((focal**2 + square) >> 12, 1)
    return found | {
        "image_x": found["image_x"] - (x * beyond >> 12),
        "image_y": found["image_y"] - (y * beyond >> 12),
    }, across


def row_below(line: Sequence[int] | None, bottom: int, column: int) -> int:
    """The row of a bottom line at a column, or else of the end of a blob."""
    if line is None:
        return 16 * bottom + 8
    x0, y0, x1, y1 = line
    return y0 + floor(Fraction((y1 - y0) * (column - x0) + (x1 - x0) // 2, x1 - x0))


def foot_row(line: Sequence[int] | None, foot: int | None, bottom: int, column: int, is_cut: bool) -> int:
    """The row of a foot: the bottom line, or the end of the blob if that is more than one pixel above it, but not more than four.

    Not where the post goes on below that end by more than a pixel. Nor is it a line more than a pixel above that end.
    """
    end, row = row_below(None, bottom, column), row_below(line, bottom, column)
    goes_on = foot is None or foot > end + 16
    return end if row < end - 16 or (16 < row - end <= 64 and not is_cut and not goes_on) else row


def rectangle_at(
    found: Record,
    model: Any,
    box: Record,
    outline: Record | None,
    bottom: Sequence[int] | None,
    geometry: Sequence[int],
    refined: bool,
    size: tuple[int, int],
) -> Record:
    """A rectangle by the floor below it; `outline` is its record, and `bottom` its bottom line."""
    width, height = size
    middle_x, middle_y = 8 * (width - 1), 8 * (height - 1)
    cut = box["top"] <= 1 or box["bottom"] >= height - 2
    row = row_below(bottom, box["bottom"], found["image_x"]) - middle_y
    depth = floor_depth(geometry, row, model.floor_mm)
    if not found["tests"] & 2 or cut or not depth:
        return placed(found, geometry, 0, size)
    x, y, z = on_floor(geometry, found["image_x"] - middle_x, row, depth)
    if refined and model.shape == GOAL:
        corners = []
        for side, column in (("left", 16 * box["left"] - 8), ("right", 16 * box["right"] + 8)):
            is_cut = box["left"] <= 1 if side == "left" else box["right"] >= width - 2
            _, last = outline[f"{side}_rows"] if outline else (box["top"], box["bottom"])
            foot = outline[f"{side}_foot"] if outline else None
            below = foot_row(bottom, foot, last, column, is_cut) - middle_y
            corners.append((column - middle_x, below, floor_depth(geometry, below, 0)))
        cuts = box["left"] <= 1, box["right"] >= width - 2
        if all(each[2] for each in corners):
            hidden = outline["hidden"] if outline else 0
            x, y, z = between_feet(corners, cuts, hidden, model.width_mm, geometry)
    up, back = (((model.height_mm * geometry[each] >> 14) + 1) // 2 for each in (COSINE, SINE))
    extent = abs(horizon_distance(geometry, row))
    return found | {"x": x, "y": y - up, "z": z - back, "measures": 2, "extent": extent}


def on_floor(geometry: Sequence[int], column: int, row: int, depth: int) -> tuple[int, int, int]:
    """What is seen there, from the principal point, at a depth."""
    return aside(geometry, depth, column), aside(geometry, depth, row), depth


def between_feet(
    corners: Sequence[tuple[int, int, int]],
    cuts: tuple[bool, bool],
    hidden: int,
    width_mm: int,
    geometry: Sequence[int],
) -> tuple[int, int, int]:
    """The middle of a goal's mouth on the floor, from its lower corners: column, row and depth of each."""
    left, right = (on_floor(geometry, *each) for each in corners)
    off = [b - a for a, b in zip(left, right, strict=True)]
    apart = isqrt(sum(each * each for each in off)) if max(map(abs, off)) < 16_000 else 16_000
    share = Fraction(apart, width_mm)
    too_near = share < (Fraction(3, 4) if cuts[0] == cuts[1] else Fraction(1, 4))
    if share > Fraction(5, 4) or too_near or hidden:
        standing = {1: corners[1:], 2: corners[:1]}.get(hidden, corners)
        _, row, depth = min(standing, key=lambda each: each[2])
        x, y, z = on_floor(geometry, (corners[0][0] + corners[1][0]) >> 1, row, depth)
        return {1: right[0] - width_mm // 2, 2: left[0] + width_mm // 2}.get(hidden, x), y, z
    part = Fraction(1, 2) if cuts[0] == cuts[1] else Fraction(width_mm, 2 * apart)
    if cuts[0] and not cuts[1]:
        part = 1 - part
    x, y, z = (rounded(a + (b - a) * part) for a, b in zip(left, right, strict=True))
    return x, y, z
