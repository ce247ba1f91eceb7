"""Models in plain words: colours by name and in degrees, sizes in one number, models of one's own, and mistakes."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageColor

from bfsim.api import FirmwareError
from tests.firmware.colours.test_kernels import reduced
from tests.firmware.strategy.order_messages import refusal_of_models
from tinyphoon.stages.colour_reduction import BLACK, WHITE
from tinyphoon.strategy.colour_names import NAMED_DEG, colours_between, colours_named
from tinyphoon.strategy.models import ALL_COLOURS, MODELS, Shape
from tinyphoon.strategy_unit.plain_models import FIELDS, words_of_models

HUES = ALL_COLOURS & ~(BLACK | WHITE)


def fields_of(*models: object) -> list[dict[str, int]]:
    """Return the fields of models in plain words; the firmware must take them."""
    words = words_of_models(models, "models")
    records = [words[at : at + len(FIELDS)] for at in range(0, len(words), len(FIELDS))]
    assert refusal_of_models(records) == 0
    return [dict(zip(FIELDS, each, strict=True)) for each in records]


def test_a_ball_in_words() -> None:
    """Colour and diameter change those of the ball; what is not given stays."""
    (ball,) = fields_of({"name": "ball", "shape": "ball", "colour": "orange", "diameter_mm": 43})
    assert (ball["width_mm"], ball["height_mm"], ball["number"], ball["shape"]) == (43, 43, 1, Shape.BALL)
    assert ball["colours"] == colours_named("orange")
    assert (ball["aspect_min"], ball["aspect_max"]) == (MODELS[0].aspect_min, MODELS[0].aspect_max)


@pytest.mark.parametrize("size", ["width_mm", "height_mm", "diameter_mm"])
def test_one_number_is_the_size_of_a_ball(size: str) -> None:
    """Width alone, height alone, or its diameter."""
    (ball,) = fields_of({"name": "ball", size: 43})
    assert (ball["width_mm"], ball["height_mm"]) == (43, 43)


@pytest.mark.parametrize(
    ("name", "colours"),
    [
        ("red", ["red", "crimson", "firebrick", "darkred"]),
        ("orange", ["orange", "darkorange", "orangered", "coral", "chocolate", "#ff7800", "#c05a28"]),
        ("yellow", ["yellow", "gold", "khaki", "olive"]),
        ("green", ["lime", "green", "forestgreen", "limegreen", "palegreen"]),
        ("cyan", ["cyan", "teal", "turquoise"]),
        ("blue", ["blue", "navy", "royalblue", "dodgerblue", "cornflowerblue"]),
        ("purple", ["blueviolet", "indigo", "rebeccapurple"]),
        ("magenta", ["magenta", "orchid", "mediumvioletred"]),
    ],
)
def test_things_have_the_colour_of_their_name(name: str, colours: list[str]) -> None:
    """Colours of CSS, light and dark, as the colour reduction sees them without thresholds."""
    for colour in colours:
        y, u, v = Image.new("RGB", (2, 2), ImageColor.getrgb(colour)[:3]).convert("YCbCr").getpixel((0, 0))  # type: ignore[misc]
        (seen, _) = reduced(np.array([u, y, v, y], np.uint8), -182, 255)
        assert int(seen) & colours_named(name), colour


def test_names_share_no_hue_and_leave_none_out() -> None:
    """So models of any two names go together."""
    named = [colours_named(each) for each in NAMED_DEG]
    assert all(one & other == 0 for one, other in combinations(named, 2))
    assert sum(named) == HUES
    assert (colours_named("black"), colours_named("white")) == (BLACK, WHITE)


def test_hues_in_degrees() -> None:
    """Those whose middles lie in the range, which may go on past 360."""
    assert colours_between(0, 360) == HUES
    assert colours_between(*NAMED_DEG["red"]) == 1 << 3 | 1 << 29 | 1 << 30
    assert all(colours_between(first, (first + 13) % 360) for first in range(360))
    (ball,) = fields_of({"name": "ball", "hue_deg": [296, 334]})
    assert ball["colours"] == colours_named("orange")


def test_several_names_are_one_group() -> None:
    """A list of names has the hues of all."""
    (ball,) = fields_of({"name": "ball", "colour": ["red", "orange"]})
    assert ball["colours"] == colours_named("red") | colours_named("orange")


def test_models_of_ones_own() -> None:
    """Free numbers, the shape's floor, and limits of width by height as wide as the thing is."""
    cone, own, post = fields_of(
        {"name": "cone", "shape": "marker", "colour": "orange", "width_mm": 50, "height_mm": 100},
        {"name": "small", "shape": "ball", "colour": "green", "diameter_mm": 40, "number": 5},
        {
            "name": "post",
            "shape": 2,
            "hue_deg": [90, 141],
            "width_mm": 800,
            "height_mm": 100,
            "aspect_min": 7,
        },
    )
    assert [each["number"] for each in (cone, own, post)] == [6, 5, 7]
    assert (cone["aspect_min"], cone["aspect_max"]) == (5, 14)
    assert (post["aspect_min"], post["aspect_max"]) == (7, 192)


def test_a_known_model_of_another_size_is_as_much_wider() -> None:
    """A goal twice as wide may look twice as wide."""
    (goal,) = fields_of({"name": "blue goal", "width_mm": 800})
    assert (goal["width_mm"], goal["height_mm"]) == (800, 100)
    assert (goal["aspect_min"], goal["aspect_max"]) == (24, 192)


@pytest.mark.parametrize(
    ("model", "message"),
    [
        ({"name": "ball", "colour": "organe"}, "m.0.colour must be one of red, orange, .* white, or a list of them, not 'organe'"),
        ({"name": "ball", "colour": []}, r"m.0.colour must be one of red, .*, not \[\]"),
        ({"name": "ball", "colour": "red", "hue_deg": [0, 90]}, "m.0 must have one of colour, hue_deg, colours, not colour and hue_deg"),
        ({"name": "ball", "hue_deg": 30}, r"m.0.hue_deg must be \[from, to\] in degrees .* 13 or more apart, not 30"),
        ({"name": "ball", "hue_deg": [20, 30]}, r"13 or more apart, not \[20, 30\]"),
        ({"name": "ball", "hue_deg": [20, 400]}, "0 to 360"),
        ({"name": "ball", "diameter_mm": 43, "width_mm": 43}, "m.0.diameter_mm must be the only size, and that of a ball"),
        ({"name": "blue goal", "diameter_mm": 43}, "m.0.diameter_mm must be the only size, and that of a ball"),
        ({"name": "ball", "diameter_mm": "43"}, "m.0.diameter_mm must be a whole number, not '43'"),
        ({"name": "cone", "colour": "red"}, "m.0 must be or have the name of one of ball, .* a shape, a colour and a size"),
        ({"name": "cone", "shape": "round"}, "m.0.shape must be one of ball, goal, marker, box, not 'round'"),
        ({"name": "cone", "shape": "marker"}, "m.0 must have one of colour, hue_deg, colours, not none"),
        ({"name": "cone", "shape": "marker", "colour": "red", "width_mm": 3}, "the key m.0.height_mm must be there"),
        ({"name": "cone", "shape": "box", "colour": "red", "width_mm": 3, "height_mm": 3}, "the key m.0.depth_mm must be there"),
        ({"name": "b", "shape": "ball", "colour": "red"}, "the key m.0.diameter_mm must be there"),
    ],
)  # fmt: skip
def test_mistakes(model: dict[str, Any], message: str) -> None:
    """The key, what it must be, and what it is."""
    with pytest.raises(FirmwareError, match=message):
        words_of_models([model], "m")
