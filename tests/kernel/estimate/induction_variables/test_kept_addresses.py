"""Filters by neighbours: where their pointer is stepped, and whether a copy of it serves what comes before."""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

NEIGHBOURS: dict[str, Case] = {
    "the right one first": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = a[i] - a[i - 1]""",
        1011,
        0.02,
    ),
    "half-words, the right one first": (
        """def f(a: i16[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = a[i] - a[i - 1]""",
        1042,
        0.03,
    ),
    "the left one first": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = a[i - 1] - a[i + 1]""",
        704,
        0.04,
    ),
    "a sum that computes the right one first": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = a[i - 1] + a[i]""",
        870,
        0.03,
    ),
    "a mean": (
        """def f(a: i16[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = (a[i] + a[i - 1] + 1) >> 1""",
        1374,
        0.03,
    ),
    "a cross": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = 4 * a[i] - a[i - 1] - a[i + 1] - a[i - 16] - a[i + 16]""",
        2198,
        0.02,
    ),
    "a smooth row": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = a[i - 1] + 2 * a[i] + a[i + 1]""",
        1700,
        0.02,
    ),
    "an absolute difference": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = abs(a[i + 1] - a[i - 1])""",
        1177,
        0.02,
    ),
    "half-words of a picture": (
        """def f(a: i16[:], b: i16[:], n: i32) -> None:
    for y in range(2, 12):
        for x in range(2, 14):
            i = y * 16 + x
            b[i] = a[i] - a[i - 1]""",
        589,
        0.02,
    ),
    "half-words of a picture, the right one first": (
        """def f(a: i16[:], b: i16[:], n: i32) -> None:
    for y in range(2, 12):
        for x in range(2, 14):
            i = y * 16 + x
            b[i] = a[i + 1] + a[i]""",
        830,
        0.02,
    ),
    "both sides in a picture": (
        """def f(a: i16[:], b: i16[:], n: i32) -> None:
    for y in range(2, 12):
        for x in range(2, 14):
            i = y * 16 + x
            b[i] = a[i - 1] - a[i + 1]""",
        830,
        0.02,
    ),
    "the left one first in a picture": (
        """def f(a: i16[:], b: i16[:], n: i32) -> None:
    for y in range(2, 12):
        for x in range(2, 14):
            i = y * 16 + x
            b[i] = a[i - 1] + a[i]""",
        589,
        0.02,
    ),
    "rows above and below": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for y in range(2, 12):
        for x in range(2, 14):
            i = y * 16 + x
            b[i] = a[i + 16] - a[i - 16]""",
        587,
        0.04,
    ),
    "so far to the left that GCC takes it for far to the right": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for y in range(2, 12):
        for x in range(2, 14):
            i = y * 16 + x
            b[i] = a[i] - a[i - 3]""",
        587,
        0.02,
    ),
    "the largest of three in a picture": (
        """def f(a: i16[:], b: i16[:], n: i32) -> None:
    for y in range(2, 12):
        for x in range(2, 14):
            i = y * 16 + x
            b[i] = max(a[i], max(a[i - 1], a[i + 1]))""",
        950,
        0.02,
    ),
    "a sobel": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for i in range(17, n - 17):
        b[i] = a[i - 15] + 2 * a[i + 1] + a[i + 17] - a[i - 17] - 2 * a[i - 1] - a[i + 15]""",
        3027,
        0.02,
    ),
    "what is nearest, stored on one side of a test": (
        """def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(0, n):
        if b[i] > t:
            s = 0
        elif s < 100:
            s += 1
        if s < a[i]:
            a[i] = s
    return s""",
        6048,
        0.02,
    ),
    "what is nearest, downwards": (
        """def f(a: i32[:], b: i32[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n - 1, -1, -1):
        if b[i] > t:
            s = 0
        elif s < 100:
            s += 1
        if s < a[i]:
            a[i] = s
    return s""",
        6029,
        0.02,
    ),
    "the smaller one, stored on one side of a test": (
        """def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(0, n):
        x = b[i]
        if x < a[i]:
            a[i] = x
    return s""",
        4538,
        0.02,
    ),
}

test_filters_by_neighbours_cost_what_gcc_makes_of_them, test_filters_by_neighbours_compute_the_same = (
    beside_gcc(NEIGHBOURS)
)
