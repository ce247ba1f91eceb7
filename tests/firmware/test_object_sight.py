"""What a camera sees of objects by itself: each test with a record that passes and one that fails, and the reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.recording import StereoGeometry
from tests.firmware import object_references as references
from tests.firmware.object_rig import (
    HEIGHT,
    THESIS,
    THRESHOLDS,
    WIDTH,
    as_dicts,
    blob_words,
    circle_words,
    geometry_words,
    line_words,
    models_of,
    object_words,
    rectangle_words,
)
from tinyphoon.stages.object_detection import ObjectThresholds
from tinyphoon.stages.object_sight import place_for, see_objects
from tinyphoon.stores.objects import (
    AREA_TEST,
    BY_FLOOR,
    BY_SIZE,
    CENTRE_TEST,
    COLOUR_TEST,
    DIMENSION_TEST,
    OBJECT_WORDS,
    SEEN_LEFT,
    SIZE_TEST,
)
from tinyphoon.strategy.models import BLUE, MODELS, RED, YELLOW

BALL, BLUE_GOAL, YELLOW_GOAL, MARKER = MODELS
OFTEN = COLOUR_TEST | DIMENSION_TEST | AREA_TEST

# A ball 450 mm away: 52 px, on the floor. Its circle, with both tests passed.
ROUND = {"colours": YELLOW, "pixels": 2123, "left": 134, "right": 185, "top": 103, "bottom": 154}
CIRCLE = {"x": 2552, "y": 2056, "radius": 412, "blob": 0, "tests": 3, "arc": 0}
# A goal from the front, its bottom line one px below the blob.
MOUTH = {"colours": BLUE, "pixels": 9000, "left": 60, "right": 260, "top": 60, "bottom": 106}
BORDERS = {"left": 1, "right": 2, "top": -1, "bottom": 0, "blob": 0}
LINES = [(952, 1720, 4168, 1720), (952, 952, 952, 1700), (4168, 1700, 4168, 952)]


def plain_ends(boxes: Sequence[dict[str, int]], rectangle: dict[str, Any]) -> dict[str, Any]:
    """What a rectangle has where both ends are as its blob is, and nothing hides them."""
    box = boxes[rectangle["blob"]] if rectangle["blob"] < len(boxes) else MOUTH
    rows, foot = (box["top"], box["bottom"]), 16 * box["bottom"] + 8
    return {"hidden": 0, "left_rows": rows, "right_rows": rows, "left_foot": foot, "right_foot": foot}


def record_of(rectangle: dict[str, Any]) -> list[int]:
    """The words of a t_Rectangle."""
    lines = [rectangle[name] for name in ("left", "right", "top", "bottom", "blob", "hidden")]
    return [
        *(*lines, *rectangle["left_rows"], *rectangle["right_rows"]),
        *(rectangle["left_foot"], rectangle["right_foot"]),
    ]


def see(
    boxes: list[dict[str, int]],
    circles: list[dict[str, int]] = [],  # noqa: B006
    rectangles: list[dict[str, int]] = [],  # noqa: B006
    *,
    parents: Sequence[int] | None = None,
    lines: Any = LINES,
    models: Any = MODELS,
    thresholds: ObjectThresholds = THRESHOLDS,
    geometry: StereoGeometry = THESIS,
    room: int = 16,
    size: tuple[int, int] = (WIDTH, HEIGHT),
) -> list[dict[str, int]]:
    """What the kernel sees, which must be what the reference sees."""
    words = geometry_words(geometry)
    table = np.full(room * OBJECT_WORDS, 77, np.int16)
    parents = range(len(boxes)) if parents is None else parents
    rounds = [(c["x"], c["y"], c["radius"], c["blob"], 0, 0, 0, c["tests"], c["arc"]) for c in circles]
    rectangles = [plain_ends(boxes, each) | each for each in rectangles]
    found = see_objects(
        *(blob_words(*boxes), np.array(parents, np.uint8), len(boxes), models_of(*models)),
        *(
            circle_words(*rounds),
            len(rounds),
            rectangle_words(*map(record_of, rectangles)),
            len(rectangles),
            line_words(lines),
        ),
        *(words, np.array(thresholds.limits, np.int32), table, SEEN_LEFT, *size),
    )
    scene = (
        boxes,
        parents,
        models,
        circles,
        rectangles,
        lines,
        words.tolist(),
        thresholds,
        SEEN_LEFT,
        size,
        room,
    )
    wanted, count = references.sight(*scene)
    seen = as_dicts(table)
    assert found == count
    assert seen[: len(wanted)] == wanted
    assert not any(each["model"] for each in seen[len(wanted) :])
    return wanted


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
SEEN_WELL = CIRCLE | {"arc": THRESHOLDS.hidden_arc}


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


# The end of a goal, seen from the side of it: its top is 230 mm away, so 151 px are 90 mm.
GOAL_CUT_BELOW = MOUTH | {"left": 100, "right": 250, "top": 86, "bottom": 238}


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


@st.composite
def boxes(draw: st.DrawFn) -> dict[str, int]:
    """Any blob of a picture; balls and goals among them."""
    if draw(st.booleans()):
        nudge = {name: draw(st.integers(-6, 6)) for name in ("left", "right", "top", "bottom")}
        box = {**draw(st.sampled_from([ROUND, MOUTH]))}
        return {name: value + nudge.get(name, 0) for name, value in box.items()}
    left, right = sorted(draw(st.tuples(*[st.integers(1, WIDTH - 2)] * 2)))
    top, bottom = sorted(draw(st.tuples(*[st.integers(1, HEIGHT - 2)] * 2)))
    most = (right - left + 1) * (bottom - top + 1)
    pixels = draw(st.integers(1, most) | st.just(max(most * 201 // 256, 1)))
    colours = draw(st.sampled_from([BLUE, YELLOW, RED, 2]))
    return {"colours": colours, "pixels": pixels, "left": left, "right": right, "top": top, "bottom": bottom}


circles = st.fixed_dictionaries(
    {
        "x": st.integers(0, 16 * WIDTH),
        "y": st.integers(0, 16 * HEIGHT),
        "radius": st.integers(0, 4000),
        "blob": st.integers(0, 4),
        "tests": st.sampled_from([0, 1, 3, 3]),
        "arc": st.sampled_from([0, 84, 85, 256]),
    }
) | st.builds(
    lambda blob, nudge: SEEN_WELL | {"blob": blob, "x": 2552 + nudge}, st.integers(0, 4), st.integers(-99, 99)
)
borders = st.fixed_dictionaries(
    {"left": st.sampled_from([-1, 1]), "right": st.sampled_from([-1, 1]), "top": st.just(-1)}
    | {"bottom": st.integers(-1, 0), "blob": st.integers(0, 4), "hidden": st.integers(0, 3)}
    | {f"{side}_rows": st.tuples(st.integers(0, 120), st.integers(0, 239)) for side in ("left", "right")}
    | {f"{side}_foot": st.integers(0, 16 * HEIGHT) for side in ("left", "right")}
)
level_lines = st.tuples(
    st.integers(0, 2000), st.integers(0, 3800), st.integers(2500, 5000), st.integers(0, 3800)
)
upright_lines = st.tuples(
    st.integers(0, 5000), st.integers(0, 1900), st.integers(0, 5000), st.integers(1900, 3800)
)


@given(
    st.lists(boxes(), max_size=6).flatmap(
        lambda some: st.tuples(
            st.just(some), st.tuples(*[st.integers(at, max(len(some) - 1, 0)) for at in range(len(some))])
        )
    ),
    st.lists(circles, max_size=4),
    st.lists(borders, max_size=4),
    st.tuples(level_lines, upright_lines),
    st.fixed_dictionaries({"refined": st.booleans(), "circle_area": st.booleans()}),
    st.sampled_from([THESIS, StereoGeometry(311, 30, 60, 0), StereoGeometry(772, 60, 300, 45)]),
)
def test_as_the_reference(blobs, circles, rectangles, lines, ways, geometry) -> None:
    """Bit for bit, with any records."""
    thresholds = replace(THRESHOLDS, **ways)
    boxes, parents = blobs
    limits = {"thresholds": thresholds, "geometry": geometry, "room": 4}
    see(boxes, circles, rectangles, parents=parents, lines=lines, **limits)


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
