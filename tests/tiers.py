"""Cases that plain `pytest` leaves out: `pytest -m exhaustive` has them."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import is_hypothesis_test, settings


def exhaustive(*cases: Any) -> list[Any]:
    """Return cases of a parameter, or of several as tuples, with the mark; a tuple of one is that one."""
    return [
        pytest.param(*(each if isinstance(each, tuple) else (each,)), marks=pytest.mark.exhaustive)
        for each in cases
    ]


def tried(few: int, many: int) -> pytest.MarkDecorator:
    """Call a test with how many `examples` to try of a property that is slow to try."""
    return pytest.mark.parametrize("examples", [few, *exhaustive(many)])


def leaves_examples_open(test: object) -> bool:
    """Tell whether a test is a property that does not say on how many examples it is tried."""
    own = getattr(test, "_hypothesis_internal_use_settings", settings())
    return is_hypothesis_test(test) and own.max_examples == settings().max_examples
