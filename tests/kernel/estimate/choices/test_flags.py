"""What a test says as 0 or 1, a power of two or all bits, beside GCC: comparisons say ==, < and <=, the opposite takes an operation more.

Without this, an estimate is off by up to 20 %: pictures of black and white, maps of what is above a threshold.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

SHAPE = """
def f(a: u8[:], b: u8[:], o: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        v = a[i]
        {0}
        o[i] = {1}
    return s
"""


def _case(cycles: int, near: float, stored: str, counted: str = "s = 0") -> Case:
    return SHAPE.format(counted, stored), cycles, near


COUNTED = "f = 1 if {0} else 0\n        s += f"
CASES = {
    "above a number": _case(1212, 0.01, "1 if v > 99 else 0"),
    "not below a number": _case(1212, 0.01, "1 if v >= 99 else 0"),
    "below a number": _case(1012, 0.01, "1 if v < 99 else 0"),
    "above a variable": _case(813, 0.01, "1 if v > t else 0"),
    "another number": _case(1213, 0.01, "1 if v != 99 else 0"),
    "another value": _case(1013, 0.01, "1 if v != t else 0"),
    "a bit": _case(813, 0.01, "1 if v & 4 != 0 else 0"),
    "not a bit": _case(1013, 0.01, "1 if v & 4 == 0 else 0"),
    "white above a number": _case(1412, 0.01, "255 if v > 99 else 0"),
    "white below a number": _case(1212, 0.01, "255 if v < 99 else 0"),
    "black above a number": _case(1212, 0.01, "0 if v > 99 else 255"),
    "a power of two": _case(1412, 0.01, "16 if v > 99 else 0"),
    "counted above a number": _case(1413, 0.01, "f", COUNTED.format("v > 99")),
    "counted where it is another one": _case(1214, 0.01, "f", COUNTED.format("v != 99")),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_computes_what_python_does = beside_gcc(
    CASES, counts=(0, 1, 7, 100)
)
