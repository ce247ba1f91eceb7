"""Bytes and half-words of which some bits are wanted: in tests, as indices, factors and terms."""

from __future__ import annotations

from textwrap import indent

from tests.kernel.beside_gcc import Case, beside_gcc

FRAME = """def f({}, n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
{}
    return s"""
THREE = "a: u8[:], b: u8[:], c: i16[:]"
TWO = "a: u8[:], b: u8[:]"


def loop(body: str, arrays: str = THREE) -> str:
    """A kernel that does something with each element."""
    return FRAME.format(arrays, indent(body, 8 * " "))


MASKED: dict[str, Case] = {
    "bits that are compared": (loop("if a[i] & 15 == 4:\n    s += 1"), 4264, 0.02),
    "several bits": (loop("if a[i] & 7:\n    s += 1"), 4874, 0.02),
    "an index of bytes": (loop("s += b[a[i] & 15]"), 1414, 0.02),
    "an index of half-words": (loop("s += c[a[i] & 15]"), 1639, 0.02),
    "a factor": (loop("s += (a[i] & 15) * 6"), 1014, 0.02),
    "a term that is stored as a half-word": (loop("c[i] = (a[i] & 7) + 1"), 1013, 0.02),
    "a variable": (loop("x = a[i] & 240\nif x > t:\n    s += x"), 4570, 0.02),
    "stored as a half-word": (loop("c[i] = a[i] & 15"), 813, 0.02),
    "added up": (loop("s += a[i] & 15"), 813, 0.02),
    "one bit of a byte": (loop("if a[i] & 2:\n    s += 1", TWO), 4279, 0.02),
    "the sign of a byte": (loop("if a[i] & 128:\n    s += 1", TWO), 4118, 0.02),
    "one bit of a variable": (loop("x = a[i]\nif x & 2:\n    s += x", TWO), 4374, 0.03),
    "one bit of a half-word": (loop("if a[i] & 2:\n    s += 1", TWO.replace("u8", "u16")), 4374, 0.02),
    "one bit of a word": (loop("if a[i] & 2:\n    s += 1", TWO.replace("u8", "i32")), 4062, 0.02),
}

test_masked_bytes_cost_what_gcc_makes_of_them, test_masked_bytes_compute_the_same = beside_gcc(MASKED)
