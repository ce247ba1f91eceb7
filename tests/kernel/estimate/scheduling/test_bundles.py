"""An access shares a bundle with a 32-bit instruction where GCC issues both in one cycle: it takes none of its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.profile import PROFILES
from bfsim.kernel.rules import Rule
from tests.kernel.beside_gcc import arguments, check_estimate
from tests.kernel.modules import kernel_of

MEDIAN = """
def f(a: u8[:], b: u8[:], c: u8[:], o: u8[:], n: i32) -> None:
    for i in range(n):
        x = a[i]
        y = b[i]
        o[i] = max(min(x, y), min(max(x, y), c[i]))
"""
BUTTERFLY = """
def f(a: i16[:], b: i16[:], w: i16[:], n: i32) -> None:
    for i in range(n):
        x = a[i]
        y = (b[i] * w[i]) >> 15
        a[i] = x + y
        b[i] = x - y
"""
EDGES = """
def f(a: u8[:], o: u8[:], n: i32) -> None:
    before = a[0]
    for i in range(1, n):
        here = a[i]
        o[i] = abs(here - before)
        before = here
"""
BYTES = """
def f(a: u32[:], o: u8[:], n: i32) -> None:
    for i in range(n // 4):
        v = a[i]
        o[4 * i] = v & 255
        o[4 * i + 1] = (v >> 8) & 255
        o[4 * i + 2] = (v >> 16) & 255
        o[4 * i + 3] = v >> 24
"""
CHECKSUM = """
def f(a: u8[:], o: u16[:], table: u16[:], n: i32) -> None:
    crc = 0xFFFF
    for i in range(n):
        crc = ((crc << 8) & 0xFF00) ^ table[(crc >> 8) ^ a[i]]
    o[0] = crc
"""
MAXIMUM = """
def f(a: u8[:], o: u8[:], n: i32) -> None:
    for i in range(1, n - 1):
        o[i] = max(a[i - 1], a[i], a[i + 1])
"""
SUM = """
def f(a: i16[:], b: i16[:], c: i16[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        s += (a[i] * b[i] >> 4) - (b[i] * c[i] >> 4)
    return s
"""


@pytest.mark.parametrize(
    ("text", "cycles"),
    [
        (MEDIAN, 1438),
        (BUTTERFLY, 1616),
        (EDGES, 838),
        (BYTES, 416),
        (CHECKSUM, 1639),
        (MAXIMUM, 1399),
        (SUM, 1818),
    ],
)
def test_estimates_are_near_what_gcc_makes(text: str, cycles: int, tmp_path: Path) -> None:
    """GCC 12.2's code of the exported C, in cycles of the GNU simulator; those with bundles were 12 to 20 % above it."""
    check_estimate(text, cycles, 0.04, tmp_path)


def test_what_depends_on_a_load_is_not_issued_with_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two maxima behind their loads, and products of which each waits for the next load, take as long as without bundles."""
    monkeypatch.setitem(PROFILES, "alone", replace(GCC_O2, without=(Rule.BUNDLES,)))
    for text, shares in ((MAXIMUM, False), (SUM, False), (MEDIAN, True)):
        kernel = kernel_of(text, tmp_path)
        found = [kernel.cost(*arguments(kernel), profile=name) for name in ("gcc-O2", "alone")]
        assert (found[0] < found[1]) is shares


def test_visualdsp_bundles_by_its_own_rules() -> None:
    """What GCC's schedule brings together says nothing of another compiler's."""
    assert VDSP_O2.parallel_issue
    assert not VDSP_O2.applies(Rule.BUNDLES)
