"""Rings: what comes after the last element is the first one, whose address is that of the array. Without, these were 40 to 47 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

SHAPE = """
def f(a: i16[:], o: i16[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        {body}
    return s
"""


def _case(cycles: int, near: float, body: str) -> Case:
    return SHAPE.format(body=body.replace("\n", "\n        ")), cycles, near


CASES = {
    "both neighbours": _case(
        5454,
        0.08,
        "p = i - 1 if i > 0 else n - 1\nq = i + 1 if i < n - 1 else 0\no[i] = a[p] - 2 * a[i] + a[q]",
    ),
    "the next one": _case(3842, 0.06, "q = i + 1 if i < n - 1 else 0\no[i] = a[q] - a[i]"),
    "a polygon": _case(5644, 0.15, "q = i + 1 if i < n - 1 else 0\ns += a[q] * o[i] - o[q] * a[i]"),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
