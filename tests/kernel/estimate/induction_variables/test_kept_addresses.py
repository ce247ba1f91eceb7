"""Filters by neighbours: where their pointer is stepped, and whether a copy of it serves what comes before."""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

ROW = """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = {}"""
PICTURE = """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for y in range(2, 12):
        for x in range(2, 14):
            i = y * 16 + x
            b[i] = {}"""
NEAREST = """def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range({}):
        if b[i] > t:
            s = 0
        elif s < 100:
            s += 1
        if s < a[i]:
            a[i] = s
    return s"""
SMALLER = """def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(0, n):
        x = b[i]
        if x < a[i]:
            a[i] = x
    return s"""


def row(value: str, element: str = "u8") -> str:
    """A row in which each value is computed from elements around it."""
    return ROW.replace("u8", element).format(value)


def picture(value: str, element: str = "i16") -> str:
    """The same in the rows of a picture."""
    return PICTURE.replace("u8", element).format(value)


SOBEL = "a[i - 15] + 2 * a[i + 1] + a[i + 17] - a[i - 17] - 2 * a[i - 1] - a[i + 15]"
NEIGHBOURS: dict[str, Case] = {
    "the right one first": (row("a[i] - a[i - 1]"), 1011, 0.02),
    "half-words, the right one first": (row("a[i] - a[i - 1]", "i16"), 1042, 0.03),
    "the left one first": (row("a[i - 1] - a[i + 1]"), 704, 0.04),
    "a sum that computes the right one first": (row("a[i - 1] + a[i]"), 870, 0.03),
    "a mean": (row("(a[i] + a[i - 1] + 1) >> 1", "i16"), 1374, 0.03),
    "a cross": (row("4 * a[i] - a[i - 1] - a[i + 1] - a[i - 16] - a[i + 16]"), 2198, 0.02),
    "a smooth row": (row("a[i - 1] + 2 * a[i] + a[i + 1]"), 1700, 0.02),
    "an absolute difference": (row("abs(a[i + 1] - a[i - 1])"), 1177, 0.02),
    "half-words of a picture": (picture("a[i] - a[i - 1]"), 589, 0.02),
    "half-words of a picture, the right one first": (picture("a[i + 1] + a[i]"), 830, 0.02),
    "both sides in a picture": (picture("a[i - 1] - a[i + 1]"), 830, 0.02),
    "the left one first in a picture": (picture("a[i - 1] + a[i]"), 589, 0.02),
    "rows above and below": (picture("a[i + 16] - a[i - 16]", "u8"), 587, 0.04),
    "so far to the left that GCC takes it for far to the right": (
        picture("a[i] - a[i - 3]", "u8"),
        587,
        0.02,
    ),
    "the largest of three in a picture": (picture("max(a[i], max(a[i - 1], a[i + 1]))"), 950, 0.02),
    "a sobel": (row(SOBEL), 3027, 0.02),
    "what is nearest, stored on one side of a test": (NEAREST.format("0, n"), 6048, 0.02),
    "what is nearest, downwards": (
        NEAREST.replace("u8", "i32").format("n - 1, -1, -1"),
        6029,
        0.02,
    ),
    "the smaller one, stored on one side of a test": (SMALLER, 4538, 0.02),
}

test_filters_by_neighbours_cost_what_gcc_makes_of_them, test_filters_by_neighbours_compute_the_same = (
    beside_gcc(NEIGHBOURS)
)
