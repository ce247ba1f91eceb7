"""Flags that go along from iteration to iteration are 0 or 1 in a register: one operation sets them, one tests them. Without, a hysteresis was 22 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

HYSTERESIS = """
def f(a: u8[:], b: u8[:], n: i32, t: i32) -> None:
    on = False
    for i in range(n):
        if on:
            on = a[i] > t - 10
        else:
            on = a[i] > t + 10
        b[i] = 1 if on else 0
"""
TOGGLE = """
def f(a: u8[:], n: i32) -> i32:
    on = False
    k = 0
    for i in range(n):
        if on:
            if a[i] < 90:
                on = False
                k += 1
        elif a[i] > 180:
            on = True
    return k
"""
CASES = {"a hysteresis": (HYSTERESIS, 2891, 0.01), "on and off": (TOGGLE, 5962, 0.03)}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
