"""Pointers to half-words that a sum of their own steps, in data registers. Without, an estimate is up to 22 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def bright(parameters: str, statement: str) -> str:
    """A kernel that does something where a pixel is bright."""
    return f"""
    def f({parameters}, n: i32) -> None:
        for i in range(n):
            if a[i] > 99:
                {statement}
    """


BOTH = "a: u8[:], b: i16[:]"
CASES = {
    "some iterations store": (bright(BOTH, "b[i] = 7"), 2544, 0.005),
    "they move the pointer once": (bright(BOTH, "b[i] += 1"), 2787, 0.005),
    "every iteration stores a second one": (
        "def f(a: u8[:], b: i16[:]) -> None:\n    for i in range(120):\n        b[2 * i] = a[i]\n", 489, 0.01,
    ),
    "in each row": (
        """
        def f(a: u8[:], b: i16[:], n: i32) -> None:
            for y in range(8):
                for x in range(20):
                    if a[y * 20 + x] > 99:
                        b[x] += y
        """, 2342, 0.02,
    ),
    "each of two arrays": (
        """
        def f(a: u8[:], b: i16[:], c: i16[:], n: i32) -> i32:
            s = 0
            for i in range(n):
                if a[i] > 99:
                    s += b[i]
                else:
                    s -= c[i]
            return s
        """, 3516, 0.01,
    ),
    "bytes are in pointer registers": (bright("a: u8[:], b: u8[:]", "b[i] = 7"), 2422, 0.005),
    "words are": (bright("a: u8[:], b: i32[:]", "b[i] = 7"), 2422, 0.005),
    "and neighbours": (bright(BOTH, "b[i] = b[i + 1] + b[i + 2]"), 2787, 0.01),
    "and what starts at a sum": (
        """
        def f(a: u8[:], b: i16[:], t: i32) -> None:
            for i in range(t):
                if a[i] > 99:
                    b[i + t] = 7
        """, 1218, 0.01,
    ),
}  # fmt: skip
test_half_word_pointers_are_near_what_gcc_makes, test_half_word_pointers_are_what_runs = beside_gcc(CASES)
