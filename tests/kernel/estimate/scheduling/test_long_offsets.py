"""An offset that is negative, or too large, takes 32 bits: such an access is in no bundle. Without, an estimate is up to 18 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def least(elements: str) -> str:
    """A kernel that finds the least one of elements."""
    return f"""
    def f(a: i32[:], o: i32[:], n: i32) -> None:
        for i in range(20, n):
            o[i] = min({elements})
    """


CASES = {
    "before the pointer": (least("a[i] + 4, a[i - 9] + 3, a[i - 10] + 2, a[i - 11]"), 2028, 0.01),
    "behind it": (least("a[i] + 4, a[i + 3] + 3, a[i + 4] + 2, a[i + 5]"), 1665, 0.01),
    "far behind it": (least("a[i] + 4, a[i + 23] + 3, a[i + 24] + 2, a[i + 25]"), 2025, 0.01),
}
test_long_offsets_are_near_what_gcc_makes, test_long_offsets_are_what_runs = beside_gcc(CASES)
