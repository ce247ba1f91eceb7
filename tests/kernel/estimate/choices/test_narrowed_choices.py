"""What is limited, stored as narrow, and wanted as wide besides: numbers among the choices are narrow at once, so both are chosen.

Each way that sets another value copies it, and jumps then [do_pre_regular_insertion in tree-ssa-pre.cc of GCC 12]. Without this, an estimate
is up to 40 % too cheap.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

SHAPE = """
def f(a: i16[:], b: i16[:], o: {kind}[:], n: i32, t: i32) -> i32:
    s = 0
    k = 0
    for i in range(n):
        v = {value}
        {limits}
        {rest}
        o[i] = v
    return s + k
"""
ABOVE = "if v > {0}:\n            v = {0}\n            k += 1"
BOTH = "if v < 0:\n            v = 0\n        elif v > {0}:\n            v = {0}\n            k += 1"


def _case(cycles: int, near: float, kind: str, value: str, limits: str, rest: str) -> Case:
    return SHAPE.format(kind=kind, value=value, limits=limits, rest=rest), cycles, near


CASES = {
    "the largest besides": _case(
        4513, 0.01, "u8", "(a[i] * b[i] - 999) >> 6", BOTH.format(255), "s = max(s, v)"
    ),
    "a sum of squares": _case(4634, 0.04, "u8", "(a[i] * b[i]) >> 6", ABOVE.format(255), "s += v * v"),
    "a shift": _case(4448, 0.1, "i16", "a[i] * b[i] >> 2", ABOVE.format(32767), "s += v >> 3"),
    "kept for the next": _case(5133, 0.01, "i16", "s + ((a[i] - s) * 5 >> 1)", BOTH.format(400), "s = v"),
    "nothing is added": _case(3218, 0.07, "u8", "a[i] >> 1", "if v < t:\n            v = 0", "s += v * v"),
}
OTHERS = {
    "is stored alone": _case(0, 0, "u8", "a[i] >> 1", BOTH.format(255), "s += 1")[0],
    "stored as negative": _case(0, 0, "i8", "a[i] >> 1", BOTH.format(200), "s += v")[0],
    "three numbers": _case(0, 0, "u8", "3 if a[i] < 0 else 200 if a[i] > t else 5", "", "s += v * v")[0],
}

test_an_estimate_is_near, test_what_is_costed_computes_what_python_does = beside_gcc(CASES, others=OTHERS)
