"""Ranges from a variable, over a window, beside GCC: their bounds do not wrap in C, so one that is more by a number is beyond it.

Without this, an estimate is off by up to 45 %: a test before each row of a window.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

SHAPE = """
def f(a: u8[:], b: u8[:], o: u8[:], n: i32, t: i32) -> i32:
    s = 0
    {0}
    return s
"""
WINDOW = ["for y in range(n, n + 5):", "    for x in range(t, t + {0}):", "        {1}"]
ROW = [
    "for x in range(2, n):",
    "    m = 0",
    "    for u in range({0}, {1}):",
    "        m = max(m, a[u])",
    "    s += m",
]


def _case(cycles: int, near: float, rows: list[str], *parts: str) -> Case:
    return SHAPE.format("\n    ".join(rows).format(*parts)), cycles, near


CASES = {
    "a sum": _case(126, 0.03, WINDOW, "9", "s += a[(y - n) * 16 + x]"),
    "a threshold": _case(386, 0.03, WINDOW, "9", "o[(y - n) * 16 + x] = 255 if a[x] > 90 else 0"),
    "differences": _case(273, 0.04, WINDOW, "8", "s += abs(a[x] - b[x + y - n])"),
    "about a point": _case(4568, 0.14, ROW, "x - 2", "x + 6"),
    "a walk down": _case(160, 0.16, ["for x in range(t, t + 60):", "    o[x] = a[200 - x]"]),
    "a range as wide as is said": _case(341, 0.08, ["for x in range(t, t + t):", "    o[x] = a[x] >> 1"]),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_computes_what_python_does = beside_gcc(
    CASES, counts=(0, 1, 7, 100)
)
