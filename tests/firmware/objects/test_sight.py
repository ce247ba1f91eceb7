"""What a camera sees of objects by itself: each test with a record that passes and one that fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.firmware.objects.object_rig import THRESHOLDS, object_words
from tests.firmware.objects.sight_rig import (
    BALL,
    BLUE_GOAL,
    BORDERS,
    CIRCLE,
    MARKER,
    MOUTH,
    ROUND,
    SEEN_WELL,
    YELLOW_GOAL,
    see,
)
from tinyphoon.stages.object_sight import place_for
from tinyphoon.stores.objects import (
    AREA_TEST,
    BY_FLOOR,
    BY_SIZE,
    CENTRE_TEST,
    COLOUR_TEST,
    DIMENSION_TEST,
    SIZE_TEST,
)
from tinyphoon.strategy.models import MODELS, RED, YELLOW

OFTEN = COLOUR_TEST | DIMENSION_TEST | AREA_TEST


def test_a_ball_that_passes_all_tests() -> None:
    """Its circle places it: 386 px x 60 mm / 51.5 px, and the sphere is a millimetre deeper."""
    (ball,) = see([ROUND], [CIRCLE])
    assert ball["tests"] == OFTEN | CENTRE_TEST | SIZE_TEST
    assert ball["accuracy"] == sum(THRESHOLDS.weights[:5])
    assert (ball["measures"], ball["x"], ball["z"], ball["extent"]) == (BY_SIZE, 0, 451, 824)
    (plain,) = see([ROUND], [CIRCLE], thresholds=replace(THRESHOLDS, refined=False))
    assert plain["z"] == 450


def test_a_goal_that_passes_all_tests() -> None:
    """Its bottom line places it on the floor, its centre half its height above that."""
    (goal,) = see([MOUTH], rectangles=[BORDERS])
    assert goal["tests"] == OFTEN | CENTRE_TEST | SIZE_TEST
    below = (107.5 - 119.5) * np.cos(np.radians(10)) + 386 * np.sin(np.radians(10))
    assert goal["measures"] == BY_FLOOR
    assert goal["z"] == pytest.approx(120 * 386 / below - 50 * np.sin(np.radians(10)), abs=1.5)
    (without,) = see([MOUTH])
    assert without["tests"] == OFTEN
    assert without["z"] == pytest.approx(goal["z"], rel=0.03)  # the blob ends a pixel higher


@pytest.mark.parametrize(
    ("box", "circle", "passed"),
    [
        (ROUND | {"colours": RED}, CIRCLE, None),
        (ROUND | {"right": 207}, CIRCLE, COLOUR_TEST),  # too flat
        (ROUND | {"right": 169}, CIRCLE, COLOUR_TEST),  # too narrow
        (ROUND | {"left": 157, "right": 161, "top": 126, "bottom": 130}, CIRCLE, COLOUR_TEST),  # too small
        (ROUND | {"top": 13, "bottom": 64}, CIRCLE, COLOUR_TEST),  # in the sky
        (ROUND | {"top": 178, "bottom": 229}, CIRCLE, COLOUR_TEST),  # near, where it would be larger
        (ROUND | {"pixels": 1500}, CIRCLE, COLOUR_TEST | DIMENSION_TEST),  # a ring, or half hidden aslant
        (ROUND | {"pixels": 2704}, CIRCLE, COLOUR_TEST | DIMENSION_TEST),  # a square
        (ROUND, CIRCLE | {"tests": 0}, OFTEN),
        (ROUND, CIRCLE | {"tests": 1}, OFTEN | CENTRE_TEST),
        (ROUND, CIRCLE | {"blob": 1}, OFTEN),  # of another blob
        (ROUND, CIRCLE | {"radius": 350}, OFTEN | CENTRE_TEST),  # inside the blob
    ],
)
def test_a_ball_that_fails(box: dict[str, int], circle: dict[str, int], passed: int | None) -> None:
    """At each test: it is seen with the accuracy of those before, and only with its direction."""
    found = see([box], [circle], models=(BALL,))
    assert [each["tests"] for each in found] == ([] if passed is None else [passed])
    for each in found:
        assert each["measures"] == 0
        assert each["z"] == 4096
        assert each["accuracy"] < sum(THRESHOLDS.weights[:5])


@pytest.mark.parametrize(
    ("box", "circle", "passed"),
    [
        (ROUND, CIRCLE, True),  # 2083 px by 2123 (T Eq. 2.13)
        (ROUND | {"pixels": 2704}, CIRCLE, False),  # a square as wide
        (ROUND | {"pixels": 1815}, CIRCLE, True),  # a little dented: 1.15
        (ROUND | {"pixels": 1780}, CIRCLE, False),
        (ROUND, CIRCLE | {"radius": 350}, False),  # too small a circle
        (ROUND, CIRCLE | {"tests": 0, "radius": 0}, False),  # none was found
        (ROUND, CIRCLE | {"blob": 1}, False),
    ],
)
def test_the_area_of_the_circle_as_the_thesis_has_it(
    box: dict[str, int], circle: dict[str, int], passed: bool
) -> None:
    """P_a near one, not the share of the square."""
    thresholds = replace(THRESHOLDS, circle_area=True, hidden_arc=0)
    (ball,) = see([box], [circle], models=(BALL,), thresholds=thresholds)
    assert bool(ball["tests"] & AREA_TEST) == passed


# The left third of it: a robot hides the others, but for a bit of outline at the top.
SLICE = ROUND | {"right": 150, "pixels": 600}


def test_a_hidden_ball_whose_outline_tells_its_size() -> None:
    """It has not the dimension, and the place all the same; the tests that failed add nothing."""
    (ball,) = see([SLICE], [SEEN_WELL], models=(BALL,))
    assert ball["tests"] == COLOUR_TEST | CENTRE_TEST | SIZE_TEST
    weights = THRESHOLDS.colour_weight, THRESHOLDS.centre_weight, THRESHOLDS.size_weight
    assert ball["accuracy"] == sum(weights)
    assert (ball["measures"], ball["z"]) == (BY_SIZE, 451)
    (aslant,) = see([ROUND | {"pixels": 1500}], [SEEN_WELL], models=(BALL,))
    assert aslant["tests"] == COLOUR_TEST | DIMENSION_TEST | CENTRE_TEST | SIZE_TEST


@pytest.mark.parametrize(
    ("box", "change", "hidden_arc"),
    [
        (SLICE, {"arc": THRESHOLDS.hidden_arc - 1}, THRESHOLDS.hidden_arc),
        (SLICE, {"tests": 1}, THRESHOLDS.hidden_arc),
        (SLICE, {"x": 2552 + 64}, THRESHOLDS.hidden_arc),  # the blob looks out of it
        (SLICE | {"top": 40, "bottom": 90}, {"y": 1048}, THRESHOLDS.hidden_arc),  # in the sky
        (
            SLICE | {"left": 155, "right": 162, "top": 125, "bottom": 132},
            {"radius": 47},
            THRESHOLDS.hidden_arc,
        ),
        (SLICE, {}, 0),  # not wanted
    ],
)
def test_a_hidden_ball_whose_outline_tells_too_little(
    box: dict[str, int], change: dict[str, int], hidden_arc: int
) -> None:
    """Only the way to it is known."""
    thresholds = replace(THRESHOLDS, hidden_arc=hidden_arc)
    (ball,) = see([box], [SEEN_WELL | change], models=(BALL,), thresholds=thresholds)
    assert ball["tests"] == COLOUR_TEST
    assert ball["measures"] == 0


@pytest.mark.parametrize(
    ("box", "borders", "passed"),
    [
        (MOUTH | {"colours": RED}, BORDERS, None),
        (MOUTH | {"right": 90}, BORDERS, COLOUR_TEST),  # a post alone
        (MOUTH | {"top": 100}, BORDERS, COLOUR_TEST),  # a stripe
        (MOUTH | {"top": 20, "bottom": 50}, BORDERS, COLOUR_TEST),  # above the horizon
        (MOUTH | {"pixels": 4000}, BORDERS, COLOUR_TEST | DIMENSION_TEST),
        (MOUTH, BORDERS | {"bottom": -1}, OFTEN),
        (MOUTH, BORDERS | {"left": -1}, OFTEN | CENTRE_TEST),
        (MOUTH, BORDERS | {"right": -1}, OFTEN | CENTRE_TEST),
    ],
)
def test_a_goal_that_fails(box: dict[str, int], borders: dict[str, int], passed: int | None) -> None:
    """Likewise; one that has its dimension stands on the floor all the same."""
    found = see([box], rectangles=[borders], models=(BLUE_GOAL,))
    assert [each["tests"] for each in found] == ([] if passed is None else [passed])
    for each in found:
        assert (each["measures"] == BY_FLOOR) == bool(each["tests"] & DIMENSION_TEST)


def test_a_mark_hangs_over_the_floor() -> None:
    """Its lower border is at 70 mm: 50 mm below the camera."""
    box = {"colours": RED, "pixels": 5000, "left": 110, "right": 209, "top": 50, "bottom": 116}
    (found,) = see([box], models=MODELS)
    assert found["model"] == MARKER.number
    below = (116.5 - 119.5) * np.cos(np.radians(10)) + 386 * np.sin(np.radians(10))
    assert found["z"] == pytest.approx(50 * 386 / below - 25 * np.sin(np.radians(10)), abs=1.5)


def test_the_model_that_fits_best() -> None:
    """Yellow may be the ball or a goal; the tests tell, and of equal ones the first model is taken."""
    assert [each["model"] for each in see([ROUND], [CIRCLE])] == [BALL.number]
    assert [each["model"] for each in see([MOUTH | {"colours": YELLOW}])] == [YELLOW_GOAL.number]
    sliver = ROUND | {"right": 140}
    assert [each["model"] for each in see([sliver])] == [BALL.number]
    assert [each["model"] for each in see([sliver], models=MODELS[::-1])] == [YELLOW_GOAL.number]


def test_accurate_ones_stay_when_there_is_no_room() -> None:
    """The least accurate one makes way, and what finds no room is counted."""
    sliver = ROUND | {"right": 140}
    found = see([sliver, sliver, ROUND, ROUND, sliver], [CIRCLE | {"blob": 2}], room=2)
    assert [each["accuracy"] for each in found] == [sum(THRESHOLDS.weights[:5]), sum(THRESHOLDS.weights[:3])]


def test_place_for_one_more() -> None:
    """A free record, else the first of the least accurate ones, else none."""
    table = object_words({"accuracy": 5}, {"accuracy": 3}, {"accuracy": 3})
    assert [place_for(table, 2, 9), place_for(table, 3, 9), place_for(table, 3, 3)] == [2, 1, 3]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"colour_weight": 66}, "255 together at most, not 66, 32, 32, 48, 48, 31"),
        ({"size_weight": -1}, "must be 0 or more"),
    ],
)
def test_weights_that_no_byte_holds_are_refused(change: dict[str, int], message: str) -> None:
    """The accuracy is a byte."""
    with pytest.raises(ValueError, match=message):
        replace(THRESHOLDS, **change)
