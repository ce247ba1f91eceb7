"""Predictive commoning: what an iteration loads that an earlier one has loaded or stored goes along in registers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bfsim.kernel import GCC_O2, VDSP_O2, CompilerProfile
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import arguments, beside_gcc
from tests.kernel.lowered import lowered
from tests.kernel.modules import kernel_of

WALK = """
def f(a: {0}[:], n: i32) -> i32:
    s = 0
    for i in range({1}):
        {2}
    return s
"""
PATCH = """
def f(a: u8[:], n: i32) -> i32:
    s = 0
    for y in range(1, 7):
        for x in range(1, 9):
            gx = a[10 * y + x + 1] - a[10 * y + x - 1]
            gy = a[10 * y + x + 10] - a[10 * y + x - 10]
            s += gx * gx + gy * gy
    return s
"""
REPAIRED = """
def f(a: u16[:], n: i32) -> i32:
    found = 0
    for i in range(n - 2):
        v = a[i]
        if v > a[i + 2] + 40:
            v = a[i + 2]
            found += 1
        a[i] = v >> 1
    return found
"""
SUMMED = """
def f(a: u8[:], o: i32[:], n: i32) -> None:
    o[0] = a[0]
    for i in range(1, n):
        o[i] = o[i - 1] + a[i]
"""
SMOOTHED = """
def f(a: i16[:], o: i16[:], n: i32) -> None:
    for i in range(2, n):
        o[i] = (o[i - 1] + o[i - 2] + a[i]) >> 2
"""
STORED = """
def f(a: i16[:], o: i16[:], n: i32) -> None:
    for i in range(1, n):
        o[i] = a[i - 1] - a[i]
"""
PERHAPS = """
def f(a: u8[:], n: i32) -> i32:
    s = 0
    for i in range(1, n):
        if a[i] != 7:
            s += a[i - 1]
    return s
"""
CASES = {
    "bytes": (WALK.format("u8", "1, n", "s += abs(a[i] - a[i - 1])"), 1409, 0.15),
    "half-words": (WALK.format("i16", "1, n", "s += abs(a[i] - a[i - 1])"), 1412, 0.15),
    "words": (WALK.format("i32", "1, n", "s += abs(a[i] - a[i - 1])"), 815, 0.15),
    "downwards": (WALK.format("i16", "n - 2, 0, -1", "s += (a[i] - a[i + 1]) * 3"), 1802, 0.15),
    "two apart": (
        WALK.format("i16", "1, n - 1", "s += (a[i + 1] - a[i - 1]) * (a[i + 1] - a[i - 1])"),
        5179,
        0.05,
    ),
    "three apart": (WALK.format("i16", "3, n", "s += a[i] * a[i - 3]"), 4366, 0.1),
    "a window": (WALK.format("i16", "1, n - 1", "s = max(s, a[i - 1] + 2 * a[i] + a[i + 1])"), 5575, 0.05),
    "every second one": (
        WALK.format("i16", "1, n >> 1", "s += a[2 * i] * a[2 * i - 2] + a[2 * i + 1]"),
        714,
        0.15,
    ),
    "a patch": (PATCH, 1572, 0.15),
    "before a store of the same": (REPAIRED, 3326, 0.15),
    "what was stored": (SUMMED, 640, 0.15),
    "what was stored twice before": (SMOOTHED, 1828, 0.15),
}
"""A kernel, its cycles, and how near to them the estimate is."""
LOADS = {
    "bytes": 1, "half-words": 1, "words": 1, "two apart": 1, "three apart": 1, "a window": 1,
    "before a store of the same": 1, "what was stored": 1, "what was stored twice before": 1,
}  # fmt: skip
"""Loads of one iteration."""
KEPT = {
    "four apart": (WALK.format("i16", "4, n", "s += a[i] * a[i - 4]"), 2),
    "of different steps": (WALK.format("i16", "1, n >> 1", "s += a[2 * i] * a[i]"), 1),
    "no whole step apart": (WALK.format("i16", "1, n >> 1", "s += a[2 * i] * a[2 * i - 1]"), 1),
    "beside a store that may meet them": (STORED, 2),
    "not made in every iteration": (PERHAPS, 2),
}
"""Loops in which GCC carries nothing, and the loads of an iteration, or of half a one."""


test_estimates_are_near_what_gcc_makes, test_they_compute_what_python_does = beside_gcc(
    CASES, others={name: text for name, (text, *_) in KEPT.items()}, counts=(0, 1, 2, 3, 4, 5, 90)
)


def loads(text: str, folder: Path, profile: CompilerProfile = GCC_O2) -> int:
    """How many elements a kernel loads more for each further iteration."""
    kernel = kernel_of(text, folder)
    code = kernel.compile(profile)
    made = []
    for count in (40, 50):
        given = [count if isinstance(each, int) else each for each in arguments(kernel)]
        totals = code.new_totals()
        arrays = [each for each in given if isinstance(each, np.ndarray)]
        kernel.prepare(code, arrays, totals).run(*given)
        made.append(
            sum(
                access.times(totals[number])
                for number, counter in enumerate(code.counters)
                for access in counter.accesses
                if not access.writes
            )
        )
    return int(made[1] - made[0]) // 10


@pytest.mark.parametrize("name", LOADS)
def test_each_element_is_loaded_once(name: str, tmp_path: Path) -> None:
    """By GCC; nothing says that VisualDSP++ does so."""
    text = CASES[name][0]
    assert loads(text, tmp_path) == LOADS[name]
    assert loads(text, tmp_path, VDSP_O2) > LOADS[name]


@pytest.mark.parametrize("name", KEPT)
def test_what_gcc_loads_again_is_loaded_again(name: str, tmp_path: Path) -> None:
    """Nothing goes along that another store may have changed, that is not always loaded, or too far."""
    text, made = KEPT[name]
    assert loads(text, tmp_path) == made


def test_a_loop_that_hands_two_values_on_is_no_hardware_loop(tmp_path: Path) -> None:
    """The last of them is copied on the way back, in a block of its own."""
    text = CASES["two apart"][0]
    assert lowered(text, tmp_path, GCC_O2)[Op.LOOP_SETUP] == 0
    assert lowered(text, tmp_path, VDSP_O2)[Op.LOOP_SETUP] == 1
