"""Jumps that GCC threads: an iteration that a `continue` skips, and hints that go with the jumps of an inlined kernel."""

from __future__ import annotations

from pathlib import Path

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import beside_gcc
from tests.kernel.lowered import lowered

HELPERS = """
@kernel
def near(v: i32, w: i32) -> i32:
    return 1 if abs(v - w) < (w >> 2) else 0


@kernel
def is_digit(c: i32) -> i32:
    return 1 if 48 <= c <= 57 else 0


@kernel
def hex_value(c: i32) -> i32:
    if 48 <= c <= 57:
        return c - 48
    if 65 <= c <= 70:
        return c - 55
    return -1
"""
AROUND = """
def f(a: u8[:], n: i32) -> i32:
    s = 0
    for i in range(1, 18):
        for dy in range(-1, 2):
            for dx in range(-1, 2):
                {}
"""
SKIPPING = """
def f(a: u8[:], n: i32) -> i32:
    s = 0
    k = 0
    for i in range(1, 30):
        for j in range({}):
            if {}:
                {}
            if a[i * 5 + j + 6] > 100:
                s += 1
    return s + k
"""
HINTED = """
def f(a: {}[:], o: u16[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        if {}:
            o[i] = s
            s = 0
            continue
        s ^= a[i]
    return s
"""
# `i + 4` is done at once before several tests, and `i + 3` behind all of them
DIGITS = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    k = 0
    i = 0
    while i < n:
        i += 1
        if i + 2 >= n or a[i] > t:
            k += 1
            continue
        high = hex_value(a[i + 1])
        low = hex_value(a[i + 2])
        i += 3
        if high < 0 or low < 0 or (high << 4 | low) != t:
            k += 256
        else:
            k += 65536
    return k
"""
CENSUS = """
def f(a: u8[:], o: i32[:], n: i32) -> None:
    for x in range(2, 40):
        centre = a[80 + x]
        code = 0
        for dy in range(5):
            line = dy * 40 + x - 2
            for dx in range(5):
                if dy != 2 or dx != 2:
                    code = code << 1
                    if a[line + dx] < centre:
                        code |= 1
        o[x] = code
"""
COUNTS = "if a[(i + dy) * 10 + 5 + dx] > 100:\n                    s += 1"

SHIFTED = """
def f(a: u8[:], b: u8[:], n: i32) -> None:
    for i in range(2, n - 2):
        c = a[i]
        v = 0
        for k in range(-2, 3):
            if k != 0:
                v <<= 1
                if a[i + k] > c:
                    v |= 1
        b[i] = v
"""

# Without these rules estimates are off by up to 61 %.
CASES = {
    "the middle is left out": (
        AROUND.format(
            f"if dx == 0 and dy == 0:\n                    continue\n                {COUNTS}\n    return s"
        ),
        3870,
        0.08,
    ),
    "all but the middle": (
        AROUND.format(
            "if dx != 0 or dy != 0:\n                    s += a[(i + dy) * 10 + 5 + dx]\n    return s"
        ),
        2654,
        0.1,
    ),
    "a census, which counts from 0": (CENSUS, 25427, 0.02),
    "a census that shifts": (SHIFTED, 22571, 0.01),
    "the middle of a line": (SKIPPING.format("-2, 3", "j == 0", "continue"), 3388, 0.05),
    "a helper says which": (HINTED.format("i16", "near(a[i], 60)"), 1902, 0.05),
    "a helper says which not": (HINTED.format("i16", "not near(a[i], 60)"), 4782, 0.06),
    "two helpers with numbers": (DIGITS, 3385, 0.02),
    "a helper with two tests": (HINTED.format("u8", "not is_digit(a[i])"), 4473, 0.06),
}
OTHERS = {
    "the last one": SKIPPING.format("-2, 1", "j == 0", "continue"),
    "the first one": SKIPPING.format("0, 5", "j == 0", "continue"),
    "every other one": SKIPPING.format("-4, 5, 2", "j == 0", "continue"),
    "downwards": SKIPPING.format("4, -3, -1", "j == 1", "continue"),
    "two numbers": SKIPPING.format("-2, 3", "j == 1 and i == 7", "continue"),
    "the outer one first": SKIPPING.format("-2, 3", "i == 0 and j == 0", "continue"),
    "one that counts": SKIPPING.format("-2, 3", "j == 0", "k += 1\n                continue"),
    "one that is none": SKIPPING.format("-2, 3", "j == 9", "continue"),
}


test_estimates_are_near_what_gcc_makes, test_they_compute_what_python_does = beside_gcc(
    CASES, others=OTHERS, helpers=HELPERS
)


def test_the_loop_is_not_counted_any_more(tmp_path: Path) -> None:
    """Nothing says that VisualDSP++ gives up the hardware loop."""
    text = CASES["the middle of a line"][0]
    assert lowered(text, tmp_path, GCC_O2)[Op.LOOP_SETUP] == 1
    assert lowered(text, tmp_path, VDSP_O2)[Op.LOOP_SETUP] == 2
