"""An `if` that only sets several variables to what is there already: a conditional move each, with a comparison of its own, beside GCC.

Without this, an estimate is off by up to 105 %: whether a run has begun and where, the last of something and its position.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import Case, beside_gcc
from tests.kernel.lowered import lowered

SHAPE = """
def f(a: u8[:], b: u8[:], n: i32, t: i32) -> i32:
    k = 0
    on = 0
    last = 0
    s = 0
    for i in range(n):
        v = a[i]
        {body}
        s += {wanted}
    return k + on + last + s
"""


def _case(cycles: int, near: float, body: list[str], wanted: str = "v") -> Case:
    return SHAPE.format(body="\n        ".join(body), wanted=wanted), cycles, near


TWO = ["if v > t:", "    k = i", "    on = 1"]
SIDES = ["if v > t:", "    k = 1", "    on = 2", "else:", "    k = 3", "    on = 7"]
CASES = {
    "a position and a flag": _case(1445, 0.01, TWO),
    "three are too many": _case(2687, 0.01, [*TWO, "    last = v"]),
    "one is tested": _case(1848, 0.01, ["if v > last:", "    k = i", "    last = v"]),
    "one is what another one was": _case(2537, 0.02, ["if v > t:", "    k = last", "    last = v"], "k"),
    "behind another test": _case(3297, 0.09, ["if on:", "    if v < t:", "        on = 0", "elif v > t + 20:", "    k = i", "    on = 1"]),
    "two ways to them": _case(4357, 0.11, ["if v > 200:", "    k = 1", "    last = v", "elif v < 40:", "    k = 2", "    last = i"], "k + last"),
    "numbers on both sides": _case(2044, 0.01, SIDES, "(v << k) ^ on"),
    "a load is for one side alone": _case(2287, 0.02, ["w = b[i]", "if v < t:", "    k = w", "    last = v"]),
}  # fmt: skip
test_estimates_are_near_what_gcc_makes, test_what_is_costed_computes_what_python_does = beside_gcc(
    CASES, counts=(0, 1, 7, 200)
)


SWAPPED = ["w = b[i]", "if v < w:", "    v = w", "    w = a[i]"]
BITS = ["if v > t:", "    k = 1", "else:", "    k = 0", "if b[i] > t:", "    k |= 2"]


@pytest.mark.parametrize(
    ("body", "wanted", "moves"),
    [(TWO, "v", 2), ([*TWO, "    last = v"], "v", 0), (SWAPPED, "v * 3 - w", 0), (BITS, "k", 1)],
)
def test_as_many_as_gcc_makes(body: list[str], wanted: str, moves: int, tmp_path: Path) -> None:
    """Two at most, none of which has the value that the other one is set to. LLVM alone makes two choices of a flag and of what is done with it: one is left, by the second test."""
    text, *_ = _case(0, 0.0, body, wanted)
    assert lowered(text, tmp_path, GCC_O2)[Op.COND_MOVE] == moves


def test_it_is_gccs_alone(tmp_path: Path) -> None:
    """Nothing says that VisualDSP++ does so: there it is a branch."""
    text, *_ = _case(0, 0.0, TWO)
    assert lowered(text, tmp_path, VDSP_O2)[Op.COND_MOVE] == 0
