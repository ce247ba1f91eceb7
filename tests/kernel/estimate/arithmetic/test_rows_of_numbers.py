"""Rows of numbers beside GCC: divisions of what is positive, narrow products, both sides of a test, values that one side needs alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.kernel.beside_gcc import beside_gcc, check_estimate

LONG_DIVISION = """
def f(a: u32[:], n: i32) -> u32:
    rest: u32 = 0
    for i in range(n):
        part = (rest << 16) | (a[i] & 0xFFFF)
        high = part // 1000
        rest = part - high * 1000
        a[i] = high
    return rest
"""
TIME_OF_DAY = """
def f(a: u32[:], o: u8[:], n: i32) -> None:
    for i in range(n):
        second = a[i] % 86400
        hour = second // 3600
        o[i] = hour + (second - hour * 3600) // 60
"""
HASH = """
def f(a: u32[:], n: i32) -> u32:
    h: u32 = 17
    for i in range(n):
        k = (a[i] * 0x9E3779B1) & 0xFFFFFFFF
        h ^= ((k << 13) & 0xFFFFFFFF) | (k >> 19)
    return h
"""
SIDES_DIFFER = """
def f(a: i16[:], b: i16[:], o: u8[:], n: i32, t: i32) -> None:
    for i in range(n):
        o[i] = 1 if (a[i] > t) != (b[i] > t) else 0
"""
PREFIX_CODES = """
def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    at = 0
    total = 0
    for _ in range(t):
        code = 0
        for length in range(1, 12):
            if at >= n:
                return total
            code = (code << 1) | ((a[at >> 3] >> (7 - (at & 7))) & 1)
            at += 1
            if code < b[length]:
                total += code
                break
    return total
"""
STORED = """
def f(a: {0}[:], b: {1}[:], o: {2}[:], n: i32, t: i32) -> None:
    for i in range(n):
        o[i] = {3}
"""
OF_A_VARIABLE = """
def f(a: i16[:], o: i16[:], n: i32, t: i32) -> None:
    for i in range(n):
        v = a[i] * t
        o[i] = v
"""
STORED_SUM = """
def f(a: i16[:], o: u8[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        s += a[i]
        o[i] = s
    return s
"""
BIT_BY_BIT = """
def f(a: {0}[:], b: {0}[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        s += a[i] {1} b[i]
    return s
"""
BOTH_SIDES = """
def f(a: {0}[:], b: {0}[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        if {1}:
            s += a[i]
        else:
            s {2}
    return s
"""
ONE_SIDE = """
def f(a: i16[:], b: i16[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        v = a[i] + (b[i] >> 2)
        if a[i] > b[i]:
            s = v
    return s
"""
EITHER = """
def f(a: {0}[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        v = a[i]
        if v < 10:
            s = v
    return s
"""
ONE_OF_TWO = """
def f(a: {0}[:], o: {1}[:], n: i32, t: i32) -> None:
    for i in range(n):
        v = {2}
        if v > t:
            o[i] = v
        else:
            o[i] = {3}
"""

# Without these rules estimates are off by up to 96 %.
CASES = {
    "a long division": (LONG_DIVISION, 87446, 0.01),
    "the time of day": (TIME_OF_DAY, 130251, 0.01),
    "a product and the same one rotated": (HASH, 1618, 0.01),
    "two tests that differ": (SIDES_DIFFER, 1817, 0.01),
    "products of half-words": (STORED.format("i16", "i16", "i16", "a[i] * t + b[i] * n"), 1220, 0.01),
    "a product of bytes": (STORED.format("u8", "u8", "u16", "(a[i] + t) * (a[i] - t)"), 1012, 0.01),
    "masked": (STORED.format("i32", "i32", "u8", "(a[i] * b[i]) & t"), 1042, 0.03),
    "shifted": (STORED.format("i32", "i32", "u16", "(a[i] * b[i] + a[i + 1] * b[i + 1]) << 2"), 1616, 0.01),
    "a product of words": (OF_A_VARIABLE, 1041, 0.03),
    "a sum that is stored": (STORED_SUM, 642, 0.04),
    "bytes": (BIT_BY_BIT.format("u8", "|"), 1037, 0.03),
    "half-words": (BIT_BY_BIT.format("i16", "^"), 1042, 0.03),
    "a mask of bytes": (STORED.format("u8", "u8", "i32", "(a[i] & 7) + t"), 1013, 0.01),
    "a mask of half-words": (STORED.format("i16", "i16", "i32", "(a[i] & 15) * t"), 1442, 0.03),
    "bits of a byte, moved": (
        STORED.format("u8", "u8", "i32", "((a[i] & 3) << 4) | (a[i] >> 4)"),
        1212,
        0.01,
    ),
    "up and down": (BOTH_SIDES.format("u8", "a[i] > t", "-= 1"), 4684, 0.01),
    "the larger one": (BOTH_SIDES.format("i16", "a[i] > b[i]", "+= b[i]"), 4926, 0.01),
    "a word or nothing, stored as a half-word": (
        ONE_OF_TWO.format("i32", "u16", "a[i] - 3", "0"),
        2416,
        0.02,
    ),
    "a half-word or nothing, stored as a byte": (
        ONE_OF_TWO.format("i16", "u8", "a[i] * 3", "255"),
        2358,
        0.02,
    ),
    "what one side needs": (ONE_SIDE, 4482, 0.01),
    "a byte that both sides may": (EITHER.format("u8"), 812, 0.01),
    "a word that both sides may": (EITHER.format("i32"), 817, 0.01),
}
BITS_AND_CODES = {"prefix codes": (PREFIX_CODES, 4738, 0.05)}
"""Of more bits than codes: of one number for both, the bits end first."""

test_estimates_are_near_what_gcc_makes, test_they_compute_what_python_does = beside_gcc(
    CASES, counts=(0, 1, 2, 17, 200)
)


test_the_estimate_of_prefix_codes_is_near, test_prefix_codes_are_what_python_makes = beside_gcc(
    BITS_AND_CODES
)


@pytest.mark.xfail(reason="GCC has a conditional move for a half-word that was shifted", strict=True)
def test_a_shifted_half_word_or_another_is_stored(tmp_path: Path) -> None:
    """What an `if` and its `else` store to one place."""
    check_estimate(ONE_OF_TWO.format("i16", "i16", "a[i] >> 2", "t"), 1041, 0.05, tmp_path)
