"""Tests of what is never negative for small numbers: which are immediates, which are likely, and what was shifted down. Up to 75 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

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
