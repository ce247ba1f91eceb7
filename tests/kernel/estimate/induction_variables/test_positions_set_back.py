"""A position that is set back to 0 before it is an index, beside GCC: on that way the address is the array itself, on the other it is added up.

Without this, an estimate is off by up to 47 %: rings, and tables that are begun anew.
"""

from __future__ import annotations

from pathlib import Path

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import Case, beside_gcc
from tests.kernel.lowered import lowered

SHAPE = """
def f(a: u8[:], b: {0}[:], n: i32, t: i32) -> i32:
    p = 0
    s = 0
    for i in range(n):
        v = a[i]
        {1}
    return s + p
"""


def _case(cycles: int, near: float, kind: str, *body: str) -> Case:
    return SHAPE.format(kind, "\n        ".join(body)), cycles, near


RING = ["b[p] = v", "p += 1", "if p == 16:", "    p = 0", "s += b[p]"]
ANEW = ["if v > 200:", "    p = 0", "s += b[p] ^ v", "p += 1"]
CASES = {
    "a ring of bytes": _case(2209, 0.09, "u8", *RING),
    "a ring of half-words": _case(2597, 0.09, "i16", *RING),
    "a ring of words": _case(2797, 0.09, "i32", *RING),
    "a table begun anew": _case(3884, 0.06, "u8", *ANEW),
    "a table of words": _case(3484, 0.01, "i32", *ANEW),
    "an index that is limited": _case(1439, 0.01, "u8", "p = v - t", "if p < 0:", "    p = 0", "s += b[p]"),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_computes_what_python_does = beside_gcc(
    CASES, counts=(0, 1, 7, 100)
)


def test_it_is_gccs_alone(tmp_path: Path) -> None:
    """Nothing says that VisualDSP++ does so: there it is a conditional move."""
    text, *_ = _case(0, 0.0, "u8", *RING)
    assert lowered(text, tmp_path, VDSP_O2)[Op.COND_MOVE] > lowered(text, tmp_path, GCC_O2)[Op.COND_MOVE]
