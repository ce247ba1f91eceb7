"""Choices that are stored as narrow, of values that a test wants as words: differences of bytes, by their sign or size, were up to 64 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

DIFFERENCE = """
def f(a: u8[:], b: u8[:], c: u8[:], n: i32, t: i32) -> i32:
    for i in range(n):
        d = a[i] - b[i]
        c[i] = {}
    return 0
"""
IF = """
def f(a: u8[:], b: u8[:], c: u8[:], n: i32, t: i32) -> i32:
    for i in range(n):
        d = a[i] - b[i]
        if d < 0:
            c[i] = -d
        else:
            c[i] = d
    return 0
"""
BEFORE = """
def f(a: u8[:], b: u8[:], c: u8[:], n: i32, t: i32) -> i32:
    for i in range(n):
        d = a[i] - b[i]
        if d < 0:
            d = -d
        c[i] = d
    return 0
"""
SIGNED = """
def f(a: i16[:], b: i16[:], c: i16[:], n: i32, t: i32) -> i32:
    for i in range(n):
        d = a[i] - b[i]
        c[i] = -d if d < 0 else d
    return 0
"""
ALONE = """
def f(a: i16[:], c: i16[:], n: i32, t: i32) -> i32:
    for i in range(n):
        c[i] = -a[i] if a[i] < 0 else a[i]
    return 0
"""
WORDS = SIGNED.replace("i16", "i32")
CASES = {
    "its absolute value": (DIFFERENCE.format("-d if d < 0 else d"), 2834, 0.01),
    "what is not negative": (DIFFERENCE.format("d if d >= 0 else -d"), 2834, 0.01),
    "what is positive": (DIFFERENCE.format("d if d > 0 else 0"), 2847, 0.01),
    "what is above a number, less it": (DIFFERENCE.format("d - 20 if d > 20 else 0"), 3838, 0.01),
    "at most a number": (DIFFERENCE.format("99 if d > 99 else d"), 3679, 0.01),
    "one more or less": (DIFFERENCE.format("d + 1 if d < 9 else d - 1"), 3935, 0.01),
    "itself or an element": (DIFFERENCE.format("d if d > t else a[i]"), 2639, 0.01),
    "what is left of 255": (DIFFERENCE.format("255 - d if d > t else d"), 3639, 0.01),
    "half of it or twice": (DIFFERENCE.format("d >> 1 if d > 50 else d << 1"), 3898, 0.01),
    "an absolute value by two stores": (IF, 2834, 0.01),
    "an absolute value before it is stored": (BEFORE, 2498, 0.01),
    "an absolute value of half-words": (SIGNED, 2677, 0.01),
    "an absolute value of an element": (ALONE, 2326, 0.01),
    "an absolute value of words": (WORDS, 1042, 0.01),
}
OTHERS = {
    "numbers that do not fit": DIFFERENCE.format("700 - d if d < 0 else 1023 + d"),
    "shifted beyond a byte": DIFFERENCE.format("d << 9 if d < 0 else d"),
    "a number or a difference": DIFFERENCE.format("300 if d < t else d * 3 - 700"),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES, others=OTHERS)
