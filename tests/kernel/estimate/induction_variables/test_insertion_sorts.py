"""Insertion sorts: whether a pointer takes the place of the index, which is wanted behind the loop, decides whether a register counts.

Where several tests decide whether an element moves on, the index stays, and the loop is a hardware loop: without, these were 62 and 72 % too dear.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

ONE = """
def f(a: i16[:], n: i32) -> None:
    for i in range(1, n):
        x = i32(a[i])
        j = i - 1
        while j >= 0 and a[j] > x:
            a[j + 1] = a[j]
            j -= 1
        a[j + 1] = x
"""
TWO_REASONS = """
def f(a: i16[:], n: i32, t: i32) -> None:
    for i in range(1, n):
        x = i32(a[i])
        j = i - 1
        while j >= 0 and (a[j] > x or a[j] == t):
            a[j + 1] = a[j]
            j -= 1
        a[j + 1] = x
"""
PAIRS = """
def f(a: i16[:], b: i16[:], n: i32) -> None:
    for i in range(1, n):
        x = i32(a[i])
        y = i32(b[i])
        j = i - 1
        while j >= 0 and (a[j] > x or (a[j] == x and b[j] > y)):
            a[j + 1] = a[j]
            b[j + 1] = b[j]
            j -= 1
        a[j + 1] = x
        b[j + 1] = y
"""
CASES = {
    "one test": (ONE, 143283, 0.02),
    "two reasons to move on": (TWO_REASONS, 105587, 0.09),
    "points by x, then y": (PAIRS, 136983, 0.07),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
