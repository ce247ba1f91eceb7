"""The object history: who is who from frame to frame, and who is forgotten."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.firmware.objects import history_references as references
from tests.firmware.objects.object_rig import THRESHOLDS, as_dicts, models_of, object_words
from tinyphoon.stages.object_history import AREA_WORDS, age_objects, move_images, remember_objects
from tinyphoon.stores.objects import NO_MODEL
from tinyphoon.strategy.models import MODELS, Shape

HERE = {"model": 1, "x": 100, "y": 0, "z": 1000, "accuracy": 200}
GOAL = HERE | {"model": 2, "accuracy": 96}
GOALS = {each.number for each in MODELS if each.shape == Shape.GOAL}
ROOM = 3


def remember(history, *frames) -> list[dict[str, int]]:
    """The history after frames with these objects, which must be that of the reference."""
    table = object_words(*history, room=ROOM)
    for seen in frames:
        now = object_words(*seen)
        before = as_dicts(table)
        age_objects(table, THRESHOLDS.age_max)
        lost = remember_objects(table, now, models_of(), THRESHOLDS.apart_max)
        ranges = THRESHOLDS.age_max, THRESHOLDS.apart_max
        wanted = references.remembered(before, as_dicts(now), GOALS, *ranges)
        assert (as_dicts(table), lost) == wanted
    return [each for each in as_dicts(table) if each["model"] != NO_MODEL]


def test_seen_again_it_is_the_same() -> None:
    """It has moved a little; the new record takes the old one's place."""
    moved = HERE | {"x": 140, "accuracy": 96}
    (found,) = remember([], [HERE], [moved])
    assert (found["x"], found["accuracy"], found["age"]) == (140, 96, 0)


@pytest.mark.parametrize(("x", "count"), [(410, 1), (420, 2)])
def test_too_far_apart_it_is_another(x: int, count: int) -> None:
    """80/256 of the focal length are 0.3125: 312 mm at 1000 mm."""
    assert len(remember([], [HERE], [HERE | {"x": x}])) == count


def test_another_model_is_another() -> None:
    """Even in the same place."""
    assert [each["age"] for each in remember([], [HERE], [HERE | {"model": 2}])] == [1, 0]


def test_a_direction_is_compared_with_a_place() -> None:
    """By the way they are seen, whatever their distance."""
    assert len(remember([], [HERE], [HERE | {"x": 410, "z": 4096}])) == 1


def test_unseen_it_ages_and_is_forgotten() -> None:
    """It stays for as many frames as the threshold says."""
    for frames in range(THRESHOLDS.age_max + 1):
        (found,) = remember([HERE], *[[]] * frames)
        assert found["age"] == frames
    assert not remember([HERE], *[[]] * (THRESHOLDS.age_max + 1))


def test_two_at_one_place_stay_two() -> None:
    """A record is taken once a frame."""
    assert len(remember([], [HERE, HERE], [HERE, HERE])) == 2


@pytest.mark.parametrize(("accuracy", "x"), [(97, 900), (96, 100), (95, 100)])
def test_there_is_one_goal_of_a_model(accuracy: int, x: int) -> None:
    """Of two in a frame, however far apart, the more accurate one is it, or else the first, which the left camera sees."""
    (found,) = remember([], [GOAL, GOAL | {"x": 900, "accuracy": accuracy}])
    assert (found["x"], found["age"]) == (x, 0)


def test_a_goal_is_where_it_is_seen_now() -> None:
    """However far from there, and however accurate, it was before; a goal of another model is another."""
    (found,) = remember([], [GOAL], [GOAL | {"x": 900, "accuracy": 64}])
    assert (found["x"], found["age"]) == (900, 0)
    assert len(remember([], [GOAL], [GOAL | {"model": 3}])) == 2


def test_a_goal_finds_its_record_in_a_crowd() -> None:
    """Nothing is lost when it is seen again, and nothing else makes way."""
    balls = [HERE, HERE | {"x": 900}]
    found = remember([], [*balls, GOAL], [GOAL, GOAL | {"x": 900}])
    assert [each["age"] for each in found] == [1, 1, 0]


def test_the_oldest_makes_way() -> None:
    """When there is no free record; and what is of this frame never does."""
    crowd = [HERE | {"x": x} for x in (-2000, 0, 2000)]
    found = remember([], [crowd[0]], [crowd[1]], [crowd[2]], [HERE | {"model": 2}])
    assert sorted(each["age"] for each in found) == [0, 1, 2]
    assert len(remember([], [*crowd, HERE | {"model": 2}])) == ROOM


objects = st.fixed_dictionaries(
    {
        "model": st.integers(0, 2),
        "x": st.integers(-32768, 32767),
        "y": st.integers(-32768, 32767),
        "z": st.integers(0, 4000),
        "accuracy": st.integers(0, 3),
    }
)


@given(st.lists(st.lists(objects, max_size=4), max_size=8))
def test_as_the_reference(frames) -> None:
    """Bit for bit, frame after frame."""
    remember([], *frames)


SEEN = {"image_x": 1600, "image_y": 800, "width": 320, "height": 160, "extent": 96}


def moved(*areas: tuple[int, int, int]) -> dict[str, int]:
    """The image of an object seen in the whole picture, after these corners and halvings."""
    table, area = object_words(HERE | SEEN, {}), np.zeros(AREA_WORDS, np.int32)
    for each in areas:
        move_images(table, area, *each)
        assert area.tolist() == [*each]
    return {name: as_dicts(table)[0][name] for name in SEEN}


def test_an_image_moves_with_the_area() -> None:
    """By its corner, to below 0 if it lies before it; and back again."""
    assert moved((0, 0, 0)) == SEEN
    assert moved((20, 60, 0)) == SEEN | {"image_x": 1600 - 320, "image_y": 800 - 960}
    assert moved((20, 60, 0), (4, 3, 0)) == SEEN | {"image_x": 1600 - 64, "image_y": 800 - 48}
    assert moved((20, 60, 0), (0, 0, 0)) == SEEN


def test_an_image_shrinks_with_the_pictures() -> None:
    """All its lengths; the corner counts in the pixels of its own pictures."""
    halved = {name: length // 2 for name, length in SEEN.items()}
    assert moved((0, 0, 1)) == halved
    assert moved((30, 10, 1)) == halved | {"image_x": 800 - 480, "image_y": 400 - 160}
    assert moved((30, 10, 1), (0, 0, 0)) == SEEN
    assert moved((8, 8, 0), (30, 10, 2))["image_x"] == 400 - 480
