"""What is left of a division is a remainder to GCC, also where the divisor is written twice. Without, a ramp was 49 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

RAMP = """
def f(o: i16[:], n: i32, t: i32) -> i32:
    pause = t << 4
    rest = 0
    for i in range(1, n):
        over = 2 * pause + rest
        change = quotient(over, 4 * i + 1)
        rest = over - change * (4 * i + 1)
        pause -= change
        o[i] = pause >> 4
    return rest
"""
CASES = {"a ramp": (RAMP, 87413, 0.02)}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
