"""Counters that each iteration compares: the pointer along an array of bytes stands for them, and the loop is no hardware loop then. Up to 72 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

SHAPE = """
def f(a: {array}[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        s += a[i]
        if {test}:
            s {does}
    return s
"""


def _case(cycles: int, near: float, test: str, does: str = "^= t", array: str = "u8") -> Case:
    return SHAPE.format(array=array, test=test, does=does), cycles, near


CASES = {
    "not the first": _case(3635, 0.01, "i > 0"),
    "one of them": _case(3643, 0.01, "i == t"),
    "those behind": _case(4924, 0.01, "i > t"),
    "from a number on": _case(4085, 0.01, "i >= 8"),
    "not the last": _case(5427, 0.01, "i < n - 1"),
    "half-words have a counter": _case(1418, 0.01, "i > 0", "-= a[i - 1]", "i16"),
    "words, too": _case(1430, 0.01, "i >= 3", "-= a[i - 3]", "i32"),
    "a number that is no immediate": _case(1660, 0.01, "i >= 8", "-= a[i - 8]", "i32"),
    "the one before": _case(3809, 0.01, "i > 0", "-= a[i - 1]"),
    "what was there before": _case(4252, 0.01, "i >= 8", "-= a[i - 8]"),
    "two before, behind a place": _case(5023, 0.01, "i > t", "-= a[i - 2]"),
    "the next one": _case(5625, 0.01, "i < n - 1", "-= a[i + 1]"),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(
    CASES, counts=(0, 1, 60)
)
