"""Sums with several products by one number, in bytes and half-words: GCC adds those up first."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

BINOMIAL = """
def f(a: u8[:], o: u16[:], n: i32) -> None:
    for i in range(2, n):
        o[i] = a[i - 2] + 4 * a[i - 1] + 6 * a[i] + 4 * a[i + 1] + a[i + 2]
"""
SEVEN = """
def f(a: u8[:], o: u16[:], n: i32) -> None:
    for i in range(3, n):
        o[i] = a[i - 3] + 6 * a[i - 2] + 15 * a[i - 1] + 20 * a[i] + 15 * a[i + 1] + 6 * a[i + 2] + a[i + 3]
"""
IN_WORDS = """
def f(a: u8[:], o: i32[:], n: i32) -> None:
    for i in range(2, n):
        o[i] = a[i - 2] + 4 * a[i - 1] + 6 * a[i] + 4 * a[i + 1] + a[i + 2]
"""
CASES = {
    "binomial": (BINOMIAL, 3008, 0.14),
    "of seven": (SEVEN, 4766, 0.13),
    "in words": (IN_WORDS, 3405, 0.01),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
