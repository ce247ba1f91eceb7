"""Objects that leave the picture: how large what is seen of them may be, by the border that is still in it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.firmware.objects.object_rig import THESIS
from tests.firmware.objects.sight_rig import BALL, BLUE_GOAL, MARKER, MOUTH, ROUND, see
from tinyphoon.stores.objects import DIMENSION_TEST
from tinyphoon.strategy.models import RED

# The end of a goal, seen from the side of it: its top is 230 mm away, so 151 px are 90 mm.
GOAL_CUT_BELOW = MOUTH | {"left": 100, "right": 250, "top": 86, "bottom": 238}


@pytest.mark.parametrize(
    ("box", "passed"),
    [
        (MOUTH | {"left": 1, "right": 31}, True),  # half a goal at the picture's left border may go on
        (MOUTH | {"left": 2, "right": 32}, False),
        (MOUTH | {"left": 288, "right": 318}, True),
        (MOUTH | {"left": 287, "right": 317}, False),
    ],
)
def test_what_leaves_the_picture_may_be_larger(box: dict[str, int], passed: bool) -> None:
    """The dimension test takes what it sees as the least."""
    (found,) = see([box], models=(BLUE_GOAL,))
    assert bool(found["tests"] & DIMENSION_TEST) == passed


@pytest.mark.parametrize(
    ("change", "passed"),
    [
        ({}, True),
        ({"left": 5, "right": 310}, True),
        ({"left": 180}, False),  # 42 mm: less than two thirds of the least width, 75 mm
        ({"top": 52}, False),  # 20 mm below the camera, but over the horizon
        ({"top": 70}, False),  # 434 mm away 169 px would be 190 mm high
        ({"top": 190}, False),  # 57 mm away 151 px would be 22 mm wide
        ({"left": 1}, False),  # in a corner of the picture nobody knows
        ({"top": 1}, False),
    ],
)
def test_a_goal_that_the_picture_cuts_below(change: dict[str, int], passed: bool) -> None:
    """Its top tells how far away it is, and so how large what is seen of it may look."""
    (found,) = see([GOAL_CUT_BELOW | change], models=(BLUE_GOAL,))
    assert bool(found["tests"] & DIMENSION_TEST) == passed


@pytest.mark.parametrize(
    ("box", "passed"),
    [
        ({"left": 90, "right": 230, "top": 160, "bottom": 238}, True),  # 218 mm away it looks 106 px large
        ({"left": 40, "right": 280, "top": 160, "bottom": 238}, False),
        ({"left": 140, "right": 178, "top": 160, "bottom": 238}, False),
    ],
)
def test_a_ball_that_the_picture_cuts_below(box: dict[str, int], passed: bool) -> None:
    """A floor of its colour is no ball, and a spot of it neither."""
    (found,) = see([ROUND | box], models=(BALL,))
    assert bool(found["tests"] & DIMENSION_TEST) == passed


@pytest.mark.parametrize(("right", "passed"), [(305, True), (318, False), (180, False)])
def test_a_mark_that_the_picture_cuts_above(right: int, passed: bool) -> None:
    """By cameras that look down 30 degrees: its lower border is 88 mm away, so 206 px are 47 mm, and 81 px 18 mm."""
    steep = replace(THESIS, tilt_deg=30.0)
    box = {"colours": RED, "pixels": 5000, "left": 100, "right": right, "top": 1, "bottom": 150}
    (found,) = see([box], models=(MARKER,), geometry=steep)
    assert bool(found["tests"] & DIMENSION_TEST) == passed


def test_a_bottom_out_of_the_picture_tells_no_distance() -> None:
    """The floor below is not seen."""
    (found,) = see([GOAL_CUT_BELOW], models=(BLUE_GOAL,))
    assert found["tests"] & DIMENSION_TEST
    assert found["measures"] == 0
