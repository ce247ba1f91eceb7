"""Checks of the marks, objects and cameras that a view returns against the types of their fields, long before they are drawn."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cache
from math import isfinite
from numbers import Integral, Real
from typing import Any, get_type_hints

import numpy as np

from bfsim.errors import FirmwareError, shown
from bfsim.seen import (
    Colour,
    SeenArrow,
    SeenBlob,
    SeenCircle,
    SeenGeometry,
    SeenLine,
    SeenLine3D,
    SeenLoss,
    SeenObject,
    SeenRectangle,
    SeenText,
    Solid,
)
from bfsim.seen.frame import CAMERAS
from bfsim.seen.in_pictures import Point
from bfsim.seen.in_space import PointMm

NOUNS: Mapping[type, str] = {
    SeenArrow: "an arrow",
    SeenBlob: "a blob",
    SeenCircle: "a circle",
    SeenGeometry: "the geometry",
    SeenLine: "a line",
    SeenLine3D: "a line in space",
    SeenLoss: "a loss",
    SeenObject: "an object",
    SeenRectangle: "a rectangle",
    SeenText: "a text",
}
"""The classes that are checked here, and what messages call them."""

_RULES: Mapping[str, tuple[str, Callable[[Any], bool]]] = {
    "name": ("words without double quotes, for limits name it between these", lambda value: '"' not in value),
    "focal_px": ("above 0", lambda value: value > 0),
    "radius_px": ("0 or more", lambda value: value >= 0),
    "share": ("0 to 1", lambda value: 0 <= value <= 1),
    "camera": (" or ".join(CAMERAS.values()), lambda value: value in CAMERAS.values()),
}
"""Further conditions of fields, by name."""

_ORDERED = (("left_px", "right_px"), ("top_px", "bottom_px"))
"""Pairs of borders in their order."""


_NO_WORDS = re.compile("[\n\r\ud800-\udfff]")
"""Ends of lines, and halves of characters, which no file can hold."""


def check_fields(mark: Any) -> None:
    """Raise FirmwareError unless each field of a mark is what its class says. Numbers and points may be numpy's."""
    kind: type = type(mark)
    noun = NOUNS[kind]
    for name, words, is_one in _fields(kind):
        value = getattr(mark, name)
        if not is_one(value):
            what = noun if noun.endswith(f" {name}") else f"the {name} of {noun}"
            raise FirmwareError(f"{what} of a view must be {words}, not {shown(value)}")
    for first, last in _ORDERED:
        if hasattr(mark, last) and getattr(mark, last) < getattr(mark, first, getattr(mark, last)):
            least = getattr(mark, first)
            raise FirmwareError(
                f"the {last} of {noun} of a view must be its {first}, {least}, or more, not {getattr(mark, last)}"
            )


def is_line_of_words(value: Any) -> bool:
    """Whether a value is text that can be drawn and listed."""
    return isinstance(value, str) and not _NO_WORDS.search(value)


def is_number(value: Any) -> bool:
    """Whether a value is a number that can be drawn."""
    is_usual = type(value) is float or type(value) is int  # asking an abstract class takes six times as long
    return (is_usual or isinstance(value, Real)) and isfinite(value)


def _is_whole(value: Any) -> bool:
    return type(value) is int or isinstance(value, Integral)


def _is_truth(value: Any) -> bool:
    return isinstance(value, (bool, np.bool_))


def _are(count: int | None, is_one: Callable[[Any], bool]) -> Callable[[Any], bool]:
    """Return a test whether a value is a sequence of `count` such values, or of any number."""

    def are(value: Any) -> bool:
        is_row = isinstance(value, (tuple, list, np.ndarray)) and (count is None or len(value) == count)
        return is_row and all(map(is_one, value))

    return are


def _is_colour(value: Any) -> bool:
    return isinstance(value, tuple) and _are(3, lambda each: _is_whole(each) and 0 <= each <= 255)(value)


def _is_named_numbers(value: Any) -> bool:
    return (
        isinstance(value, dict) and all(map(is_line_of_words, value)) and all(map(_is_whole, value.values()))
    )


_KINDS: Mapping[Any, tuple[str, Callable[[Any], bool]]] = {
    int: ("a whole number", _is_whole),
    float: ("a finite number", is_number),
    bool: ("True or False", _is_truth),
    str: ("words on one line", is_line_of_words),
    Solid: ("a Solid", lambda value: isinstance(value, Solid)),
    Point: ("two numbers, x and y", _are(2, is_number)),
    PointMm: ("three numbers, x, y and z", _are(3, is_number)),
    Colour: ("red, green and blue, 0 to 255", _is_colour),
    tuple[str, ...]: ("a tuple of words", _are(None, is_line_of_words)),
    tuple[int, ...]: ("a tuple of whole numbers", _are(None, _is_whole)),
    dict[str, int]: ("a dict of names and whole numbers", _is_named_numbers),
}
"""Types of fields: what messages call them, and their tests."""


@cache
def _fields(mark: type) -> tuple[tuple[str, str, Callable[[Any], bool]], ...]:
    kinds = [(name, *_KINDS[kind]) for name, kind in get_type_hints(mark).items()]
    return (*kinds, *((name, *_RULES[name]) for name, *_ in kinds if name in _RULES))
