"""Sums and multiples of a counter, which a loop steps. Without, an estimate is up to 117 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def row(parameters: str, statement: str, turns: str = "n") -> str:
    """A kernel with one loop."""
    return f"""
    def f({parameters}, n: i32, t: i32) -> i32:
        s = 0
        for i in range({turns}):
            {statement}
        return s
    """


BYTES, HALVES, WORDS = "a: u8[:]", "a: i16[:]", "a: i32[:]"
CASES = {
    "a double": (row(BYTES, "a[i] = 2 * i"), 412, 0.01),
    "three times": (row(BYTES, "a[i] = 3 * i"), 412, 0.01),
    "a multiple and a number": (row(BYTES, "a[i] = 2 * i + 5"), 412, 0.01),
    "the other way round": (row(HALVES, "a[i] = 100 - i"), 416, 0.01),
    "less what does not change": (row(WORDS, "a[i] = 3 * i - n"), 417, 0.01),
    "the distance from a place": (row(HALVES, "s += a[i] * abs(i - t)"), 1218, 0.01),
    "what is tested": (row(BYTES, "s += 1 if a[i] > 2 * i else 0"), 1013, 0.1),
    "what is shifted by": (row(BYTES, "a[i] = t >> 2 * i", "12"), 58, 0.03),
    "one of two is made of the other": (
        "def f(a: u8[:], b: u8[:], n: i32) -> None:\n    for i in range(n):\n        a[i] = 2 * i\n        b[i] = 4 * i\n", 612, 0.01,
    ),
    "beside the counter itself it is shifted": (
        "def f(a: u8[:], b: u8[:], n: i32) -> None:\n    for i in range(n):\n        a[i] = 2 * i\n        b[i] = i\n", 812, 0.01,
    ),
    "from a variable": (row(WORDS, "a[i] = 2 * i", "t, n"), 244, 0.12),
    "downwards": (row(HALVES, "a[i] = 3 * i", "n - 1, -1, -1"), 418, 0.01),
    "of some iterations": (row(HALVES, "s += 3 * i if a[i] > t else 0"), 2154, 0.05),
    "in a picture": (
        """
        def f(a: i16[:], n: i32, t: i32) -> None:
            w = n >> 4
            for y in range(w):
                for x in range(w):
                    a[y * w + x] = (x - 5) * (x - 5) + (y - 7) * (y - 7)
        """, 785, 0.06,
    ),
}  # fmt: skip
test_stepped_values_are_near_what_gcc_makes, test_stepped_values_are_what_runs = beside_gcc(
    CASES, counts=(1, 7, 60)
)
