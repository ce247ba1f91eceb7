"""Loops over the digits of a number: how often they iterate follows from the number that they start with."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

CASES = {
    "a digit for each power of ten": (
        """
        def f(a: i16[:], o: i16[:], n: i32) -> i32:
            scale = 1000
            k = 0
            while scale > 0:
                o[k] = a[0] // scale
                k += 1
                scale = scale // 10
            return k
        """,
        1722,
        0.01,
    ),
    "the same, or fewer": (
        """
        def f(o: i16[:], n: i32, t: i32) -> i32:
            scale = 10000
            k = 0
            while scale > 0 and k < n:
                o[k] = t // scale
                k += 1
                scale = scale // 10
            return k
        """,
        2149,
        0.01,
    ),
    "what comes next is read": (
        """
        def f(a: u8[:], o: i16[:], n: i32) -> i32:
            at = 5
            k = 0
            while at > 0:
                k += at
                at = a[at] & 3
                if k > n:
                    break
            return k
        """,
        2795,
        0.09,
    ),
}

test_digits_are_near_what_gcc_makes_of_them, test_digits_are_what_runs = beside_gcc(CASES)
