"""Loops with two bounds, of a counter and of what only some iterations count: the others do not test the second one again.

Without this, and without what a loop that is counted behind its start begins with, an estimate is off by up to 114 %.
"""

from __future__ import annotations

from pathlib import Path

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import Case, beside_gcc
from tests.kernel.lowered import lowered

SHAPE = """
def f(a: u8[:], o: u16[:], n: i32, t: i32) -> i32:
    k = 0
    s = 0
    i = 0
    while {bounds}:
        v = i32(a[i])
        if v > t:
            {then}
        {rest}
        i += 1
    return k + s
"""
FOR = """
def f(a: u8[:], o: u16[:], n: i32, t: i32) -> i32:
    k = 0
    for i in range(n):
        if k >= 100:
            break
        if a[i] > t:
            o[k] = a[i]
            k += 1
    return k
"""


def _case(
    cycles: int,
    near: float,
    bounds: str = "i < n and k < 90",
    then: str = "k += 1",
    rest: str = "s += v",
) -> Case:
    return SHAPE.format(bounds=bounds, then=then, rest=rest), cycles, near


OTHERWISE = "else:\n            {}"
CASES = {
    "room for so many": _case(2941, 0.05, then="o[k] = v\n            k += 1", rest=""),
    "their positions": _case(2976, 0.04, then="o[k] = i\n            k += 1", rest=""),
    "a sum besides": _case(2673, 0.09),
    "the room first": _case(3357, 0.005, bounds="k < 90 and i < n", rest=""),
    "a run that is set back": _case(3496, 0.08, bounds="i < n and k < 20", rest=OTHERWISE.format("k = 0")),
    "set back, up to a variable": _case(3538, 0.04, bounds="i < n and k < t", rest=OTHERWISE.format("k = 0")),
    "up to a variable": _case(2379, 0.08, bounds="i < n and k < t"),
    "three ways": _case(
        3231, 0.03, rest="elif v > 50:\n            s += v\n        else:\n            s -= 1"
    ),
    "two bounds": _case(
        1773, 0.07, bounds="i < n and k < 90 and s < 9000", then="k += 1\n            s += v", rest=""
    ),
    "a loop that is left": (FOR, 3367, 0.04),
}
OTHERS = {
    "much behind it": _case(0, 0, rest="s += v * v + (v >> 1) * (s & 7) - (v ^ 3) * (v >> 4)")[0],
    "starts beyond": SHAPE.replace("k = 0", "k = 120").format(
        bounds="i < n and k < 90", then="k += 1", rest=""
    ),
    "downwards": SHAPE.replace("k = 0", "k = 60").format(bounds="i < n and k > 0", then="k -= 1", rest=""),
    "not equal": SHAPE.format(bounds="i < n and k != 9", then="k += 1", rest=""),
    "another number": SHAPE.format(bounds="i < n and k < 90", then="k = s", rest="s += 2"),
}

test_an_estimate_is_near, test_what_is_costed_computes_what_python_does = beside_gcc(
    CASES, others=OTHERS, counts=(0, 1, 60)
)


def test_each_way_that_counts_nothing_has_an_end_of_its_own(tmp_path: Path) -> None:
    """Nothing says that VisualDSP++ copies them."""
    text = CASES["three ways"][0]
    tests = lowered(text, tmp_path, GCC_O2)[Op.COMPARE], lowered(text, tmp_path, VDSP_O2)[Op.COMPARE]
    assert tests[0] == tests[1] + 2
