"""Every test that leads to a `continue` is likely to lead elsewhere, not only the one that stands before it. Without, two checks were 41 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

CHECKED_TWICE = """
def f(a: u8[:], b: u8[:], o: u8[:], n: i32, t: i32) -> i32:
    failed = 0
    for x in range(n):
        d = a[x] & 63
        okay = d > 0 and x - d >= 0
        if okay:
            okay = abs(b[x - d] - d) <= t
        if not okay:
            failed += 1
            continue
        o[x] = d
    return failed
"""
CASES = {"checked twice": (CHECKED_TWICE, 5152, 0.12)}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
