"""Dataclasses as words: there and back, by name, and every mistake in the names."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.api import FirmwareError
from tinyphoon.fields import (
    HIGHEST,
    LOWEST,
    Word,
    allowed,
    from_words,
    named_words,
    not_ordered,
    to_words,
    words_of,
)


class Colour(IntEnum):
    """Some numbers with names."""

    RED = 1
    BLUE = 2


@dataclass(frozen=True, kw_only=True)
class Part:
    """A part of the whole."""

    low: int = allowed(0, 9, at_most="high")
    high: int = allowed(0, 9)
    even: int = allowed(-4, 4, step=2, default=2)


@dataclass(frozen=True, kw_only=True)
class Whole:
    """Every kind of field that there is."""

    name: str
    part: Part
    any_number: int
    size: Literal[3, 5]
    is_dark: bool
    colour: Colour
    derived: tuple[int, ...] = not_ordered()


WHOLE = Whole(
    name="x", part=Part(low=1, high=2), any_number=-7, size=3, is_dark=True, colour=Colour.BLUE, derived=(5,)
)
NUMBERS = st.integers(LOWEST, HIGHEST)


def test_words_come_in_the_order_of_the_fields_with_what_they_may_be() -> None:
    """What has no limits may be anything; a choice has the limits of its members."""
    assert words_of(Whole) == (
        Word(name="part.low", lowest=0, highest=9, at_most="part.high"),
        Word(name="part.high", lowest=0, highest=9, at_most="part.high"),
        Word(name="part.even", lowest=-4, highest=4, step=2, at_most="part.even"),
        Word(name="any_number", lowest=LOWEST, highest=HIGHEST, at_most="any_number"),
        Word(name="size", lowest=3, highest=5, step=2, at_most="size"),
        Word(name="is_dark", lowest=0, highest=1, at_most="is_dark"),
        Word(name="colour", lowest=1, highest=2, at_most="colour"),
    )
    assert to_words(WHOLE) == [1, 2, 2, -7, 3, 1, 2]


@given(NUMBERS, NUMBERS, NUMBERS, st.sampled_from([3, 5]), st.booleans(), st.sampled_from(Colour))
def test_there_and_back(
    low: int, any_number: int, even: int, size: Any, is_dark: bool, colour: Colour
) -> None:
    """Types come back too; what is no word stays that of the base."""
    part = Part(low=low, high=3, even=even)
    whole = Whole(
        name="x", part=part, any_number=any_number, size=size, is_dark=is_dark, colour=colour, derived=(5,)
    )
    back = from_words(WHOLE, to_words(whole))
    assert back == whole
    assert (type(back.is_dark), type(back.colour)) == (bool, Colour)


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ({}, [1, 2, 2, -7, 3, 1, 2]),
        ({"size": 5, "part": {"high": 8}}, [1, 8, 2, -7, 5, 1, 2]),
        ({"part": [7, 8, 0], "is_dark": False}, [7, 8, 0, -7, 3, 0, 2]),
        ({"colour": "red"}, [1, 2, 2, -7, 3, 1, 1]),
        ({"part": {"low": 99}, "size": 4}, [99, 2, 2, -7, 4, 1, 2]),  # the receiver judges
    ],
)
def test_names(names: object, words: list[int]) -> None:
    """What is not named stays; a list names all fields of a part."""
    assert named_words(WHOLE, names, "whole") == words


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ({"sise": 3}, "whole.sise must be one of part, any_number, size, is_dark, colour$"),
        ({"name": "y"}, "whole.name must be one of part, "),
        ({"derived": [3]}, "whole.derived must be one of part, "),
        ({"part": {"hihg": 3}}, "whole.part.hihg must be one of low, high, even$"),
        ({"part": [1, 2]}, r"whole.part must be 3 numbers \(low, high, even\), not 2"),
        ({"part": 3}, "whole.part must have some of low, high, even, not be 3"),
        (7, "whole must have some of part, .*, not be 7"),
        ({"size": "3"}, "whole.size must be a whole number of 32 bits, not '3'"),
        ({"any_number": 1.5}, "whole.any_number must be a whole number of 32 bits, not 1.5"),
        ({"any_number": 1 << 31}, "whole.any_number must be a whole number of 32 bits, not 2147483648"),
        ({"colour": "green"}, "whole.colour must be one of red, blue, not 'green'"),
    ],
)
def test_mistakes_in_names(names: object, message: str) -> None:
    """The field, and what it must be."""
    with pytest.raises(FirmwareError, match=message):
        named_words(WHOLE, names, "whole")


def test_fields_that_are_no_words_are_found_when_the_firmware_is_made() -> None:
    """By whoever adds them."""

    @dataclass
    class Odd:
        values: tuple[int, ...] = field(default=())

    @dataclass
    class Uneven:
        size: Literal[1, 2, 5]  # type: ignore[valid-type]

    globals()["Odd"], globals()["Uneven"] = Odd, Uneven
    with pytest.raises(TypeError, match="must be a number or a dataclass of numbers, not tuple"):
        words_of(Odd)
    with pytest.raises(TypeError, match="size must be a number or a choice of evenly spaced ones"):
        words_of(Uneven)
