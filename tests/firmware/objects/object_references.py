"""What the object stages must do, in plain Python with exact fractions; shares no code with the kernels.

Records are dictionaries by the names of their words.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import floor
from typing import Any

from tests.firmware.objects.place_references import BALL, FOCAL, Record, ball_at, floor_depth, rectangle_at

# Rectangles


def border_cost(
    line: Sequence[int],
    side: str,
    span: tuple[int, int],
    border: int,
    reach: int,
    overlap: int,
    dark: int,
) -> int | None:
    """How far a line is from a border on a side of a box, which has the rows or the columns of `span` there, in 1/16 px; None if it cannot be."""
    x0, y0, x1, y1 = line
    upright = side in ("left", "right")
    ends = [(y0, x0), (y1, x1)] if upright else [(x0, y0), (x1, y1)]  # along, across
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
    cost = abs(outermost(across(low), across(high)) - border)
    if cost > reach:
        return None
    # the bright side lies on the left of the way from start to end
    inside = {"left": y1 > y0, "right": y1 < y0, "top": x1 < x0, "bottom": x1 > x0}[side]
    return cost if inside else cost + dark


def rectangle(
    lines: Sequence[Sequence[int]],
    box: Record,
    ends: dict[str, tuple[int, int]],
    goals: int,
    limits: tuple[int, int, int],
) -> tuple[list[int], list[int]]:
    """The border lines left, right, top and bottom of a box, -1 for none, and where its posts end to the left and to the right.

    `ends`: the rows that it has there. `goals` are the colours of goals; `limits`: reach, overlap, dark.
    """
    reach, overlap, dark = limits
    spans = dict.fromkeys(("top", "bottom"), (box["left"], box["right"])) | ends

    def near(side: str, border: int, within: int) -> list[tuple[int, int]]:
        costs = [border_cost(line, side, spans[side], border, within, overlap, dark) for line in lines]
        return [(cost, number) for number, cost in enumerate(costs) if cost is not None]

    def nearest(side: str, border: int, within: int) -> int:
        return min(near(side, border, within), default=(0, -1))[1]

    borders = {side: 16 * box[side] - 8 for side in ("left", "top")}
    borders |= {side: 16 * box[side] + 8 for side in ("right", "bottom")}
    found = {side: nearest(side, border, reach) for side, border in borders.items()}
    feet = []
    for side, (top, bottom) in ends.items():
        end = 16 * bottom + 8
        posts = [max(lines[number][1], lines[number][3]) for _, number in near(side, borders[side], reach)]
        farthest = end + (16 * (bottom - top + 1)) // 2
        feet.append(max([end, *(each for each in posts if each <= farthest)]))
    if box["colours"] & goals and max(feet) > borders["bottom"]:
        mouth = nearest("bottom", max(feet) + reach // 2, reach // 2)
        found["bottom"] = mouth if mouth >= 0 else found["bottom"]
    return [found[side] for side in ("left", "right", "top", "bottom")], feet


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
    by_circle = model.shape == BALL and thresholds.circle_area
    has_area = circle_area(box, outline, thresholds) if by_circle else area(box, model, thresholds)
    has_dimension = dimension(box, model, geometry, thresholds, width, height)
    for bit, test_passed in ((2, has_dimension), (4, has_area)):
        if not test_passed:
            hidden = (
                model.shape == BALL
                and outline
                and hidden_ball(box, model, outline, geometry, thresholds, height)
            )
            return passed | (24 if hidden else 0)
        passed |= bit
    if outline is None:
        return passed
    if model.shape == BALL:
        centre, shape = outline["tests"] & 1, outline["tests"] & 2 and within(box, outline)
    else:
        centre, shape = outline["bottom"] >= 0, outline["left"] >= 0 and outline["right"] >= 0
    if centre:
        passed |= 8 | (16 if shape else 0)
    return passed


def within(box: Record, circle: Record) -> bool:
    """Whether a blob lies in the square round a circle, to two pixels."""
    reach = circle["radius"] + 32
    return (
        16 * box["left"] >= circle["x"] - reach
        and 16 * box["right"] <= circle["x"] + reach
        and 16 * box["top"] >= circle["y"] - reach
        and 16 * box["bottom"] <= circle["y"] + reach
    )


def hidden_ball(
    box: Record, model: Any, circle: Record, geometry: Sequence[int], thresholds: Any, height: int
) -> bool:
    """Whether a circle can be trusted whose blob has not the form of a ball."""
    wide = 2 * circle["radius"]
    return (
        0 < thresholds.hidden_arc <= circle["arc"]
        and circle["tests"] == 3
        and within(box, circle)
        and wide >= 16 * thresholds.shortest_side
        and right_size(wide, circle["y"] + circle["radius"] - 8 * (height - 1), model, geometry, thresholds)
    )


def right_size(looks_px16: int, row: int, model: Any, geometry: Sequence[int], thresholds: Any) -> bool:
    """Whether what looks so high is as high as the model where its lower border stands."""
    looks = looks_px16 * floor_depth(geometry, row, model.floor_mm) // 16
    true = geometry[FOCAL] * model.height_mm // 16
    return 16 * looks <= thresholds.size_range * true and 16 * true <= thresholds.size_range * looks


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
        return not cut_across and cut_size(box, model, geometry, thresholds, height)
    row = 16 * box["bottom"] + 8 - 8 * (height - 1)
    return right_size(16 * high, row, model, geometry, thresholds)


def cut_size(box: Record, model: Any, geometry: Sequence[int], thresholds: Any, height: int) -> bool:
    """Whether what the picture cuts above or below looks as large as the model may where the border that is seen has it."""
    cut_above, cut_below = box["top"] <= 1, box["bottom"] >= height - 2
    if cut_above and cut_below:
        return False
    border = 16 * box["top"] - 8 if cut_below else 16 * box["bottom"] + 8
    over_mm = model.floor_mm + (model.height_mm if cut_below else 0)
    depth = floor_depth(geometry, border - 8 * (height - 1), over_mm)
    slack = Fraction(thresholds.size_range, 16)
    wide_mm, high_mm = (Fraction(side * depth, geometry[FOCAL] // 16) for side in sides(box))
    return (
        depth > 0
        and wide_mm <= slack * model.width_mm
        and high_mm <= slack * model.height_mm
        and wide_mm * slack >= min(model.height_mm * model.aspect_min // 16, model.width_mm)
    )


def circle_area(box: Record, circle: Record | None, thresholds: Any) -> bool:
    """The area test of T Eq. 2.13: P_a, the area of the circle by that of the blob, is near one."""
    if circle is None:
        return False
    square = (2 * circle["radius"]) ** 2 // 256
    return abs(square * 201 // box["pixels"] - 256) <= thresholds.ball_area


def area(box: Record, model: Any, thresholds: Any) -> bool:
    """The area test."""
    wide, high = sides(box)
    share = 256 * box["pixels"] // (wide * high)
    if model.shape == BALL:
        return abs(share - 201) <= thresholds.ball_area
    return share >= thresholds.rectangle_area


# Sight


def sight(
    boxes: Sequence[Record],
    parents: Sequence[int],
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
    """The objects that a camera sees, `room` at the most, and how many there would be; `parents`: what each blob is part of."""
    seen: list[Record] = []
    count = 0
    for number, box in enumerate(boxes):
        if parents[number] != number:
            continue
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
            found = rectangle_at(found, model, box, outline, bottom, geometry, thresholds.refined, size)
        count += 1
        if len(seen) < room:
            seen.append(found)
        else:
            weakest = min(range(room), key=lambda each: seen[each]["accuracy"])
            if seen[weakest]["accuracy"] < accuracy:
                seen[weakest] = found
    return seen, count
