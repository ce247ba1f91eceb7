"""Fields of records in one array, `out[at + 1]`: an offset in the access, or an address of their own, which a field has that is loaded and stored."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

SHAPE = """
def f(a: u8[:], out: {element}[:], n: i32, t: i32) -> i32:
    for i in range(n):
        at = (a[i] & 15) * 4
        {body}
    return out[0]
"""
CHANGED = SHAPE.replace("{body}", "out[at] += 1\n        out[at + 1] += i\n        out[at + 2] += t")
IN_ONE_STATEMENT = """
def f(a: u8[:], out: i32[:], n: i32, t: i32) -> i32:
    for i in range(n):
        k = a[i] & 15
        out[6 * k] += 1
        out[6 * k + 1] += i
        out[6 * k + 2] += t
    return out[0]
"""
BOX = SHAPE.format(
    element="i32",
    body="if i < out[at + 1]:\n            out[at + 1] = i\n"
    "        if i > out[at + 2]:\n            out[at + 2] = i",
)
STORED = SHAPE.format(
    element="i32", body="out[at] = 1\n        out[at + 1] = i\n        out[at + 2] = t"
).replace("* 4", "* 6")
LOADED = """
def f(a: u8[:], out: i32[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        k = a[i] & 15
        s += out[6 * k] * out[6 * k + 1] + out[6 * k + 2]
    return s
"""
ALONG = """
def f(a: u8[:], out: i32[:], n: i32, t: i32) -> i32:
    at = 0
    for i in range(n):
        out[at] = i
        out[at + 1] = i + t
        at += a[i] & 1
    return at
"""

CASES = {
    "words that are changed": (CHANGED.format(element="i32").replace("* 4", "* 6"), 4241, 0.1),
    "changed at a product in the same statement": (IN_ONE_STATEMENT, 4441, 0.1),
    "bytes that are changed": (CHANGED.format(element="u8"), 5040, 0.2),
    "half-words that are changed": (
        CHANGED.format(element="i16").replace("    return", "        out[at + 3] += 2\n    return"),
        6640,
        0.22,
    ),
    "bounds of a box": (BOX, 5749, 0.01),
    "only stored": (STORED, 2442, 0.01),
    "only loaded": (LOADED, 2840, 0.08),
    "at an index that is carried along": (ALONG, 2041, 0.01),
}

test_an_estimate_is_near, test_what_is_costed_computes_what_python_does = beside_gcc(CASES)
