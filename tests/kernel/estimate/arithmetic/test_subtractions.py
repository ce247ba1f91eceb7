"""Differences of several bytes and words: what is subtracted one by one, and what is doubled."""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

DIFFERENCES: dict[str, Case] = {
    "one, and twice another": (
        """def f(a: u8[:], b: u8[:], c: u8[:], d: i32[:], n: i32) -> None:
    for i in range(n):
        d[i] = c[i] - a[i] - 2 * b[i]""",
        1438,
        0.02,
    ),
    "twice one, and another": (
        """def f(a: u8[:], b: u8[:], c: u8[:], d: i16[:], n: i32) -> None:
    for i in range(n):
        d[i] = c[i] - 2 * a[i] - b[i]""",
        1438,
        0.02,
    ),
    "a sum, as it is written": (
        """def f(a: u8[:], b: u8[:], c: u8[:], d: i32[:], n: i32) -> None:
    for i in range(n):
        d[i] = c[i] - (a[i] + 2 * b[i])""",
        1840,
        0.02,
    ),
    "three times one": (
        """def f(a: u8[:], b: u8[:], c: u8[:], d: i16[:], n: i32) -> None:
    for i in range(n):
        d[i] = 3 * a[i] + b[i]""",
        1437,
        0.02,
    ),
    "four times one, and twice another": (
        """def f(a: u8[:], b: u8[:], c: u8[:], d: i32[:], n: i32) -> None:
    for i in range(n):
        d[i] = c[i] - 4 * a[i] - 2 * b[i]""",
        1638,
        0.02,
    ),
    "words": (
        """def f(a: i32[:], b: i32[:], c: i32[:], d: i32[:], n: i32) -> None:
    for i in range(n):
        d[i] = c[i] - a[i] - 2 * b[i]""",
        1442,
        0.02,
    ),
}

test_differences_cost_what_gcc_makes_of_them, test_differences_compute_the_same = beside_gcc(DIFFERENCES)
