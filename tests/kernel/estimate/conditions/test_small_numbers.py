"""Tests of what is never negative for small numbers: which are immediates, which are likely, and what was shifted down. Up to 75 % too dear."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.kernel import VDSP_O2
from bfsim.kernel.estimate.prediction.predict import Likelihood
from bfsim.kernel.rules import Rule
from tests.kernel.beside_gcc import Case, beside_gcc
from tests.kernel.lowered import context

SHAPE = """
def f(a: {array}[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        v = {value}
        s += v
        if {test}:
            s ^= t
    return s
"""


def _case(cycles: int, test: str, value: str, array: str = "i32") -> Case:
    return SHAPE.format(array=array, value=value, test=test), cycles, 0.01


CASES = {
    "a counter below two": _case(1042, "i < 2", "a[i]"),
    "a counter below five is compared with a register": _case(2039, "i < 5", "a[i]"),
    "a counter from four on": _case(1448, "i > 4", "a[i]"),
    "a byte below six is compared with a number": _case(3823, "v < 6", "a[i]", "u8"),
    "a masked word below six": _case(4240, "v < 6", "a[i] & 1023"),
    "a byte from two on": _case(3216, "v >= 2", "a[i]", "u8"),
    "a shifted half-word below six": _case(4193, "v < 6", "a[i] >> 4", "u16"),
    "a shifted half-word above four": _case(4858, "v > 4", "a[i] >> 4", "u16"),
    "a shifted half-word from two on": _case(3499, "v >= 2", "a[i] >> 4", "u16"),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)


@pytest.mark.parametrize("number", [2, 3])
def test_only_gcc_guesses_by_numbers_that_it_makes_small(number: int, tmp_path: Path) -> None:
    """`v < 2` is `v <= 1` to it; a comparison with 3 stays one, and other compilers are not known to guess by either."""
    text = SHAPE.format(array="i32", value="a[i]", test=f"v < {number}")
    flow = context(text, tmp_path).flow
    guessed, without = (Likelihood(flow, without=rules).taken for rules in ((), (Rule.SMALL_NUMBERS,)))
    assert (guessed != without) is (number == 2)
    assert not VDSP_O2.applies(Rule.SMALL_NUMBERS)
