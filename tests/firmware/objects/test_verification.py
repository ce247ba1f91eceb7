"""One object of what both cameras see: which two belong together, and what becomes of them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.firmware.objects import history_references as references
from tests.firmware.objects.object_rig import (
    THESIS,
    THRESHOLDS,
    WIDTH,
    as_dicts,
    geometry_words,
    object_words,
)
from tinyphoon.stages.object_verification import verify_objects
from tinyphoon.stores.objects import (
    BY_DISPARITY,
    BY_FLOOR,
    BY_SIZE,
    NO_MODEL,
    SEEN_LEFT,
    SEEN_RIGHT,
    SIZE_TEST,
    VERIFIED,
)

ROWS, FARTHEST_APART = 16 * THRESHOLDS.row_range, 16 * THRESHOLDS.disparity_max
OFF = 16 * THRESHOLDS.disparity_range
WEIGHTS = THRESHOLDS.camera_weight, THRESHOLDS.size_weight

# A ball 400 mm ahead of the left camera, seen by both: 386 px x 60 mm / 400 mm = 57.9 px, 29.4 px apart.
LEFT = {
    "model": 1, "accuracy": 224, "tests": 31, "cameras": SEEN_LEFT, "measures": BY_SIZE, "x": 0, "y": 0, "z": 400,
    "image_x": 2552, "image_y": 1912, "width": 926, "height": 926, "extent": 926, "outline": 0, "age": 0,
}  # fmt: skip
RIGHT = LEFT | {"cameras": SEEN_RIGHT, "x": -30, "image_x": 2552 - 470, "outline": 3}


def verify(left, right, *, refined: bool = True) -> tuple[list[dict[str, int]], list[dict[str, int]]]:
    """What is left in both tables, which must be what the reference leaves."""
    words = geometry_words()
    tables = object_words(*left), object_words(*right)
    ranges = ROWS, FARTHEST_APART, OFF
    before = as_dicts(tables[0]), as_dicts(tables[1])
    pairs = verify_objects(words, *tables, *ranges, *WEIGHTS, int(refined), WIDTH)
    wanted = references.verified(*before, words.tolist(), ranges, WEIGHTS, refined, WIDTH)
    found = as_dicts(tables[0]), as_dicts(tables[1])
    assert found == wanted
    assert pairs == sum(each["cameras"] == 3 for each in found[0])
    return found


def test_both_see_it() -> None:
    """It is one object, more accurate, and its right half is gone."""
    (one,), (other,) = verify([LEFT], [RIGHT])
    assert one["accuracy"] == 224 + THRESHOLDS.camera_weight
    assert one["cameras"] == SEEN_LEFT | SEEN_RIGHT
    assert one["tests"] & VERIFIED
    assert one["measures"] == BY_SIZE | BY_DISPARITY
    assert (one["x"], one["z"]) == (0, 400)
    assert other["model"] == NO_MODEL


@pytest.mark.parametrize(
    "change",
    [
        {"model": 2},
        {"image_y": 1912 + ROWS + 1},
        {"image_y": 1912 - ROWS - 1},
        {"image_x": 2552 + ROWS + 1},  # farther right in the right picture
        {"image_x": 2552 - FARTHEST_APART - 1},
    ],
)
def test_two_that_are_not_one(change: dict[str, int]) -> None:
    """Another model, another row, an impossible disparity: both stay, the right one in the left camera's frame."""
    (one,), (other,) = verify([LEFT], [RIGHT | change])
    assert one == LEFT
    assert other == RIGHT | change | {"x": 0}


@pytest.mark.parametrize(
    "change",
    [
        {"image_y": 1912 + ROWS},
        {"image_y": 1912 - ROWS},
        {"image_x": 2552 + ROWS},
        {"image_x": 2552 - FARTHEST_APART},
    ],
)
def test_two_that_may_be_one(change: dict[str, int]) -> None:
    """At the ends of the ranges."""
    (one,), _ = verify([LEFT], [RIGHT | change])
    assert one["cameras"] == SEEN_LEFT | SEEN_RIGHT


def test_the_mean_of_both() -> None:
    """The thesis's way: T Table 6.3, d_avr."""
    (one,), _ = verify([LEFT | {"z": 410}], [RIGHT | {"z": 391, "x": -40}], refined=False)
    assert (one["x"], one["z"], one["measures"]) == (-5, 401, BY_SIZE)


def test_disparity_weighs_less_than_size() -> None:
    """58 px against 28 px: 4 to 1. They say 400 mm and 414 mm."""
    near = RIGHT | {"image_x": 2552 - 454}
    (one,), _ = verify([LEFT], [near])
    assert one["z"] == round((58**2 * 400 + 28**2 * 414) / (58**2 + 28**2))


@pytest.mark.parametrize(
    ("off", "agree"), [(0, True), (OFF, True), (-OFF, True), (OFF + 1, False), (-OFF - 1, False)]
)
def test_disparity_and_size(off: int, agree: bool) -> None:
    """Where they disagree the disparity alone places the object along the way to it, and it is less certain by the size's weight."""
    (one,), _ = verify([LEFT | {"x": 40}], [RIGHT | {"x": 10, "image_x": 2552 - 470 + off}])
    assert one["cameras"] == SEEN_LEFT | SEEN_RIGHT
    if agree:
        assert (one["measures"], one["tests"]) == (BY_SIZE | BY_DISPARITY, 31 | VERIFIED)
        assert one["accuracy"] == 224 + THRESHOLDS.camera_weight
    else:
        assert (one["measures"], one["tests"]) == (BY_DISPARITY, 31 & ~SIZE_TEST)
        assert one["accuracy"] == 224 - THRESHOLDS.size_weight
        assert one["z"] == round(386 * 30.47 * 16 / (470 - off))
        assert one["x"] == round(40 * one["z"] / 400)


def test_a_ball_of_another_size() -> None:
    """One half as large again is 600 mm away where the model's would be 400 mm away."""
    (one,), _ = verify([LEFT], [RIGHT | {"image_x": 2552 - 314}])
    assert (one["z"], one["measures"]) == (599, BY_DISPARITY)


def test_no_disparity_of_any_depth() -> None:
    """The size places it, which nothing confirms."""
    (one,), _ = verify([LEFT], [RIGHT | {"image_x": 2552}])
    assert (one["z"], one["measures"], one["accuracy"]) == (400, BY_SIZE, 224 - THRESHOLDS.size_weight)


GOAL_LEFT = LEFT | {"model": 2, "measures": BY_FLOOR, "width": 1600, "height": 640}


@pytest.mark.parametrize(
    ("z", "accuracy", "wanted"),
    [(450, 224, 425), (451, 224, 400), (460, 230, 460), (460, 220, 400), (350, 224, 350)],
)
def test_places_by_the_floor_that_disagree(z: int, accuracy: int, wanted: int) -> None:
    """To an eighth their mean; beyond, that of more tests, of equal ones the nearer; and it is less certain then."""
    (one,), _ = verify([GOAL_LEFT], [GOAL_LEFT | {"z": z, "accuracy": accuracy, "image_x": 2252}])
    assert one["z"] == wanted
    more = THRESHOLDS.camera_weight if wanted == 425 else -THRESHOLDS.size_weight
    assert one["accuracy"] == min(max(accuracy, 224) + more, 255)


def test_the_nearer_place_of_a_goal_that_both_pictures_cut() -> None:
    """What is left of it in one passes all tests, without the post that stands nearer; half of its rows are lacking there."""
    cut = GOAL_LEFT | {"image_x": 4400, "width": 1392}
    other = cut | {"z": 300, "accuracy": 96, "tests": 3, "height": 1280, "image_y": cut["image_y"] + 320}
    (one,), _ = verify([cut], [other])
    assert (one["z"], one["cameras"]) == (300, SEEN_LEFT | SEEN_RIGHT)


def test_rectangles_have_no_disparity() -> None:
    """The border may cut one of the images: the floor alone tells."""
    changes = {"model": 4, "measures": BY_FLOOR}
    (one,), _ = verify([LEFT | changes], [RIGHT | changes | {"image_x": 2552 - 200}])
    assert (one["z"], one["measures"], one["accuracy"]) == (400, BY_FLOOR, 255)


@pytest.mark.parametrize("tests", [31 - SIZE_TEST, 3])
def test_disparity_of_blobs_is_not_trusted(tests: int) -> None:
    """Where a camera has not found the shape, its middle is that of a blob that may be hidden in part."""
    (one,), _ = verify([LEFT], [RIGHT | {"tests": tests, "measures": 0, "z": 4096, "extent": 0}])
    assert one["measures"] == BY_SIZE
    assert one["z"] == 400


def test_only_the_right_one_measures() -> None:
    """Then it places the object; the direction of the left camera is kept where none does."""
    direction = LEFT | {"measures": 0, "extent": 0, "x": 12, "z": 4096, "tests": 7, "accuracy": 128}
    (one,), _ = verify([direction], [RIGHT])
    assert (one["x"], one["z"], one["measures"], one["accuracy"]) == (0, 400, BY_SIZE, 255)
    (one,), _ = verify([direction], [RIGHT | {"measures": 0, "x": -99, "z": 4096}])
    assert (one["x"], one["z"], one["measures"]) == (12, 4096, 0)


def test_each_has_its_own_partner() -> None:
    """The one most like it in row and width; of equal ones the first; and none twice."""
    narrow = RIGHT | {"width": 800}
    left, right = verify([LEFT, LEFT, LEFT], [narrow, RIGHT])
    assert [each["cameras"] for each in left] == [3, 3, SEEN_LEFT]
    assert [each["model"] for each in right] == [NO_MODEL, NO_MODEL]


words = {
    "model": st.integers(0, 4),
    "accuracy": st.integers(0, 255),
    "tests": st.integers(0, 31),
    "measures": st.sampled_from([0, BY_SIZE, BY_FLOOR]),
    "x": st.integers(-16_000, 16_000),
    "y": st.integers(-16_000, 16_000),
    "z": st.integers(-100, 16_000),
    "image_x": st.integers(1000, 3000),
    "image_y": st.integers(1800, 2000),
    "width": st.integers(0, 5000),
    "extent": st.integers(0, 10_000),
}
objects = st.fixed_dictionaries(words)


@given(st.lists(objects, max_size=5), st.lists(objects, max_size=5), st.booleans())
def test_as_the_reference(left, right, refined) -> None:
    """Bit for bit, with any tables."""
    seen = (
        [each | {"cameras": SEEN_LEFT} for each in left],
        [each | {"cameras": SEEN_RIGHT} for each in right],
    )
    verify(*seen, refined=refined)


def test_the_baseline_is_rounded() -> None:
    """30.47 mm are 30."""
    assert THESIS.baseline_mm == 30.47
    _, (other,) = verify([], [RIGHT])
    assert other["x"] == 0
