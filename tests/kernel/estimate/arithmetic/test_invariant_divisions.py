"""Divisions whose operands no iteration changes: they are made before the loop if they cannot fail there, or would be made anyway."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

ALWAYS = """
def f(a: u8[:], n: i32, t: u32) -> u32:
    s: u32 = 0
    for i in range(n):
        s += u32(a[i]) * (1000003 % t)
    return s
"""
SOMETIMES = """
def f(a: u8[:], n: i32, t: u32) -> u32:
    s: u32 = 0
    for i in range(n):
        if a[i] > 100:
            s += u32(a[i]) * (1000003 % t)
    return s
"""
BY_A_NUMBER = """
def f(a: u8[:], n: i32, t: u32) -> u32:
    s: u32 = 0
    for i in range(n):
        if a[i] > 100:
            s += u32(a[i]) * (t % 7)
    return s
"""
OF_A_LOOP_AROUND = """
def f(a: u8[:], n: i32, t: u32) -> u32:
    s: u32 = 0
    for y in range(4):
        for x in range(n >> 2):
            s += u32(a[x]) * ((t << 7) // (t + u32(y)))
    return s
"""

CASES = {
    "in every iteration": (ALWAYS, 1235, 0.01),
    "in some, where it may fail": (SOMETIMES, 26608, 0.02),
    "in some, where it cannot": (BY_A_NUMBER, 4779, 0.01),
    "of a loop around": (OF_A_LOOP_AROUND, 2014, 0.12),
}

test_an_estimate_is_near, test_what_is_costed_computes_what_python_does = beside_gcc(CASES)
