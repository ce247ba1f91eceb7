"""The object models: as words, and refused where they contradict themselves or one another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bfsim.api import FirmwareError
from tinyphoon.scenes.soccer import BALL as TRUE_BALL
from tinyphoon.scenes.soccer import GOAL as TRUE_GOAL
from tinyphoon.scenes.soccer import ROBOT as TRUE_ROBOT
from tinyphoon.strategy.models import (
    ALL_COLOURS,
    BLUE,
    MODEL_CAPACITY,
    MODEL_WORDS,
    MODELS,
    RED,
    YELLOW,
    Shape,
    check_models,
    colour_groups,
    colours_of,
    model_words,
)
from tinyphoon.strategy.modes import INDOOR_FIELD

BALL, BLUE_GOAL, YELLOW_GOAL, MARKER = MODELS


def test_sizes_are_those_of_the_things() -> None:
    """The firmware knows what the rules say, and the scenes are built by the same rules."""
    assert BALL.width_mm == 2 * TRUE_BALL.radius_mm
    assert (BLUE_GOAL.width_mm, BLUE_GOAL.height_mm) == (TRUE_GOAL.width_mm, TRUE_GOAL.height_mm)
    assert BLUE_GOAL.depth_mm == TRUE_GOAL.depth_mm
    assert (MARKER.width_mm, MARKER.depth_mm) == (TRUE_ROBOT.side_mm, TRUE_ROBOT.side_mm)
    assert MARKER.height_mm == TRUE_ROBOT.mark_height_mm
    assert MARKER.floor_mm == TRUE_ROBOT.body_height_mm


def test_words() -> None:
    """A model is nine words in their order; what is left of the buffer has number 0."""
    words = model_words(MODELS).reshape(MODEL_CAPACITY, MODEL_WORDS)
    assert words[3].tolist() == [4, 3, RED, 75, 50, 75, 70, 16, 40]
    assert not words[len(MODELS) :].any()


def test_colours_come_from_the_models() -> None:
    """Each group once; the segmentation looks for those of the models and nothing else."""
    assert colour_groups(MODELS) == (BLUE, YELLOW, RED)
    assert INDOOR_FIELD.blobs.colour_groups == colour_groups(INDOOR_FIELD.models)
    assert colours_of(MODELS, Shape.BALL) == YELLOW
    assert colours_of(MODELS, Shape.GOAL, Shape.MARKER) == BLUE | YELLOW | RED
    assert colours_of([MARKER], Shape.BALL) == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"number": 0}, "model ball: number must be 1 to 255, not 0"),
        ({"number": 256}, "number must be 1 to 255, not 256"),
        ({"shape": 7}, r"shape must be one of 1 \(BALL\), 2 \(GOAL\), 3 \(MARKER\), 4 \(BOX\), not 7"),
        ({"colours": 0}, "colours must be bits of 0x7FFFFFFE, not 0x00000000"),
        ({"colours": 1}, "colours must be bits of 0x7FFFFFFE, not 0x00000001"),
        ({"colours": 1 << 31}, "not 0x80000000"),
        ({"width_mm": 0}, "width_mm must be 1 to 4000, not 0"),
        ({"height_mm": 4001}, "height_mm must be 1 to 4000, not 4001"),
        ({"floor_mm": -1}, "floor_mm must be 0 to 4000, not -1"),
        ({"aspect_min": 30}, "aspects must be a range within 1 to 512, not 30 to 21"),
        ({"aspect_min": 0}, "not 0 to 21"),
        ({"height_mm": 61}, "model ball: a ball must be as high and as deep as wide, not 60 x 61 x 60 mm"),
        ({"depth_mm": 59}, "not 60 x 60 x 59 mm"),
        ({"depth_mm": 0}, "depth_mm must be 1 to 4000, not 0"),
    ],
)
def test_a_model_that_contradicts_itself_is_refused(change: dict[str, int], message: str) -> None:
    """With what it must be, what it is, and its name."""
    with pytest.raises(FirmwareError, match=message):
        replace(BALL, **change)


@pytest.mark.parametrize(
    ("models", "message"),
    [
        ((), "there must be 1 to 8 models, not 0"),
        (tuple(replace(BALL, number=1 + each, colours=2 << each) for each in range(9)), "to 8 models, not 9"),
        ((BALL, replace(MARKER, number=1)), "models ball and robot marker must have different numbers, not both 1"),
        (
            (BALL, replace(MARKER, colours=YELLOW | RED)),
            "must have all colours in common or none, not 0x07000000 of 0x07000000 and 0x77000000",
        ),
        ((BLUE_GOAL, replace(BLUE_GOAL, name="other", number=9)), "must differ in colour or shape"),
    ],
)  # fmt: skip
def test_models_that_contradict_one_another_are_refused(models: tuple, message: str) -> None:
    """Both are named."""
    with pytest.raises(FirmwareError, match=message):
        check_models(models)
    with pytest.raises(FirmwareError, match=message):
        model_words(models)


def test_limits_are_no_contradiction() -> None:
    """What is just allowed is taken, and every word of it fits."""
    sizes = dict.fromkeys(("width_mm", "height_mm", "depth_mm", "floor_mm"), 4000)
    largest = replace(BALL, number=255, colours=ALL_COLOURS, aspect_max=512, **sizes)
    assert model_words([largest]).dtype == np.int32
