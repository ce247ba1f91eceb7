"""Variables that a test has found to be a number: GCC takes that from them where ways meet, and loads nothing."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

STRIPES = """
def f(a: u8[:], o: u16[:], n: i32, t: i32) -> i32:
    inside = 0
    first = 0
    found = 0
    for i in range(n):
        level = a[i]
        if inside == 0:
            if level >= t:
                inside = 1
                first = i
        elif level < t:
            inside = 0
            o[found] = i - first
            found += 1
    return found
"""
STATES = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    state = 0
    marks = 0
    for i in range(n):
        if state == 0:
            if a[i] > t:
                state = 1
        elif state == 1:
            if a[i] > 2 * t:
                state = 2
            elif a[i] < 20:
                state = 0
        elif a[i] < t:
            state = 0
            marks += i
    return marks
"""
TWO_THRESHOLDS = """
def f(a: u8[:], o: u8[:], n: i32, t: i32) -> i32:
    on = 0
    starts = 0
    for i in range(n):
        if on != 0:
            if a[i] < 20:
                on = 0
        elif a[i] >= t:
            on = 1
            starts += 1
        o[i] = on
    return starts
"""
CASES = {
    "a flag": (STRIPES, 3629, 0.01),
    "states": (STATES, 5713, 0.05),
    "a flag that is stored": (TWO_THRESHOLDS, 3957, 0.05),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
