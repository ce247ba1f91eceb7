"""Rows that only some iterations access: one with several accesses has a pointer of its own, however seldom. Without, an estimate is up to 43 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def peaks(tests: str) -> str:
    """A kernel that looks at the rows above and below where a score is high."""
    return f"""
    def f(a: i32[:], o: u8[:], n: i32) -> i32:
        w = n >> 4
        k = 0
        for i in range(w + 1, n - w - 1):
            s = a[i]
            o[i] = 0
            if s < 100:
                continue
            if {tests}:
                continue
            o[i] = 1
            k += 1
        return k
    """


CASES = {
    "three in the row above": (peaks("a[i - w - 1] >= s or a[i - w] >= s or a[i - w + 1] >= s"), 2806, 0.01),
    "two": (peaks("a[i - w - 1] >= s or a[i - w + 1] >= s"), 2608, 0.01),
    "three in two rows each": (
        peaks(
            "a[i - w - 1] >= s or a[i - w] >= s or a[i - w + 1] >= s or "
            "a[i + w - 1] > s or a[i + w] > s or a[i + w + 1] > s"
        ), 3468, 0.01),
    "one is computed from the pointer that is there": (peaks("a[i - w] >= s or a[i + w] > s"), 4517, 0.01),
}  # fmt: skip
test_seldom_rows_are_near_what_gcc_makes, test_seldom_rows_are_what_runs = beside_gcc(CASES)
