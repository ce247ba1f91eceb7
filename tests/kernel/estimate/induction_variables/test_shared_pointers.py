"""Loops that go down columns or in strides: pointers that have one stride, and addresses that are computed of one pointer. Up to 94 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

COLUMNS = """
def f(a: {array}[:], b: {array}[:], n: i32, t: i32) -> i32:
    w = n >> 4
    for x in range(w):
        for y in range(2, 12):
            p = y * w + x
            b[p] = {value}
    return 0
"""
SUMS = """
def f(a: {array}[:], b: {array}[:], n: i32, t: i32) -> i32:
    w = n >> 4
    s = 0
    for x in range(w):
        for y in range(2, 12):
            p = y * w + x
            s += {value}
    return s
"""
HALVES = """
def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    w = n >> 4
    for y in range(2, 12):
        for x in range(1, w - 1, 2):
            p = y * w + x
            b[p] = {value}
    return 0
"""


def _case(cycles: int, near: float, value: str, array: str = "u8", text: str = COLUMNS) -> Case:
    return text.format(array=array, value=value), cycles, near


TWO, THREE = "a[p] + a[p + w]", "a[p - w] + 2 * a[p] + a[p + w]"
FIVE = "a[p - 2 * w] + a[p - w] + a[p] + a[p + w] + a[p + 2 * w]"
CASES = {
    "one row": _case(599, 0.02, "a[p]"),
    "two rows": _case(970, 0.09, TWO),
    "two rows of words": _case(955, 0.03, TWO, "i32"),
    "above and below": _case(975, 0.09, "a[p + w] - a[p - w]"),
    "sums of three rows": _case(1546, 0.04, THREE, text=SUMS),
    "sums of three rows of words": _case(1174, 0.03, THREE, "i32", SUMS),
    "five rows of words": _case(2403, 0.04, FIVE, "i32"),
    "every second place of one row": _case(362, 0.04, "a[p]", text=HALVES),
    "every second place of three rows": _case(830, 0.15, THREE, text=HALVES),
    "every second place of five rows": _case(1040, 0.1, FIVE, text=HALVES),
    "sums of five rows of words": _case(2617, 0.04, FIVE, "i32", SUMS),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
