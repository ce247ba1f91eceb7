"""Only a load goes along from iteration to iteration, no address that is not there before the loop. Without, a difference was 23 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

BEFORE = """
def f(a: i16[:], o: i16[:], n: i32, t: i32) -> i32:
    k = 0
    j = n - 1
    for i in range(n):
        d = a[i] - a[j]
        if d > t:
            k += 1
        o[i] = d
        j = i
    return k
"""
CASES = {"the one before, in a ring": (BEFORE, 3642, 0.06)}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
