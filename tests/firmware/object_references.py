"""What the object stages must do, in plain Python with exact fractions; shares no code with the kernels.

Records are dictionaries by the names of their words.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import floor, isqrt
from typing import Any

FOCAL, BASELINE, HEIGHT_16, SINE, COSINE = 0, 1, 2, 4, 5  # of the geometry
FARTHEST = 32767
BALL, GOAL, MARKER = 1, 2, 3

Record = dict[str, int]


def rounded(value: Fraction) -> int:
    """The nearest integer, halves upwards."""
    return floor(value + Fraction(1, 2))


# Rectangles


def border_cost(line: Sequence[int], side: str, box: Record, overlap: int, dark: int) -> int | None:
    """How far a line is from the border of a box on a side, in 1/16 px; None if it cannot be."""
    x0, y0, x1, y1 = line
    upright = side in ("left", "right")
    ends = [(y0, x0), (y1, x1)] if upright else [(x0, y0), (x1, y1)]  # along, across
    span = (box["top"], box["bottom"]) if upright else (box["left"], box["right"])
    first, last = 16 * span[0] - 8, 16 * span[1] + 8
    (a0, c0), (a1, c1) = ends
    if abs(a1 - a0) <= abs(c1 - c0):
        return None
    low, high = max(min(a0, a1), first), min(max(a0, a1), last)
    if high <= low or 256 * (high - low) < overlap * (last - first):
        return None

    def across(along: int) -> int:
        run = a1 - a0
        return c0 + floor(Fraction((c1 - c0) * (along - a0) + run // 2, run))

    outermost = max if side in ("right", "bottom") else min
    border = 16 * box[side] + (8 if side in ("right", "bottom") else -8)
    cost = abs(outermost(across(low), across(high)) - border)
    # the bright side lies on the left of the way from start to end
    inside = {"left": y1 > y0, "right": y1 < y0, "top": x1 < x0, "bottom": x1 > x0}[side]
    return cost if inside else cost + dark


def rectangle(lines: Sequence[Sequence[int]], box: Record, reach: int, overlap: int, dark: int) -> list[int]:
    """The border lines left, right, top and bottom of a box, -1 for none."""
    found = []
    for side in ("left", "right", "top", "bottom"):
        costs = [border_cost(line, side, box, overlap, dark) for line in lines]
        near = [(cost, number) for number, cost in enumerate(costs) if cost is not None and cost <= reach]
        found.append(min(near)[1] if near else -1)
    return found


# Tests


def tests_of(
    box: Record,
    model: Any,
    outline: Record | None,
    geometry: Sequence[int],
    thresholds: Any,
    size: tuple[int, int],
) -> int:
    """The bits of the tests that a blob passes for a model."""
    width, height = size
    if not box["colours"] & model.colours:
        return 0
    passed = 1
    for bit, test in ((2, dimension), (4, area)):
        if not test(box, model, geometry, thresholds, width, height):
            return passed
        passed |= bit
    if outline is None:
        return passed
    if model.shape == BALL:
        centre, shape = outline["tests"] & 1, outline["tests"] & 2
    else:
        centre, shape = outline["bottom"] >= 0, outline["left"] >= 0 and outline["right"] >= 0
    if centre:
        passed |= 8 | (16 if shape else 0)
    return passed


def sides(box: Record) -> tuple[int, int]:
    """Pixels across and down."""
    return box["right"] - box["left"] + 1, box["bottom"] - box["top"] + 1


def dimension(
    box: Record, model: Any, geometry: Sequence[int], thresholds: Any, width: int, height: int
) -> bool:
    """The dimension test."""
    wide, high = sides(box)
    cut_across = box["left"] <= 1 or box["right"] >= width - 2
    cut_down = box["top"] <= 1 or box["bottom"] >= height - 2
    aspect = Fraction(16 * wide, high)
    if min(wide, high) < thresholds.shortest_side:
        return False
    if (aspect < model.aspect_min and not cut_across) or (aspect > model.aspect_max and not cut_down):
        return False
    if cut_down:
        return True
    row = 16 * box["bottom"] + 8 - 8 * (height - 1)
    looks = high * floor_depth(geometry, row, model.floor_mm)
    true = geometry[FOCAL] * model.height_mm // 16
    return 16 * looks <= thresholds.size_range * true and 16 * true <= thresholds.size_range * looks


def area(box: Record, model: Any, _geometry: Any, thresholds: Any, *_size: int) -> bool:
    """The area test."""
    wide, high = sides(box)
    share = 256 * box["pixels"] // (wide * high)
    if model.shape == BALL:
        return abs(share - 201) <= thresholds.ball_area
    return share >= thresholds.rectangle_area


# Places


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
            if extent > 0:
                depth = (geometry[FOCAL] * model.width_mm + extent // 2) // extent
            depth = depth if depth <= FARTHEST else 0
            if depth:
                found = found | {"measures": 1, "extent": extent}
                if refined:
                    depth = min((isqrt(4 * (depth**2 + (model.width_mm // 2) ** 2)) + 1) // 2, FARTHEST)
    return placed(found, geometry, depth, size)


def rectangle_at(
    found: Record,
    model: Any,
    box: Record,
    bottom: Sequence[int] | None,
    geometry: Sequence[int],
    size: tuple[int, int],
) -> Record:
    """A rectangle by the floor below it; `bottom` is its bottom line."""
    _, height = size
    cut = box["top"] <= 1 or box["bottom"] >= height - 2
    if not found["tests"] & 2 or cut:
        return placed(found, geometry, 0, size)
    row = 16 * box["bottom"] + 8
    if bottom is not None:
        x0, y0, x1, y1 = bottom
        row = y0 + floor(Fraction((y1 - y0) * (found["image_x"] - x0) + (x1 - x0) // 2, x1 - x0))
    row -= 8 * (height - 1)
    depth = floor_depth(geometry, row, model.floor_mm)
    found = placed(found, geometry, depth, size)
    if not depth:
        return found
    up, back = (((model.height_mm * geometry[each] >> 14) + 1) // 2 for each in (COSINE, SINE))
    extent = abs(horizon_distance(geometry, row))
    return found | {"y": aside(geometry, depth, row) - up, "z": depth - back, "measures": 2, "extent": extent}


# Sight


def sight(
    boxes: Sequence[Record],
    models: Sequence[Any],
    circles: Sequence[Record],
    rectangles: Sequence[Record],
    lines: Sequence[Sequence[int]],
    geometry: Sequence[int],
    thresholds: Any,
    camera: int,
    size: tuple[int, int],
    room: int,
) -> tuple[list[Record], int]:
    """The objects that a camera sees, `room` at the most, and how many there would be."""
    seen: list[Record] = []
    count = 0
    for number, box in enumerate(boxes):
        circle = next(((at, c) for at, c in enumerate(circles) if c["blob"] == number), (-1, None))
        border = next(((at, r) for at, r in enumerate(rectangles) if r["blob"] == number), (-1, None))
        best = None
        for model in models:
            at, outline = circle if model.shape == BALL else border
            tests = tests_of(box, model, outline, geometry, thresholds, size)
            accuracy = sum(weight for bit, weight in enumerate(thresholds.weights) if tests >> bit & 1)
            if tests and (best is None or accuracy > best[0]):
                best = accuracy, tests, model, at, outline
        if best is None:
            continue
        accuracy, tests, model, at, outline = best
        wide, high = sides(box)
        found = {
            "model": model.number, "accuracy": accuracy, "tests": tests, "cameras": camera, "measures": 0, "extent": 0,
            "outline": at, "age": 0, "width": 16 * wide, "height": 16 * high,
            "image_x": 8 * (box["left"] + box["right"]), "image_y": 8 * (box["top"] + box["bottom"]),
        }  # fmt: skip
        if model.shape == BALL:
            found = ball_at(found, model, outline, geometry, thresholds.refined, size)
        else:
            bottom = lines[outline["bottom"]] if outline and outline["bottom"] >= 0 else None
            found = rectangle_at(found, model, box, bottom, geometry, size)
        count += 1
        if len(seen) < room:
            seen.append(found)
        else:
            weakest = min(range(room), key=lambda each: seen[each]["accuracy"])
            if seen[weakest]["accuracy"] < accuracy:
                seen[weakest] = found
    return seen, count


# Verification


def disparity_depth(geometry: Sequence[int], disparity: int) -> int:
    """The depth in mm of a disparity in 1/16 px, 0 for none."""
    if disparity <= 0:
        return 0
    depth = (geometry[FOCAL] * geometry[BASELINE] // disparity + 500) // 1000
    return depth if depth <= FARTHEST else 0


def unlikeness(one: Record, other: Record, row_range: int, disparity_max: int) -> int | None:
    """How unlike two objects are; None if they cannot be the same."""
    rows = abs(one["image_y"] - other["image_y"])
    disparity = one["image_x"] - other["image_x"]
    if one["model"] != other["model"] or rows > row_range or not -row_range <= disparity <= disparity_max:
        return None
    return rows + abs(one["width"] - other["width"])


def verified(
    left: Sequence[Record],
    right: Sequence[Record],
    geometry: Sequence[int],
    row_range: int,
    disparity_max: int,
    weight: int,
    refined: bool,
) -> tuple[list[Record], list[Record]]:
    """The objects of the left camera, made better by the right one's; and what the right one has beside, free ones too."""
    baseline = (geometry[BASELINE] + 500) // 1000
    others = [each | ({"x": each["x"] + baseline} if each["measures"] else {}) for each in right]
    result = []
    for one in left:
        likes = [
            (unlike, number)
            for number, other in enumerate(others)
            if one["model"] and (unlike := unlikeness(one, other, row_range, disparity_max)) is not None
        ]
        if not likes:
            result.append(one)
            continue
        other = others[min(likes)[1]]
        result.append(_pair(one, other, geometry, weight, refined))
        others[min(likes)[1]] = other | {"model": 0}
    return result, others


def _pair(one: Record, other: Record, geometry: Sequence[int], weight: int, refined: bool) -> Record:
    both = dict(one)
    if one["measures"] and other["measures"]:
        both |= {name: (one[name] + other[name] + 1) // 2 for name in ("x", "y", "z", "extent")}
    elif other["measures"]:
        both |= {name: other[name] for name in ("x", "y", "z", "extent")}
    both["measures"] = one["measures"] | other["measures"]
    disparity = one["image_x"] - other["image_x"]
    depth = disparity_depth(geometry, disparity)
    agree = depth > 0 and both["z"] <= 2 * depth and depth <= 2 * both["z"]
    if refined and one["tests"] & other["tests"] & 16 and agree and both["measures"]:
        weights = [max(min((each + 8) // 16, 128), 1) ** 2 for each in (both["extent"], disparity)]
        better = rounded(Fraction(both["z"] * weights[0] + depth * weights[1], sum(weights)))
        for name in ("x", "y"):
            both[name] = (both[name] * better + both["z"] // 2) // both["z"]
        both["z"] = better
        both["measures"] |= 4
    both["accuracy"] = min(max(one["accuracy"], other["accuracy"]) + weight, 255)
    both["tests"] = one["tests"] | other["tests"] | 32
    both["cameras"] = 3
    return both


# History


def remembered(
    history: Sequence[Record], seen: Sequence[Record], age_max: int, apart_max: int
) -> tuple[list[Record], int]:
    """The history after a frame with the objects seen, free records too, and how many found no room."""
    records = [
        each | {"age": each["age"] + 1, "model": each["model"] if each["age"] < age_max else 0}
        if each["model"]
        else each
        for each in history
    ]
    lost = 0
    for one in seen:
        if not one["model"]:
            continue
        old = [number for number, each in enumerate(records) if each["model"] and each["age"] > 0]
        near = [
            (gap(one, records[number]), number) for number in old if records[number]["model"] == one["model"]
        ]
        free = [number for number, each in enumerate(records) if not each["model"]]
        oldest = [(-records[number]["age"], number) for number in old]
        if near and min(near)[0] <= apart_max:
            records[min(near)[1]] = one
        elif free:
            records[free[0]] = one
        elif oldest:
            records[min(oldest)[1]] = one
        else:
            lost += 1
    return records, lost


def gap(one: Record, other: Record) -> int:
    """How far apart two objects are seen, in 1/256 of the focal length."""
    tangents = [[256 * each[name] // max(each["z"], 1) for name in ("x", "y")] for each in (one, other)]
    return sum(abs(a - b) for a, b in zip(*tangents, strict=True))
