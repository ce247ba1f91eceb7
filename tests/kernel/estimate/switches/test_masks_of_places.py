"""Switches to few places, beside GCC: a bit is tested for each place, and a register counts the loop. Without, estimates were up to 26 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

VOWELS = """
def f(a: u8[:], n: i32) -> i32:
    k = 0
    s = 0
    for i in range(n):
        c = a[i] & 31
        if c == 1 or c == 5 or c == 9 or c == 15 or c == 21:
            k += 1
        elif c == 0 or c == 10 or c == 13:
            s += 1
    return k * 256 + s
"""
KINDS = """
def f(a: u8[:], n: i32) -> i32:
    k = 0
    s = 0
    u = 0
    for i in range(n):
        c = a[i] >> 3
        if c == 2 or c == 4 or c == 6:
            k += 1
        elif c == 8 or c == 10 or c == 12:
            s += 1
        elif c == 16 or c == 18:
            u += 1
    return k * 256 + s + u
"""
STEPS = """
def f(a: u8[:], n: i32) -> i32:
    pos = 0
    old = 0
    errors = 0
    for i in range(n):
        now = a[i] & 3
        step = (old << 2) | now
        if step == 1 or step == 7 or step == 14 or step == 8:
            pos += 1
        elif step == 2 or step == 11 or step == 13 or step == 4:
            pos -= 1
        elif step == 3 or step == 6 or step == 9 or step == 12:
            errors += 1
        old = now
    return pos + errors
"""
CASES = {
    "vowels": (VOWELS, 5492, 0.07),
    "kinds": (KINDS, 5790, 0.03),
    "steps": (STEPS, 7363, 0.06),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
