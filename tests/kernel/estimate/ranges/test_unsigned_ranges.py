"""Ranges of words: what is computed of numbers within ranges lies within the range that is found, and what loops and tests say is known."""

from __future__ import annotations

import operator
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.kernel.estimate.ranges.range_arithmetic import ANY, COMPUTED, WORDS, Range, within
from bfsim.kernel.estimate.ranges.unsigned_ranges import UnsignedRanges
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.reading import read_module
from tests.kernel.beside_gcc import check_estimate

Pair = tuple[Range, int]


def signed(word: int) -> int:
    """Return a word as a signed number."""
    return word - WORDS if word >= WORDS // 2 else word


def of_signed(function: Callable[[int, int], int]) -> Callable[[int, int], int]:
    """Return what a function of two signed numbers makes of words."""
    return lambda one, other: function(signed(one), signed(other)) % WORDS


MEANT: dict[str, Callable[[int, int], int]] = {
    "add": lambda one, other: (one + other) % WORDS,
    "sub": lambda one, other: (one - other) % WORDS,
    "mul": lambda one, other: one * other % WORDS,
    "and": operator.and_,
    "or": operator.or_,
    "xor": operator.xor,
    "umin": min,
    "umax": max,
    "smin": of_signed(min),
    "smax": of_signed(max),
    "select": lambda one, _other: one,
}
SHIFTS: dict[str, Callable[[int, int], int]] = {
    "shl": lambda one, by: (one << by) % WORDS,
    "lshr": operator.rshift,
    "ashr": of_signed(operator.rshift),
}
DIVISIONS: dict[str, Callable[[int, int], int]] = {
    "udiv": operator.floordiv,
    "urem": operator.mod,
    "sdiv": of_signed(lambda one, by: int(one / by)),
    "srem": of_signed(lambda one, by: one - int(one / by) * by),
}


@st.composite
def within_ranges(draw: st.DrawFn, most: int = WORDS - 1, least: int = 0) -> Pair:
    """Draw a range, and a number within it: small ones, ones about the largest signed one, and any."""
    near = st.integers(0, 300) | st.integers(WORDS // 2 - 300, WORDS // 2 + 300) | st.integers(0, WORDS - 1)
    low, number, high = sorted(max(least, min(each, most)) for each in draw(st.tuples(near, near, near)))
    return (low, high), number


def check(name: str, function: Callable[[int, int], int], one: Pair, other: Pair) -> None:
    """Assert that what comes of two numbers lies within what is found of their ranges."""
    low, high = COMPUTED[name](one[0], other[0])
    if not 0 <= low <= high < WORDS:
        low, high = ANY  # it may wrap
    assert low <= function(one[1], other[1]) <= high


@pytest.mark.parametrize("name", MEANT)
@given(one=within_ranges(), other=within_ranges())
def test_results_lie_within_their_ranges(name: str, one: Pair, other: Pair) -> None:
    """Of sums, products, minima ... of all words."""
    check(name, MEANT[name], one, other)


@pytest.mark.parametrize("name", SHIFTS)
@given(one=within_ranges(), by=within_ranges(31))
def test_what_is_shifted_lies_within_its_range(name: str, one: Pair, by: Pair) -> None:
    """By 0 to 31."""
    check(name, SHIFTS[name], one, by)


@pytest.mark.parametrize("name", DIVISIONS)
@given(one=within_ranges(), by=within_ranges(least=1))
def test_quotients_lie_within_their_ranges(name: str, one: Pair, by: Pair) -> None:
    """And remainders; of any divisor but 0."""
    check(name, DIVISIONS[name], one, by)


RELATIONS = {"eq": operator.eq, "ne": operator.ne} | {
    f"{sign}{name}": getattr(operator, name) for sign in "us" for name in ("lt", "le", "gt", "ge")
}


@pytest.mark.parametrize("relation", RELATIONS)
@given(one=within_ranges(), other=within_ranges())
def test_a_relation_leaves_the_numbers_for_which_it_holds(relation: str, one: Pair, other: Pair) -> None:
    """Of signed and unsigned numbers."""
    numbers = [signed(each[1]) if relation[0] == "s" else each[1] for each in (one, other)]
    if RELATIONS[relation](*numbers):
        left = within(one[0], relation, other[0])
        assert left is not None and left[0] <= one[1] <= left[1]


ROUND = """
define i32 @f(ptr %a, i32 %n) {
entry:
  br label %body
body:
  %rest = phi i32 [ 0, %entry ], [ %next, %body ]
  %i = phi i32 [ 0, %entry ], [ %step, %body ]
  %shifted = shl i32 %rest, 16
  %low = and i32 %n, 65535
  %high = or i32 %shifted, %low
  %quotient = udiv i32 %high, 1000
  %whole = mul i32 %quotient, 1000
  %next = sub i32 %high, %whole
  %step = add nsw i32 %i, 1
  %again = icmp slt i32 %step, %n
  br i1 %again, label %body, label %end
end:
  %odd = icmp ult i32 %n, 50
  br i1 %odd, label %small, label %out
small:
  %sum = add i32 %n, 7
  br label %out
out:
  %found = phi i32 [ %sum, %small ], [ 3, %end ]
  ret i32 %found
}
"""


def test_loops_and_tests_say_how_large_a_number_is() -> None:
    """A remainder that goes round a loop is below its divisor, a counter is positive, and behind `n < 50` n + 7 is no more than 56."""
    (routine,) = read_module(ROUND)
    found = UnsignedRanges(ControlFlow(routine)).found
    assert found["%rest"] == (0, 999)
    assert found["%shifted"] == (0, 999 << 16)
    assert found["%i"] == (0, WORDS // 2 - 1)
    assert found["%sum"] == (7, 56)
    assert found["%found"] == (3, 56)


MAGNITUDES = """
def f(x: i32[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        v = u32(x[i])
        if x[i] < 0:
            v = 0 - v
        s += i32(v // 10)
    return s
"""


def test_a_negated_word_need_not_be_positive(tmp_path: Path) -> None:
    """An i32 that is negated does not overflow in C, a u32 may be 2 ** 31: the estimate was 19 times as much, with a call for each division."""
    check_estimate(MAGNITUDES, 2219, 0.10, tmp_path)
