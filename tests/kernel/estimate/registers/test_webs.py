"""Which values share a register, and in which bank they are, beside GCC. Without, differences were 31 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

HALVES = """
def f(a: u8[:], b: i16[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        lo = 0
        hi = 256
        while lo < hi:
            mid = (lo + hi) >> 1
            if b[mid] < a[i]:
                lo = mid + 1
            else:
                hi = mid
        s += lo
    return s
"""
SLOPES = """
def f(b: i16[:], o: i16[:], n: i32, t: i32) -> i32:
    total = 0
    last = 0
    for i in range(n):
        e = t - b[i]
        total += e
        o[i] = (12 * e + 30 * (e - last)) >> 3
        last = e
    return total
"""
CASES = {
    "searches by halves": (HALVES, 41865, 0.1),
    "differences of differences": (SLOPES, 3244, 0.01),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
