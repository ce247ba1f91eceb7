"""Where a goal is: from the feet at both ends of its blob to the middle of its mouth, beside closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.firmware.objects.object_rig import HEIGHT, THESIS, WIDTH
from tests.firmware.objects.sight_rig import see
from tinyphoon.stages.rectangle_ends import LEFT_HIDDEN, RIGHT_HIDDEN
from tinyphoon.stores.objects import BY_FLOOR
from tinyphoon.strategy.models import BLUE, MODELS
from tinyphoon.strategy.modes import INDOOR_FIELD

GOAL = MODELS[1]
FOCAL, UP_MM, TILT = THESIS.focal_px, THESIS.height_mm, np.radians(THESIS.tilt_deg)
POST_PX = 6
PIXEL_MM = 1000**2 / (FOCAL * UP_MM)  # what a row is worth at 1 m


def seen_at(across_mm: float, ahead_mm: float, up_mm: float = 0) -> tuple[np.ndarray, float, float]:
    """A point in the camera's frame, and its column and row."""
    below = UP_MM - up_mm
    point = np.array(
        [
            across_mm,
            below * np.cos(TILT) - ahead_mm * np.sin(TILT),
            ahead_mm * np.cos(TILT) + below * np.sin(TILT),
        ]
    )
    column, row = FOCAL * point[:2] / point[2]
    return point, column + (WIDTH - 1) / 2, row + (HEIGHT - 1) / 2


def goal(
    middle_mm: tuple[float, float], turn_deg: float
) -> tuple[list[dict[str, int]], list[int], np.ndarray, list[float]]:
    """The blobs of a goal of two posts and its back, merged, as far as they are in the picture; its middle; its bottom line."""
    turn = np.radians(turn_deg)
    along = 200 * np.array([np.cos(turn), np.sin(turn)])
    ends = [seen_at(*(middle_mm + side * along)) for side in (-1, 1)]
    tops = [seen_at(*(middle_mm + side * along), up_mm=100)[2] for side in (-1, 1)]
    posts = [(round(column) - 2, round(row - 0.5)) for _, column, row in ends]
    boxes = [
        {"left": left, "right": left + POST_PX, "top": round(top), "bottom": bottom}
        for (left, bottom), top in zip(posts, tops, strict=True)
    ]
    back = {"left": boxes[0]["right"] + 8, "right": boxes[1]["left"] - 8}
    boxes.append(back | {"top": boxes[0]["top"] - 2, "bottom": min(each["bottom"] for each in boxes) - 4})
    inside = [each | {"right": min(each["right"], WIDTH - 2)} for each in boxes if each["left"] < WIDTH - 8]
    whole = {
        name: pick(each[name] for each in inside)
        for name, pick in (("left", min), ("right", max), ("top", min), ("bottom", max))
    }
    blobs = [each | {"colours": BLUE, "pixels": 2000} for each in (*inside, whole)]
    place, *_ = seen_at(*middle_mm, up_mm=50)
    line = [16 * each for _, column, row in ends for each in (column, row)]
    return blobs, [len(inside)] * len(blobs), place, line


def rows_at(blobs: Sequence[dict[str, int]], side: str) -> tuple[int, int]:
    """The rows of the part that reaches farthest to a side of a merged blob, which comes last, and of those above or below it."""
    *parts, box = blobs
    ends = [each for each in parts if each[side] == box[side]]
    if not ends:
        return box["top"], box["bottom"]
    end = ends[-1]

    def shares_columns(one: dict[str, int]) -> bool:
        common = min(one["right"], end["right"]) + 1 - max(one["left"], end["left"])
        return 2 * common >= min(each["right"] - each["left"] + 1 for each in (one, end))

    column = [each for each in parts if shares_columns(each)]
    return min(each["top"] for each in column), max(each["bottom"] for each in column)


def placed(
    blobs: Any, parents: Any, line: Any = None, post: Any = None, *, hidden: int = 0, refined: bool = True
) -> np.ndarray:
    """Where the only goal is seen, with its bottom line and where its left post ends."""
    thresholds = replace(INDOOR_FIELD.objects, refined=refined)
    left, right = (rows_at(blobs, side) for side in ("left", "right"))
    rectangle = {"left": -1, "right": -1, "top": -1, "bottom": 0 if line else -1, "blob": len(blobs) - 1}
    rectangle |= {"hidden": hidden, "left_rows": left, "right_rows": right}
    rectangle |= {"left_foot": round(post or 16 * left[1] + 8), "right_foot": 16 * right[1] + 8}
    borders, lines = [rectangle], [[round(each) for each in line]] if line else []
    (found,) = see(
        blobs, rectangles=borders, parents=parents, lines=lines, models=(GOAL,), thresholds=thresholds
    )
    assert found["measures"] == BY_FLOOR
    return np.array([found["x"], found["y"], found["z"]])


@pytest.mark.parametrize("turn_deg", [0, 20, -35, 50])
@pytest.mark.parametrize("middle_mm", [(0, 900), (-60, 800), (40, 1100)])
def test_between_both_posts(turn_deg: float, middle_mm: tuple[float, float]) -> None:
    """From the front and at an angle: half a row of error at each post, where the whole rows are all that is known."""
    blobs, parents, place, line = goal(middle_mm, turn_deg)
    error_mm = PIXEL_MM * ((middle_mm[1] + 200) / 1000) ** 2
    assert np.linalg.norm(placed(blobs, parents) - place) < error_mm
    assert np.linalg.norm(placed(blobs, parents, line) - place) < error_mm / 2


@pytest.mark.parametrize(("below_px", "is_floor_line"), [(0.9, False), (2, True), (3.9, True), (6, False)])
def test_a_line_painted_before_the_goal(below_px: float, is_floor_line: bool) -> None:
    """A line a little below both feet is on the floor; what is so near that the opening made the gap is the goal's own.

    One farther below is taken for the line on which the feet stand that are not seen.
    """
    blobs, parents, _, line = goal((0, 900), 0)
    line[1] = line[3] = 16 * (blobs[0]["bottom"] + 0.5 + below_px)  # both feet end in one row
    wanted = placed(blobs, parents) if is_floor_line else placed(blobs, parents, line, refined=False)
    assert placed(blobs, parents, line)[2] == pytest.approx(wanted[2], abs=2)


@pytest.mark.parametrize(("post_px", "is_foot"), [(1, True), (1.1, False)])
def test_a_post_that_goes_on_below_its_blob(post_px: float, is_foot: bool) -> None:
    """Where the border of a post ends lower than its colour, the blob's end is no foot, and the bottom line is the goal's."""
    blobs, parents, _, line = goal((0, 900), 0)
    end = 16 * (blobs[0]["bottom"] + 0.5)
    line[1] = line[3] = end + 32  # as painted on the floor
    as_before, of_line = placed(blobs, parents, line), placed(blobs, parents, line, refined=False)
    found = placed(blobs, parents, line, end + 16 * post_px)
    assert (found[2] == as_before[2]) == is_foot
    assert is_foot or found[2] == pytest.approx((as_before[2] + of_line[2]) / 2, abs=2)


def test_a_cut_end_has_no_foot() -> None:
    """At the picture's border the line is believed, though the back of the goal ends little above it."""
    blobs, parents, _, line = goal((180, 600), 0)
    before = placed(blobs, parents, line)
    line[3] += 16  # lower, so nearer
    assert placed(blobs, parents, line)[2] < before[2] - 2


def test_the_thesis_s_way_takes_the_nearest_part() -> None:
    """At an angle the floor below the blob is that before the nearer post."""
    blobs, parents, place, _ = goal((0, 900), 50)
    plain = placed(blobs, parents, refined=False)
    assert plain[2] < place[2] - 100


@pytest.mark.parametrize(("middle_x_mm", "turn_deg"), [(180, 0), (150, 30), (170, -25)])
def test_a_goal_that_the_picture_cuts(middle_x_mm: float, turn_deg: float) -> None:
    """Half its width from the post that is seen, along its bottom line."""
    blobs, parents, place, line = goal((middle_x_mm, 600), turn_deg)
    assert blobs[-1]["right"] == WIDTH - 2
    assert np.linalg.norm(placed(blobs, parents, line) - place) < 0.05 * np.linalg.norm(place)


def test_it_is_the_same_from_the_other_side() -> None:
    """Left and right exchanged."""
    blobs, parents, _, line = goal((180, 600), 20)
    mirrored = [
        each | {"left": WIDTH - 1 - each["right"], "right": WIDTH - 1 - each["left"]} for each in blobs
    ]
    back = [
        16 * (WIDTH - 1) - line[2],
        line[3],
        16 * (WIDTH - 1) - line[0],
        line[1],
    ]
    x, y, z = placed(blobs, parents, line)
    assert placed(mirrored, parents, back) == pytest.approx([-x, y, z], abs=2)


def test_a_hidden_post() -> None:
    """What is left is no goal's width wide: the nearer foot tells the depth, the middle of what is seen the way."""
    blobs, _, _, _ = goal((0, 900), 0)
    half = [blobs[1], blobs[2] | {"left": 190}]
    whole = blobs[3] | {"left": 190}
    x, _, z = placed([*half, whole], [2, 2, 2])
    depth = UP_MM * FOCAL / (
        (blobs[1]["bottom"] + 0.5 - 119.5) * np.cos(TILT) + FOCAL * np.sin(TILT)
    ) - 50 * np.sin(TILT)
    assert z == pytest.approx(depth, abs=2)
    assert x == pytest.approx(((190 + whole["right"]) / 2 - 159.5) / FOCAL * z, rel=0.02)


@pytest.mark.parametrize("turn_deg", [18, -18])
@pytest.mark.parametrize("hidden", [LEFT_HIDDEN, RIGHT_HIDDEN])
def test_a_foot_that_is_known_to_be_hidden(hidden: int, turn_deg: float) -> None:
    """What is seen is a goal's width wide all the same: the other foot tells the depth, even if it is the farther one."""
    blobs, parents, _, _ = goal((0, 900), turn_deg)
    foot = blobs[1 if hidden == LEFT_HIDDEN else 0]["bottom"]
    depth = UP_MM * FOCAL / ((foot + 0.5 - 119.5) * np.cos(TILT) + FOCAL * np.sin(TILT)) - 50 * np.sin(TILT)
    assert placed(blobs, parents, hidden=hidden)[2] == pytest.approx(depth, abs=2)


@pytest.mark.parametrize("hidden", [LEFT_HIDDEN, RIGHT_HIDDEN])
@pytest.mark.parametrize("seen_px", [60, 110, 150])
def test_the_middle_of_a_goal_that_is_hidden_in_part(hidden: int, seen_px: int) -> None:
    """However much of it is seen: half a goal's width from the post that is, where its front is parallel to the picture."""
    blobs, _, place, _ = goal((30, 900), 0)
    whole = blobs[-1]
    cut = {"left": whole["right"] - seen_px} if hidden == LEFT_HIDDEN else {"right": whole["left"] + seen_px}
    post = blobs[1 if hidden == LEFT_HIDDEN else 0]
    found = placed([post, whole | cut], [1, 1], hidden=hidden)
    assert found[0] == pytest.approx(place[0], abs=POST_PX * 900 / FOCAL)


def test_a_line_of_the_back() -> None:
    """A line above the feet is not theirs."""
    blobs, parents, _, line = goal((0, 900), 0)
    line[1] = line[3] = 16 * (blobs[0]["bottom"] + 0.5 - 1.1)
    assert (placed(blobs, parents, line) == placed(blobs, parents)).all()


def test_a_post_in_two_parts() -> None:
    """The lower one has the foot."""
    blobs, _, place, _ = goal((0, 900), 20)
    upper, lower = blobs[0] | {"bottom": 80}, blobs[0] | {"top": 84, "left": blobs[0]["left"] + 1}
    found = placed([upper, lower, *blobs[1:]], [4] * 5)
    assert np.linalg.norm(found - place) < PIXEL_MM
