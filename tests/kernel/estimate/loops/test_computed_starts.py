"""Loops that begin at a variable and may end early: a register counts them where the address that they begin at is computed before them.

Without this, an estimate is up to 153 % too dear where that makes a hardware loop of them, and 48 % too cheap where it does not.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

SHAPE = """
def f(a: {kind}[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    x = {start}
    while {ends}:
        s += i32(a[x])
        x += 1
    return s
"""
FOR = """
def f(a: i16[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for x in range(t, n):
        if {ends}:
            break
        s += a[x]
    return s
"""
ROWS = """
def f(a: i16[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for k in range(5):
        x = i32(b[k])
        while x < n and a[x] < 900:
            s += a[x]
            x += 1
    return s
"""
EACH = """
def f(a: i16[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for k in range(20):
        for x in range(k, n):
            if a[x] > 900:
                break
            s += a[x]
    return s
"""


def _case(cycles: int, near: float, ends: str, kind: str = "i16", start: str = "t") -> Case:
    return SHAPE.format(kind=kind, start=start, ends=ends), cycles, near


CASES = {
    "up to a value": _case(515, 0.01, "x < n and a[x] < 900"),
    "of words": _case(639, 0.2, "x < n and a[x] < 900", kind="i32"),
    "a little behind": _case(501, 0.01, "x < n and a[x] < 900", start="t + 3"),
    "within a range": _case(867, 0.04, "x < n and a[x] < 900", start="t & 63"),
    "two bounds": _case(1646, 0.06, "x < n and x < n - 20"),
    "and with it": _case(1666, 0.06, "x < n and x <= n - 20"),
    "not equal": _case(1646, 0.06, "x < n and x != n - 20"),
    "with a sum": _case(2524, 0.09, "x < n and s + x < 99999"),
    "a break": (FOR.format(ends="a[x] > 900"), 515, 0.01),
    "a break of two bounds": (FOR.format(ends="x > n - 20"), 1666, 0.06),
    "from what is loaded": (ROWS, 2333, 0.01),
    "in steps of two": (FOR.format(ends="a[x] > 900").replace("range(t, n)", "range(t, n, 2)"), 676, 0.04),
    "from each": (EACH, 42288, 0.01),
}

test_an_estimate_is_near, test_what_is_costed_computes_what_python_does = beside_gcc(CASES, counts=(0, 1, 60))
