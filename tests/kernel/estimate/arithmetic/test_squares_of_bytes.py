"""Bytes that are added up and multiplied: each is extended for the sum, and once for all products. Without, an estimate is up to 11 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

CASES = {
    "a square": (
        """
        def f(a: u8[:], n: i32) -> i32:
            s = 0
            q = 0
            for i in range(n):
                v = i32(a[i])
                s += v
                q += v * v
            return s ^ q
        """, 1214, 0.01),
    "squares and a product": (
        """
        def f(a: u8[:], b: u8[:], n: i32) -> i32:
            s = 0
            q = 0
            for i in range(n):
                v = i32(a[i])
                w = i32(b[i])
                s += v + w
                q += v * v
                q ^= w * w
                q -= v * w
            return s ^ q
        """, 2840, 0.01),
}  # fmt: skip
test_squares_of_bytes_are_near_what_gcc_makes, test_squares_of_bytes_are_what_runs = beside_gcc(CASES)
