"""Which loops are hardware loops, where blocks were copied: without, rows with borders were 87 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

BORDERS = """
def f(a: i16[:], o: i16[:], n: i32) -> None:
    for i in range(n):
        l = a[i - 1] if i > 0 else a[i]
        r = a[i + 1] if i < n - 1 else a[i]
        o[i] = l + {middle} + r
"""
CASES = {
    "the copy of a loop's first block stands behind its last one": (
        BORDERS.format(middle="a[i]"),
        3443,
        0.07,
    ),
    "the same, with a product": (BORDERS.format(middle="3 * a[i]"), 4043, 0.11),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
