"""Sums that stop where they are too large, in a loop over places: whether a register counts the inner loop, and how it is turned round.

By a pointer that walks by more than one, GCC counts only where it sees that the pointer meets its end. A loop that is sure to be entered is
rotated by both of its tests, as others are. Without either, estimates of these were 38 to 63 % too cheap, or 50 to 67 % too dear.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

SHAPE = """
def f(a: {kind}[:], b: {kind}[:], n: i32, t: i32) -> i32:
    best = 1 << 20
    for d in range({places}):
        total = 0
        for k in range({count}):
            total += abs({one} - {two})
            if total >= best:
                break
        best = min(best, total)
    return best
"""


def _case(
    cycles: int, one: str, two: str, *, kind: str = "u8", places: str = "n", count: str = "0, t, 4"
) -> Case:
    return SHAPE.format(kind=kind, places=places, count=count, one=one, two=two), cycles, 0.03


CASES = {
    "every fourth": _case(79840, "b[k]", "a[k]"),
    "every fourth, moving": _case(62660, "a[k]", "b[(d & 127) + k]"),
    "every fourth, both moving": _case(70687, "b[(d & 127) + k]", "a[(d & 63) + k]"),
    "every fourth, sure to be entered": _case(31344, "b[k]", "a[d + k]", places="t"),
    "half-words": _case(265036, "b[k]", "a[k]", kind="u16", count="t"),
    "half-words, sure to be entered": _case(113155, "b[k]", "a[d + k]", kind="u16", places="t", count="t"),
    "words": _case(441437, "b[k]", "a[k]", kind="i32", count="t"),
    "words, sure to be entered": _case(190020, "b[k]", "a[d + k]", kind="i32", places="t", count="t"),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
