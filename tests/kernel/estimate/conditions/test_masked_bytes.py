"""Bytes and half-words of which some bits are wanted: in tests, as indices, factors and terms."""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

MASKED: dict[str, Case] = {
    "bits that are compared": (
        """def f(a: u8[:], b: u8[:], c: i16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        if a[i] & 15 == 4:
            s += 1
    return s""",
        4264,
        0.02,
    ),
    "several bits": (
        """def f(a: u8[:], b: u8[:], c: i16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        if a[i] & 7:
            s += 1
    return s""",
        4874,
        0.02,
    ),
    "an index of bytes": (
        """def f(a: u8[:], b: u8[:], c: i16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        s += b[a[i] & 15]
    return s""",
        1414,
        0.02,
    ),
    "an index of half-words": (
        """def f(a: u8[:], b: u8[:], c: i16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        s += c[a[i] & 15]
    return s""",
        1639,
        0.02,
    ),
    "a factor": (
        """def f(a: u8[:], b: u8[:], c: i16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        s += (a[i] & 15) * 6
    return s""",
        1014,
        0.02,
    ),
    "a term that is stored as a half-word": (
        """def f(a: u8[:], b: u8[:], c: i16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        c[i] = (a[i] & 7) + 1
    return s""",
        1013,
        0.02,
    ),
    "a variable": (
        """def f(a: u8[:], b: u8[:], c: i16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        x = a[i] & 240
        if x > t:
            s += x
    return s""",
        4570,
        0.02,
    ),
    "stored as a half-word": (
        """def f(a: u8[:], b: u8[:], c: i16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        c[i] = a[i] & 15
    return s""",
        813,
        0.02,
    ),
    "added up": (
        """def f(a: u8[:], b: u8[:], c: i16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        s += a[i] & 15
    return s""",
        813,
        0.02,
    ),
    "one bit of a byte": (
        """def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        if a[i] & 2:
            s += 1
    return s""",
        4279,
        0.02,
    ),
    "the sign of a byte": (
        """def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        if a[i] & 128:
            s += 1
    return s""",
        4118,
        0.02,
    ),
    "one bit of a variable": (
        """def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        x = a[i]
        if x & 2:
            s += x
    return s""",
        4374,
        0.03,
    ),
    "one bit of a half-word": (
        """def f(a: u16[:], b: u16[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        if a[i] & 2:
            s += 1
    return s""",
        4374,
        0.02,
    ),
    "one bit of a word": (
        """def f(a: i32[:], b: i32[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        if a[i] & 2:
            s += 1
    return s""",
        4062,
        0.02,
    ),
}

test_masked_bytes_cost_what_gcc_makes_of_them, test_masked_bytes_compute_the_same = beside_gcc(MASKED)
