"""Loops whose last test comes behind the next value of their counter, which GCC does not rotate: without, an estimate is up to 71 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def search(test: str, before: str = "pass", bounds: str = "n", kind: str = "u8") -> str:
    """A kernel that searches an array from its beginning."""
    return f"""
    def f(a: {kind}[:], o: {kind}[:], n: i32, t: i32) -> i32:
        w = n >> 4
        for i in range({bounds}):
            {before}
            if {test}:
                return i
        return 0
    """


CASES = {
    "compared with the next counter": (search("a[i] == i + 1"), 2115, 0.05),
    "half-words": (search("a[i] == i + 1", kind="i16"), 4217, 0.05),
    "multiplied, too": (search("a[i] > 250", "o[i] = (i + 1) * t", "n - 1"), 5219, 0.12),
    "two rows": (search("a[(i + 1) * w] - a[i * w] > 250", bounds="1, w"), 342, 0.04),
    "the next row": (search("a[(i + 1) * w] > 250", bounds="1, w"), 330, 0.23),
    "down a column": (
        """
        def f(a: u8[:], o: u8[:], n: i32, t: i32) -> i32:
            w = n >> 4
            k = 0
            for x in range(w):
                for y in range(w - 2, 0, -1):
                    d = a[(y - 1) * w + x] - a[(y + 1) * w + x]
                    if d > t or d < -t:
                        o[x] = y
                        k += 1
                        break
            return k
        """, 1070, 0.12),
}  # fmt: skip
OTHERS = {"only in an index": search("a[i + 1] - a[i] > 250", bounds="n - 1")}
test_loops_that_are_not_rotated_are_near_what_gcc_makes, test_loops_that_are_not_rotated_are_what_runs = (
    beside_gcc(CASES, others=OTHERS)
)
