"""Choices between neighbouring numbers by a bit: GCC computes them, and threads no test of what is chosen. Without, estimates were up to 38 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

SIDES = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        side = 4 if a[i] & 1 else 5
        if side != t:
            s += side + a[i]
    return s
"""
FALLING = """
def f(a: u8[:], o: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        side = 2
        if a[i] & 1 == 0:
            side = 3
        o[i] = side
        if a[i] > t:
            s += side
    return s
"""
CASES = {"rising": (SIDES, 4031, 0.06), "falling": (FALLING, 5232, 0.04)}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
