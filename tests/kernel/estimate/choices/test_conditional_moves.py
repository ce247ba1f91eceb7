"""A choice is a conditional move for GCC, and its estimate, unless its register is tested or both its values are copied."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import check_estimate
from tests.kernel.lowered import lowered

WRAPPED = """
def f(a: i32[:], o: i32[:], n: i32, t: i32) -> i32:
    k = 0
    for i in range(n):
        o[i] = a[k]
        k += 3
        if k >= t:
            k = 1
    return k
"""
OVERFLOWED = """
def f(a: u8[:], o: i32[:], n: i32, t: i32) -> i32:
    k = 0
    s = 0
    for i in range(n):
        s += a[k] * a[i]
        k += a[i]
        if k >= 64:
            k = 0
        o[i] = s
    return s
"""
HELD = """
def f(a: i16[:], o: i16[:], n: i32, t: i32) -> None:
    last = 0
    for i in range(n):
        v = a[i]
        if v < t:
            v = last
        o[i] = v * 2
        last = v
"""
CHOSEN = """
def f(a: i32[:], o: i32[:], n: i32, t: i32) -> None:
    for i in range(n):
        o[i] = {0}
"""
GATED = """
def f(a: {1}[:], b: {1}[:], o: {1}[:], n: i32, t: i32) -> None:
    for i in range(n):
        v = b[i]
        o[i] = {0}
"""


@pytest.mark.parametrize(
    ("text", "cycles"),
    [
        (WRAPPED, 4264),
        (OVERFLOWED, 4205),
        (HELD, 1043),
        (CHOSEN.format("t if a[i] > 0 else n"), 2316),
        (CHOSEN.format("900 if a[i] > t else 77"), 1043),
        (GATED.format("v if a[i] > t else 0", "i32"), 1043),
        (GATED.format("v if v > t else 0", "i32"), 2266),
    ],
)
def test_estimates_are_near_what_gcc_makes(text: str, cycles: int, tmp_path: Path) -> None:
    """GCC 12.2's code of the exported C, in cycles of the GNU simulator; most estimates were 21 to 66 % below it."""
    check_estimate(text, cycles, 0.05, tmp_path)


def test_narrow_elements_have_registers_of_their_own(tmp_path: Path) -> None:
    """C converts both sides before it chooses what it stores: what is tested is wide, so the choice is not in its register."""
    for kind, moves in (("u8", 1), ("i32", 0)):
        text = GATED.format("v if v > t else 0", kind)
        assert lowered(text, tmp_path)[Op.COND_MOVE] == moves, kind


def test_it_is_gccs_alone(tmp_path: Path) -> None:
    """Nothing says that VisualDSP++ does so: there it is a conditional move."""
    text = WRAPPED
    assert lowered(text, tmp_path, VDSP_O2)[Op.COND_MOVE] == 1
    assert lowered(text, tmp_path, GCC_O2)[Op.COND_MOVE] == 0
