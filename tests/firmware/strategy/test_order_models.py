"""Models of objects from the strategy unit: there and back, and every way to be refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.api import FirmwareError
from tests.firmware.strategy.order_messages import GOOD, framed, model, refusal_of_models
from tinyphoon.fields import to_words
from tinyphoon.strategy import order_checks as checks
from tinyphoon.strategy.colour_names import colours_between, colours_named
from tinyphoon.strategy.models import MODEL_CAPACITY, MODEL_WORDS, MODELS, ObjectModel, Shape, check_models
from tinyphoon.strategy.order_checks import WHICH_BIT
from tinyphoon.strategy.orders import mode_in, store_order
from tinyphoon.strategy_unit.messages import MessageType
from tinyphoon.strategy_unit.payloads import models_payload, payload


def test_models_there_and_back() -> None:
    """Those of the indoor field, and some of them."""
    for models in (MODELS, MODELS[:1], MODELS[2:]):
        words = [to_words(each) for each in models]
        assert refusal_of_models(words) == 0
        stored = np.full(MODEL_CAPACITY * MODEL_WORDS, 77, np.int32)
        store_order(framed(MessageType.MODELS, [word for each in words for word in each]), stored)
        mode = mode_in(np.array(GOOD), stored)
        assert mode.models == models
        assert mode.blobs.colour_groups == tuple(sorted({each.colours for each in models}))


def test_a_new_model_is_called_by_what_it_is() -> None:
    """Its name does not go over the SPI; those of the indoor field are known by their numbers."""
    models = (
        MODELS[0],
        replace(MODELS[0], number=7, colours=colours_named("purple")),
        replace(MODELS[-1], number=9, colours=colours_named("green") | colours_between(150, 165)),
    )
    stored = np.zeros((MODEL_CAPACITY, MODEL_WORDS), np.int32)
    stored[: len(models)] = [to_words(each) for each in models]
    names = [each.name for each in mode_in(np.array(GOOD), stored.ravel()).models]
    assert names == ["ball", "purple ball 7", "green or cyan marker 9"]


@pytest.mark.parametrize(
    ("records", "refusal"),
    [
        ([model(1), model(2)], 0),
        ([model(1, shape=1, height_mm=50)], 0),
        ([model(1, shape=1, height_mm=50, depth_mm=40)], checks.BALL_SIZE),
        ([model(1, shape=4, depth_mm=40)], 0),
        ([model(1), model(2), model(3, shape=1)], checks.BALL_SIZE | 2 << WHICH_BIT),
        ([model(1), model(1, colours=4)], checks.SAME_NUMBER | 1 << WHICH_BIT),
        ([model(1, colours=6), model(2, colours=6, shape=2)], 0),
        ([model(1, colours=6), model(2, colours=2)], checks.SHARED_COLOURS | 1 << WHICH_BIT),
        ([model(1, colours=6), model(2, colours=6)], checks.SAME_MODEL | 1 << WHICH_BIT),
        ([model(1), model(2, aspect_min=33)], checks.ABOVE | 16 << WHICH_BIT),
        ([model(1), model(2, width_mm=0)], checks.RANGE | 12 << WHICH_BIT),
        ([model(1, colours=3)], checks.RANGE | 2 << WHICH_BIT),
        ([model(1)[:7]], checks.LENGTH),
        ([], checks.LENGTH),
        ([model(each) for each in range(1, 9)], 0),
        ([model(each) for each in range(1, 10)], checks.LENGTH),
    ],
)
def test_models_that_contradict_themselves_are_refused(records: list[list[int]], refusal: int) -> None:
    """Each by itself, and with those before it."""
    assert refusal_of_models(records) == refusal


@given(st.lists(st.builds(model, st.integers(1, 4), shape=st.integers(1, 4), colours=st.sampled_from([2, 4, 6]),
                          height_mm=st.sampled_from([40, 50]), aspect_min=st.sampled_from([16, 33])),
                min_size=1, max_size=4))  # fmt: skip
def test_the_chip_refuses_the_models_that_the_host_refuses(records: list[list[int]]) -> None:
    """The kernels and `check_models` have the same rules."""
    try:
        names = (
            "number",
            "shape",
            "colours",
            "width_mm",
            "height_mm",
            "depth_mm",
            "floor_mm",
            "aspect_min",
            "aspect_max",
        )
        made = [dict(zip(names, each, strict=True)) for each in records]
        check_models([ObjectModel(name="?", **{**each, "shape": Shape(each["shape"])}) for each in made])
    except FirmwareError:
        assert refusal_of_models(records) != 0
    else:
        assert refusal_of_models(records) == 0


def test_models_by_name() -> None:
    """A name alone is that model; with fields it is changed."""
    ball = to_words(MODELS[0])
    assert models_payload(["ball"]) == payload(ball)
    assert models_payload([{"name": "ball", "number": 9, "shape": "marker"}]) == payload([9, 3, *ball[2:]])


@pytest.mark.parametrize(
    ("models", "message"),
    [
        ("ball", "models must be a list of them, not 'ball'"),
        ([], "models must be a list of them"),
        (["bal"], "models.0 must be or have the name of one of ball, blue goal, .*, not be 'bal'"),
        ([{"name": ["ball"]}], "models.0 must be or have the name of one of ball, .*, not be {'name': "),
        (["ball", {"number": 3}], "models.1 must be or have the name of one of ball"),
        ([{"name": "ball", "with_mm": 3}], "models.0.with_mm must be one of number, shape"),
    ],
)
def test_mistakes_in_models(models: object, message: str) -> None:
    """The entry, the field, what it must be."""
    with pytest.raises(FirmwareError, match=message):
        models_payload(models)
