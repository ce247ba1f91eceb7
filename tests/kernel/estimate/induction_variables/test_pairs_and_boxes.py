"""Counters that only some iterations want, in loops that take many registers, or that begin where the loop around ends.

A pointer stands for a counter where that costs less; with each register that is taken it costs more, and where GCC does not see that a loop has an
iteration, the pointer cannot end it. Then the counter is stepped, and the loop is a hardware loop: without this, an estimate is up to 98 % too dear.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

CASES = {
    "the box around what is bright": (
        """
        def f(a: u8[:], t: i32) -> i32:
            left = 15
            right = 0
            top = 11
            bottom = 0
            for y in range(12):
                for x in range(16):
                    if a[y * 16 + x] > t:
                        left = min(left, x)
                        right = max(right, x)
                        top = min(top, y)
                        bottom = max(bottom, y)
            return left + right + top + bottom
        """,
        2578,
        0.01,
    ),
    "its sides alone": (
        """
        def f(a: u8[:], t: i32) -> i32:
            left = 15
            right = 0
            for y in range(12):
                for x in range(16):
                    if a[y * 16 + x] > t:
                        left = min(left, x)
                        right = max(right, x)
            return left + right
        """,
        4848,
        0.01,
    ),
    "the pair that differs most": (
        """
        def f(a: u8[:], o: i16[:], n: i32) -> i32:
            best = 0
            for i in range(n):
                for j in range(i + 1, n):
                    d = abs(a[i] - a[j])
                    if d > best:
                        best = d
                        o[0] = i
                        o[1] = j
            return best
        """,
        222205,
        0.01,
    ),
    "the same, up to the last but one": (
        """
        def f(a: u8[:], o: i16[:], n: i32) -> i32:
            best = 0
            for i in range(n - 1):
                v = a[i] * 3
                for j in range(i + 1, n):
                    d = abs(v - a[j])
                    if d > best:
                        best = d
                        o[1] = j
            return best
        """,
        400333,
        0.01,
    ),
}

test_pairs_and_boxes_are_near_what_gcc_makes_of_them, test_pairs_and_boxes_are_what_runs = beside_gcc(CASES)
