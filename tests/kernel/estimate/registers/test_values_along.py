"""Narrow elements that the next iteration wants as words. Without, an estimate is up to 18 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def row(parameters: str, result: str) -> str:
    """A kernel that goes through a row, with the element before."""
    return f"""
    def f({parameters}, n: i32) -> None:
        last = 0
        for i in range(n):
            v = a[i]
            o[i] = {result}
            last = v
    """


CASES = {
    "a difference of half-words": (row("a: i16[:], o: i16[:]", "v - last"), 1041, 0.01),
    "of bytes": (row("a: u8[:], o: u8[:]", "v - last"), 1012, 0.01),
    "bits that are others": (row("a: u8[:], o: u8[:]", "v ^ last"), 1012, 0.01),
    "of words": (row("a: i32[:], o: i32[:]", "v - last"), 641, 0.01),
    "of half-words as a word": (row("a: i16[:], o: i32[:]", "v - last"), 641, 0.01),
    "an absolute one is of words": (row("a: i16[:], o: i16[:]", "abs(v - last)"), 841, 0.01),
    "so is a mean": (row("a: u8[:], o: u8[:]", "(v + last) >> 1"), 812, 0.02),
}
test_values_along_are_near_what_gcc_makes, test_values_along_are_what_runs = beside_gcc(CASES)
