"""Loops that end with a test of what a variable is next, beside GCC: LLVM tests what it was, and both would be wanted at once. Without, varints were 52 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

VARINTS = """
def f(b: i16[:], n: i32) -> i32:
    last = 0
    s = 0
    for i in range(n):
        d = b[i] - last
        last = b[i]
        z = (d << 1) ^ (d >> 31)
        while z >= 128:
            s += (z & 127) | 128
            z >>= 7
        s += z
    return s
"""
NORMALISED = """
def f(a: u8[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        x = a[i] + 20
        while x > 15:
            x >>= 1
            s += 1
        s += x
    return s
"""
COUNTED_DOWN = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        x = a[i] + 1
        while x > 0:
            s += x
            x -= 30
    return s
"""
CASES = {
    "varints": (VARINTS, 4642, 0.01),
    "halved until it is small": (NORMALISED, 7649, 0.01),
    "less and less": (COUNTED_DOWN, 10279, 0.12),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
