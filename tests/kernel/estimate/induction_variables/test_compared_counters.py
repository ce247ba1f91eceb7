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


OFTEN = """
def f(a: {array}[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        if {test}:
            s += 1
    return s
"""


def _often(cycles: int, test: str, array: str = "u8", near: float = 0.01) -> Case:
    """Accesses that some iterations do without: the first one is not apart in a loop along bytes."""
    return OFTEN.format(array=array, test=test), cycles, near


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
    "the first half": _case(4931, 0.01, "i < n // 2"),
    "larger than the one before": _often(2951, "i > 0 and a[i] > a[i - 1]"),
    "where runs begin": _often(1852, "i == 0 or a[i] != a[i - 1]"),
    "larger than the one two before": _often(2976, "i >= 2 and a[i] > a[i - 2]"),
    "half-words, larger than the one two before": _often(2996, "i >= 2 and a[i] > a[i - 2]", "i16", 0.02),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(
    CASES, counts=(0, 1, 60)
)
