"""Registers: which bank sums of words are in, what counters of loops take, and what is loaded narrow and wanted wide."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.estimate.costing import optimised
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import beside_gcc
from tests.kernel.lowered import lowered
from tests.kernel.modules import kernel_of

WORDS = """
def f(a: i32[:], b: i32[:], c: i32[:], o: i32[:], n: i32) -> None:
    for i in range(n):
        o[i] = {0}
"""
TOTAL = """
def f(a: {0}[:], b: i32[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        s += {1}
    return s
"""
CHOSEN = """
def f(a: u8[:], b: i32[:], n: i32) -> i32:
    s = 0
    for i in range(n):
        if a[i] > 99:
            s += b[i]
    return s
"""
NARROW = """
def f(a: i16[:], o: i16[:], n: i32) -> None:
    for i in range(n):
        v = a[i]
        o[i] = {0}
"""
BYTES = """
def f(a: u8[:], o: u8[:], n: i32) -> None:
    for i in range(n):
        v = a[i]
        w = a[i + 9]
        least = min(v, w)
        o[i] = least ^ v ^ w
"""
CENTRE = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for y in range(12):
        for x in range(20):
            if a[y * 20 + x] > t:
                s += x
    return s
"""
MANY = """
def f(a: u8[:], b: u8[:], c: u8[:], d: u8[:], e: u8[:], g: u8[:], o: u8[:], n: i32) -> None:
    for i in range(n):
        o[i] = (a[i] + b[i] + c[i] + d[i] + e[i] + g[i]) >> 3
"""
EITHER = """
def f(a: u8[:], o: u8[:], n: i32, t: i32) -> None:
    for y in range(2):
        for x in range(t):
            if a[x] > t:
                o[y * t + x] = a[y + x]
            else:
                o[y * t + x] = n
"""
CASES = {
    "three words": (WORDS.format("(a[i] + b[i] + c[i]) >> 2"), 1644, 0.03),
    "a product and words": (WORDS.format("a[i] * b[i] + c[i] + a[i + 1]"), 2244, 0.03),
    "words in a total": (TOTAL.format("i32", "a[i]"), 616, 0.03),
    "pairs in a total": (TOTAL.format("i32", "a[i] + b[i]"), 1042, 0.03),
    "a narrow tree": (NARROW.format("(v & 1000) ^ ((v >> 1) & 1077)"), 1443, 0.03),
    "a narrow tree of bytes": (BYTES, 1611, 0.03),
    "a counter that few want": (CENTRE, 6043, 0.06),
    "more pointers than registers": (MANY, 3045, 0.03),
    "one place on both sides of a test": (EITHER, 2872, 0.05),
    "words of some iterations wait in memory": (CHOSEN, 2545, 0.005),
    "two words": (WORDS.format("(a[i] + b[i]) >> 2"), 1041, 0.04),
    "a word less": (WORDS.format("(a[i] + b[i] - c[i]) >> 2"), 1442, 0.03),
    "a half-word and a word in a total": (TOTAL.format("i16", "a[i] + b[i]"), 842, 0.04),
}
"""A kernel, its cycles, and how near to them the estimate is. In the last three, nothing is moved or extended."""


test_estimates_are_near_what_gcc_makes, test_they_compute_what_python_does = beside_gcc(CASES)


def made(name: str, op: Op, folder: Path) -> tuple[int, int]:
    """How many of an operation a case takes by GCC's rules, and by VisualDSP++'s."""
    text = CASES[name][0]
    return lowered(text, folder, GCC_O2)[op], lowered(text, folder, VDSP_O2)[op]


@pytest.mark.parametrize(
    "name", ["three words", "a product and words", "words in a total", "pairs in a total"]
)
def test_what_a_chain_adds_first_is_moved_once(name: str, tmp_path: Path) -> None:
    """By GCC, whose second pass over the classes wants it in pointer registers."""
    ours, others = made(name, Op.MOVE, tmp_path)
    assert ours == others + 1


@pytest.mark.parametrize("name", ["two words", "a word less", "a half-word and a word in a total"])
def test_sums_that_are_wanted_at_once_are_in_data_registers(name: str, tmp_path: Path) -> None:
    """A sum that is shifted or subtracted from, or of what only a data register can be loaded with."""
    ours, others = made(name, Op.MOVE, tmp_path)
    assert ours == others


@pytest.mark.parametrize(("name", "times"), [("a narrow tree", 1), ("a narrow tree of bytes", 2)])
def test_what_is_narrow_and_wide_is_extended_apart(name: str, times: int, tmp_path: Path) -> None:
    """Once for each such value."""
    ours, others = made(name, Op.EXTEND, tmp_path)
    assert ours == others + times


def test_invariants_of_both_sides_are_one_pointer(tmp_path: Path) -> None:
    """The row's begin is computed on both sides of a test, and outside of the loop once."""
    (routine,) = read_module(optimised(kernel_of(EITHER, tmp_path).function, GCC_O2))
    variables = Context(routine, GCC_O2).induction_variables.all
    assert [each.root for each in variables].count("%o") == 1
