"""`s + (v if v > t else 0)` is `if v > t: s = s + v` for GCC, and its estimate: what changes nothing on one way is done on the other."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import COUNT, LIMIT, arguments, check_estimate
from tests.kernel.lowered import lowered
from tests.kernel.modules import kernel_of

BRANCHES = (Op.BRANCH_TAKEN, Op.BRANCH_NOT_TAKEN)
LOOP = """
def f(a: i32[:], b: i32[:], o: i32[:], n: i32, t: i32) -> None:
    for i in range(n):
        y = b[i]
        o[i] = {0}
"""
SUM = """
def f(a: i32[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        y = a[i]
        {0}
    return s
"""
BITS = """
def f(data: u8[:], out: u32[:], n: i32) -> None:
    crc = u32(0xFFFFFFFF)
    for i in range(n):
        crc = crc ^ u32(data[i])
        for k in range(8):
            crc = (crc >> 1) ^ (u32(0xEDB88320) if crc & 1 else u32(0))
    out[0] = crc ^ 0xFFFFFFFF
"""


@pytest.mark.parametrize(
    ("text", "cycles"),
    [
        (LOOP.format("a[i] + (y if y > t else 0)"), 2192),
        (LOOP.format("a[i] ^ (0x1234 if y > t else 0)"), 2193),
        (LOOP.format("a[i] - (y if y > t else 0)"), 2192),
        (LOOP.format("a[i] + (0 if y > t else y)"), 2492),
        (LOOP.format("a[i] * (y if y > t else 1)"), 2332),
        (LOOP.format("a[i] * (y if y > t else 0)"), 3112),
        (LOOP.format("a[i] & (y if y > t else -1)"), 2192),
        (SUM.format("s = s + (y if y > t else 0)"), 4234),
        (SUM.format("s = s + (5 if y > t else 0)"), 4034),
        (SUM.format("v = y - t if y > t else 0; s = s + v * 3"), 4314),
        (SUM.format("s = s + (1 if y > t else 0)"), 817),
        (SUM.format("s = s + (8 if y > t else 0)"), 1017),
        (BITS, 36833),
    ],
)
def test_estimates_are_near_what_gcc_makes(text: str, cycles: int, tmp_path: Path) -> None:
    """GCC 12.2's code of the exported C, in cycles of the GNU simulator; the estimates were 25 to 84 % below it."""
    check_estimate(text, cycles, 0.06, tmp_path)


def test_what_is_chosen_for_something_else_stays(tmp_path: Path) -> None:
    """A minimum, a flag, and a choice between two numbers that both change something take no branch beside the loop's."""
    for value in ("a[i] + max(y, 0)", "a[i] + (1 if y > t else 0)", "a[i] + (1000 if y > t else 7)"):
        plain = lowered(LOOP.format("a[i] + y"), tmp_path)
        chosen = lowered(LOOP.format(value), tmp_path)
        assert [chosen[each] for each in BRANCHES] == [plain[each] for each in BRANCHES], value


def test_it_is_gccs_alone(tmp_path: Path) -> None:
    """Nothing says that VisualDSP++ does so: there it is a conditional move."""
    text = LOOP.format("a[i] ^ (0x1234 if y > t else 0)")
    assert lowered(text, tmp_path, VDSP_O2)[Op.COND_MOVE] == 1
    assert lowered(text, tmp_path, GCC_O2)[Op.COND_MOVE] == 0


def test_one_redundancy_makes_others(tmp_path: Path) -> None:
    """Of `v = y if ... else 0` nothing is left on the way on which v is 0, neither its product nor the sum; the results are the same."""
    kernel = kernel_of(SUM.format("v = y if y > t else 0; s = s + v * 3"), tmp_path)
    values = arguments(kernel)[0]
    kept = values[:COUNT][values[:COUNT] > LIMIT]
    assert kernel(values, COUNT, LIMIT) == 3 * int(kept.sum())
