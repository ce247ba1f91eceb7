"""Boxes placed by their upright edges, against where they were put; edges as exact as whole mm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from tests.firmware.objects.object_rig import (
    THESIS,
    as_dicts,
    geometry_words,
    models_of,
    object_words,
    rectangle_words,
)
from tinyphoon.stages.box_places import place_all_boxes
from tinyphoon.stores.objects import BY_DISPARITY, BY_FLOOR
from tinyphoon.strategy.models import BOX, MODELS

TILT = np.radians(THESIS.tilt_deg)
CRATE = replace(BOX, width_mm=120, depth_mm=80, height_mm=70)
SEEN = {"model": BOX.number, "outline": 0, "measures": BY_FLOOR, "x": 1, "y": 2, "z": 3}


def corners_of(x: float, ahead: float, heading_deg: float, width: float, depth: float) -> np.ndarray:
    """The corners of a box over the floor (4, 2), to the right and ahead, round its middle."""
    turn = np.radians(heading_deg)
    across, along = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    half = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    return np.array([(x, ahead) + a * across * width / 2 + b * along * depth / 2 for a, b in half])


def uprights(points: np.ndarray, height: float, lines: list[int]) -> np.ndarray:
    """3-D lines from the floor up, of these numbers of lines in the left picture."""
    found = []
    for (x, ahead), line in zip(points, lines, strict=True):
        ends = []
        for below in (THESIS.height_mm, THESIS.height_mm - height):
            down, depth = (
                below * np.cos(TILT) - ahead * np.sin(TILT),
                below * np.sin(TILT) + ahead * np.cos(TILT),
            )
            ends += [round(x), round(down), round(depth)]
        found.append([*ends, line, 0])
    return np.array(found, np.int16).ravel()


def placed(lines_3d: np.ndarray, model=CRATE, border=(1, 2)) -> dict[str, int]:
    """Where the firmware has a box with these 3-D lines; the lines `border` end its blob."""
    table = object_words(SEEN)
    rectangles = rectangle_words((*border, -1, -1, 0, 0, *[0] * 6))
    models = models_of(*MODELS, model)
    place_all_boxes(geometry_words(), models, rectangles, lines_3d, len(lines_3d) // 8, table)
    (found,) = as_dicts(table)
    return found


def off_mm(found: dict[str, int], x: float, ahead: float, model=CRATE) -> float:
    """How far the box is from where it was put."""
    below = THESIS.height_mm - model.height_mm / 2
    down, depth = below * np.cos(TILT) - ahead * np.sin(TILT), below * np.sin(TILT) + ahead * np.cos(TILT)
    return float(np.linalg.norm(np.subtract((found["x"], found["y"], found["z"]), (x, down, depth))))


@given(
    st.integers(-150, 150), st.integers(300, 1200), st.integers(0, 359), st.integers(60, 200), st.integers(60, 200), st.sampled_from(["contrast", "none"])
)  # fmt: skip
@example(0, 500, 0, 120, 80, "contrast")
@example(0, 500, 90, 120, 80, "contrast")
@example(0, 500, 45, 100, 100, "none")
def test_a_box_from_any_side(x: int, ahead: int, heading: int, width: int, depth: int, contrast: str) -> None:
    """Two faces or one, with the near edge or without it: to some mm."""
    model = replace(CRATE, width_mm=width, depth_mm=depth)
    corners = corners_of(x, ahead, heading, width, depth)
    bearings = corners[:, 0] / corners[:, 1]
    left, right = int(np.argmin(bearings)), int(np.argmax(bearings))
    points, lines = [corners[left], corners[right]], [1, 2]
    wide = np.linalg.norm(corners[left] - corners[right])
    if (left - right) % 2 == 0:
        near = min((left + 1) % 4, (left + 3) % 4, key=lambda each: corners[each][1])
        (before,) = {1, 3} - {near} if left in (0, 2) else {0, 2} - {near}
        assume(corners[before][1] - corners[near][1] > 10)  # else it is not clear which one is near
        if contrast == "contrast":
            points, lines = [*points, corners[near]], [*lines, 3]
        else:
            assume(min(abs(wide - width), abs(wide - depth)) > 3)  # nor what is seen
    found = placed(uprights(np.array(points), model.height_mm, lines), model)
    assert found["measures"] == BY_DISPARITY
    assert off_mm(found, x, ahead, model) < 6


FRONT = corners_of(0, 500, 0, 120, 80)[:2]


@pytest.mark.parametrize(
    ("points", "lines"),
    [
        (FRONT * (1.3, 1), [1, 2]),  # too wide for its front, too narrow for its diagonal: 156 mm
        (FRONT * (0.5, 1), [1, 2]),
        (FRONT, [1, 5]),  # no depth at the right end
        (FRONT, [5, 2]),
    ],
)
def test_a_box_that_nothing_tells_stays(points: np.ndarray, lines: list[int]) -> None:
    """Where the floor has it."""
    found = placed(uprights(points, 70, lines), replace(CRATE, depth_mm=40))
    assert {name: found[name] for name in ("x", "y", "z", "measures")} == {
        "x": 1,
        "y": 2,
        "z": 3,
        "measures": BY_FLOOR,
    }


def test_what_else_stands_there_is_no_corner() -> None:
    """A line on the floor before the face, a low one, and one before another thing."""
    others = np.array([(0.0, 440.0), (10.0, 430.0), (200.0, 420.0)])
    front = uprights(FRONT, 70, [1, 2])
    low, lying, beside = uprights(others, 20, [3, 4, 5]).reshape(-1, 8)
    lying[3:6] = (80, lying[1] - 10, lying[2] + 90)
    alone = placed(front)
    assert placed(np.concatenate([front, low, lying, beside])) == alone
    assert off_mm(alone, 0, 500) < 3


def test_other_things_stay() -> None:
    """A marker between the same lines."""
    table = object_words(SEEN | {"model": 4})
    lines = uprights(FRONT, 70, [1, 2])
    place_all_boxes(
        *(
            geometry_words(),
            models_of(*MODELS, CRATE),
            rectangle_words((1, 2, -1, -1, 0, 0, *[0] * 6)),
            lines,
            2,
        ),
        table,
    )
    assert as_dicts(table)[0]["z"] == 3
