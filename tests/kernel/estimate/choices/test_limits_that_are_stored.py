"""Limits that are stored by an `if` with a store on either side: one store, of a minimum, of a maximum, or of a conditional move.

Which it is depends on the types, for C converts what is stored. Without this, an estimate is up to 127 % too dear or 70 % too cheap.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

SHAPE = """
def f(a: {kind}[:], b: i16[:], o: {out}[:], n: i32, t: i32) -> i32:
    for i in range(n):
        v = a[i]
        if {test}:
            o[i] = {yes}
        else:
            o[i] = {no}
    return 0
"""


def _case(cycles: int, near: float, kind: str, out: str, test: str, yes: str, no: str) -> Case:
    return SHAPE.format(kind=kind, out=out, test=test, yes=yes, no=no), cycles, near


CASES = {
    "not less than a number": _case(617, 0.01, "i16", "i16", "v > 60", "v", "60"),
    "not more than a number": _case(617, 0.01, "i16", "i16", "v > 60", "60", "v"),
    "not less than 0": _case(617, 0.01, "i16", "i16", "v >= 0", "v", "0"),
    "not less than another one": _case(817, 0.01, "i16", "i16", "v > b[i]", "v", "b[i]"),
    "not more than a variable": _case(1017, 0.2, "i16", "i16", "v > t", "t", "v"),
    "bytes, which have no maximum": _case(1213, 0.01, "u8", "u8", "v > 60", "v", "60"),
    "bytes, not more than a variable": _case(1013, 0.2, "u8", "u8", "v > t", "t", "v"),
    "bytes as halves": _case(1413, 0.14, "u8", "i16", "v > 60", "v", "60"),
    "halves as bytes": _case(617, 0.01, "i16", "u8", "v > 60", "v", "60"),
    "halves as bytes, not more than a variable": _case(2243, 0.09, "i16", "u8", "v > t", "t", "v"),
    "of two types": _case(1417, 0.01, "u16", "i16", "v > b[i]", "v", "b[i]"),
    "of another type than is stored": _case(2757, 0.18, "i16", "u8", "v > b[i]", "v", "b[i]"),
}

test_limits_are_near_what_gcc_makes_of_them, test_limits_are_what_runs = beside_gcc(CASES)
