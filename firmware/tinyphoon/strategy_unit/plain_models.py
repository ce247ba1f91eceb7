"""Models as a script describes them, and their words on the SPI.

    {"name": "ball", "colour": "orange", "diameter_mm": 43}
    {"name": "cone", "shape": "marker", "colour": ["red", "orange"], "width_mm": 40, "height_mm": 60}
    {"name": "crate", "shape": "box", "colour": "green", "width_mm": 120, "height_mm": 70, "depth_mm": 80}
    {"name": "blue goal", "hue_deg": [90, 155], "width_mm": 600}

A name of the indoor field stands for its model, changed by anything else that is given. Any other name is a new model:
it must have a shape, a colour and a size; its number is the first free one, and the rest is as in the first model of
that shape, for boxes as in one of 100 mm. The limits of a blob's width by height follow the size unless they are given.
Names do not go over the SPI: the report describes a new model, "green box 5".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from fractions import Fraction
from functools import reduce
from itertools import count
from math import ceil, floor, hypot
from operator import or_
from typing import Any

from bfsim.api import FirmwareError, cut, shown
from tinyphoon.fields import named_words
from tinyphoon.strategy.colour_names import (
    COLOUR_NAMES,
    NARROWEST_DEG,
    colours_between,
    colours_named,
    width_deg,
)
from tinyphoon.strategy.models import BOX, LARGEST_ASPECT, MODELS, ObjectModel, Shape

BY_NAME = {each.name: each for each in MODELS}
FIELDS = tuple(each.name for each in fields(ObjectModel) if each.name != "name")
COLOUR_KEYS = "colour", "hue_deg", "colours"
KEYS = (*FIELDS, "colour", "hue_deg", "diameter_mm")
SIDES = "width_mm", "height_mm", "depth_mm"


def words_of_models(models: Sequence[object], at: str) -> list[int]:
    """Return the words of models, one after the other. Raises FirmwareError that names the model or its key `at`."""
    given = [{"name": each} if isinstance(each, str) and each in BY_NAME else each for each in models]
    numbers = {each.number for each in MODELS}
    numbers |= {
        each["number"] for each in given if isinstance(each, Mapping) and _is_whole(each.get("number"))
    }
    free = (number for number in count(1) if number not in numbers)
    return [word for number, each in enumerate(given) for word in _words(each, f"{at}.{number}", free)]


def _words(given: object, at: str, free: Iterator[int]) -> list[int]:
    if not isinstance(given, Mapping):
        raise _no_model(given, at)
    base, is_new = _base(given, at)
    if unknown := [key for key in given if key not in (*KEYS, "name")]:
        raise FirmwareError(f"{at}.{cut(str(unknown[0]))} must be one of {', '.join(KEYS)}")
    named = {key: given[key] for key in FIELDS if key in given}
    named |= _colours(given, at, needed=is_new)
    named |= _size(given, base, at, needed=is_new)
    if is_new and "number" not in named:
        named["number"] = next(free)
    return named_words(base, _aspects(base, named) | named, at)


def _no_model(given: object, at: str) -> FirmwareError:
    return FirmwareError(
        f"{at} must be or have the name of one of {', '.join(BY_NAME)}, or a name, a shape, a colour and a size "
        f"of its own, not be {shown(given)}"
    )


def _base(given: Mapping[str, Any], at: str) -> tuple[ObjectModel, bool]:
    """Return the model that `given` changes, and whether it is only the template of a new one."""
    name = given.get("name")
    if isinstance(name, str) and name in BY_NAME:
        return BY_NAME[name], False
    if not isinstance(name, str) or "shape" not in given:
        raise _no_model(given, at)
    for each in (*MODELS, BOX):
        if _is_shape(given["shape"], each.shape):
            return each, True
    names = ", ".join(each.name.lower() for each in Shape)
    raise FirmwareError(f"{at}.shape must be one of {names}, not {shown(given['shape'])}")


def _is_shape(value: object, shape: Shape) -> bool:
    """Whether a script's value means `shape`: by its name in any case, or by its number."""
    return value.upper() == shape.name if isinstance(value, str) else value == shape


def _colours(given: Mapping[str, Any], at: str, *, needed: bool) -> dict[str, int]:
    """Return the colours of a model, given by name or by hue."""
    found = [key for key in COLOUR_KEYS if key in given]
    if len(found) > 1 or (needed and not found):
        raise FirmwareError(
            f"{at} must have one of {', '.join(COLOUR_KEYS)}, not {' and '.join(found) or 'none'}"
        )
    if "colour" in found:
        return {"colours": _by_name(given["colour"], f"{at}.colour")}
    if "hue_deg" in found:
        return {"colours": _by_hue(given["hue_deg"], f"{at}.hue_deg")}
    return {}


def _by_name(value: object, at: str) -> int:
    names = value if isinstance(value, list) else [value]
    if not names or not all(isinstance(each, str) and each in COLOUR_NAMES for each in names):
        raise FirmwareError(
            f"{at} must be one of {', '.join(COLOUR_NAMES)}, or a list of them, not {shown(value)}"
        )
    return reduce(or_, map(colours_named, names))


def _by_hue(value: object, at: str) -> int:
    if (
        not isinstance(value, list)
        or len(value) != 2
        or not all(isinstance(each, int | float) and 0 <= each <= 360 for each in value)
        or width_deg(*value) < NARROWEST_DEG
    ):
        raise FirmwareError(
            f"{at} must be [from, to] in degrees of the firmware's colour circle, 0 to 360, {NARROWEST_DEG} or more "
            f"apart, not {shown(value)}"
        )
    return colours_between(*value)


def _size(given: Mapping[str, Any], base: ObjectModel, at: str, *, needed: bool) -> dict[str, Any]:
    """Return the sides of a model. A single number gives all sides of a ball; only boxes need a depth."""
    is_ball = _is_shape(given.get("shape", base.shape), Shape.BALL)
    is_box = _is_shape(given.get("shape", base.shape), Shape.BOX)
    sides = {key: given[key] for key in SIDES if key in given}
    if "diameter_mm" in given and (sides or not is_ball):
        raise FirmwareError(
            f"{at}.diameter_mm must be the only size, and that of a ball; others have width_mm and height_mm"
        )
    if "diameter_mm" in given:
        if not isinstance(given["diameter_mm"], int):
            raise FirmwareError(f"{at}.diameter_mm must be a whole number, not {shown(given['diameter_mm'])}")
        return dict.fromkeys(SIDES, given["diameter_mm"])
    if is_ball and sides:
        return dict.fromkeys(SIDES, next(iter(sides.values()))) | sides
    wanted = SIDES if is_box else SIDES[:2]
    missing = ("diameter_mm",) if is_ball else [key for key in wanted if key not in sides]
    if needed and missing:
        raise FirmwareError(f"the key {at}.{missing[0]} must be there")
    if needed and not is_box:
        sides.setdefault("depth_mm", sides["width_mm"])
    return sides


def _aspects(base: ObjectModel, named: Mapping[str, Any]) -> dict[str, int]:
    """Return the limits of width by height: those of `base`, scaled with the proportions of the model.

    A box looks narrowest from its shorter side and widest along its diagonal.
    """
    width, height, depth = (named.get(key, getattr(base, key)) for key in SIDES)
    if not all(map(_is_whole, (width, height, depth))):
        return {}
    least = most = Fraction(width * base.height_mm, height * base.width_mm)
    if base.shape == Shape.BOX:
        least = Fraction(min(width, depth) * base.height_mm, height * base.width_mm)
        diagonal = Fraction(hypot(width, depth) / hypot(base.width_mm, base.depth_mm))
        most = diagonal * Fraction(base.height_mm, height)
    least, most = floor(base.aspect_min * least), ceil(base.aspect_max * most)
    return {"aspect_min": min(max(least, 1), LARGEST_ASPECT), "aspect_max": min(max(most, 1), LARGEST_ASPECT)}


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and value > 0
