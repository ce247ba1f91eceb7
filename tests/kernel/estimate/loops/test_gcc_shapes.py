"""Shapes that GCC's middle end gives to loops: windows, final values, counters that stay, bits counted in parallel."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule
from tests.kernel.lowered import context, lowered

WINDOW = """
def f(a: u8[:], out: u8[:], w: i32):
    for x in range(1, w - 1):
        high = 0
        for near in range(x - 1, x + 2):
            high = max(high, a[near])
        out[x] = high
"""
SUM = """
def f(a: u8[:], n: i32) -> i32:
    total = 0
    at = 0
    while at < n:
        stop = min(at + 64, n)
        while at < stop:
            total += a[at]
            at += 1
        total = total & 4095
    return total
"""
BITS = """
def f(a: u32[:], n: i32) -> u32:
    total = u32(0)
    for i in range(n):
        x = a[i]
        x = x - ((x >> 1) & 0x55555555)
        x = (x & 0x33333333) + ((x >> 2) & 0x33333333)
        total += (((x + (x >> 4)) & 0x0F0F0F0F) * 0x01010101) >> 24
    return total
"""
BREAK = """
def f(a: u8[:], b: u8[:], n: i32, most: i32) -> i32:
    total = 0
    for k in range(n):
        d = a[k] - b[k]
        total += d * d
        if total >= most:
            break
    return total
"""
COUNTER = """
def f(a: u8[:], b: i16[:], out: u8[:], w: i32, y: i32):
    for x in range(w):
        v = a[y * w + x]
        if v > b[x]:
            if x < out[v]:
                out[v] = x
            if x > out[v + 100]:
                out[v + 100] = x
"""
DOWNWARDS = """
def f(a: u8[:], n: i32) -> i32:
    kept = 0
    for x in range(n - 1, -1, -1):
        if a[x] == 3:
            kept += 1
        else:
            a[x] = 0
    return kept
"""


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        (SUM, Rule.FINAL_VALUES),
        (BITS, Rule.PARALLEL_COUNTS),
        (BREAK, Rule.COPIED_BREAKS),
        (DOWNWARDS, Rule.DOWNWARD_POINTERS),
        (COUNTER, Rule.FREQUENT_COUNTERS),
        (WINDOW, Rule.LAGGING_COUNTERS),
    ],
)
def test_each_rule_makes_a_difference(text: str, rule: Rule, tmp_path: Path) -> None:
    """What GCC makes of these differs from what is predicted without the rule."""
    assert lowered(text, tmp_path) != lowered(text, tmp_path, replace(GCC_O2, without=(rule,)))


def test_a_window_of_three_is_no_hardware_loop(tmp_path: Path) -> None:
    """From x - 1 to x + 2: GCC knows that these are three iterations."""
    known = context(WINDOW, tmp_path)
    inner, outer = known.flow.loops
    assert known.evolution.iterations(inner) == 3
    assert known.counters.counted == {outer.header}


def test_bits_counted_in_parallel_are_one_operation(tmp_path: Path) -> None:
    """ONES and what extends it: no product, no shift."""
    found = lowered(BITS, tmp_path)
    assert not found[Op.MUL32] and not found[Op.SHIFT]
    assert found[Op.EXTEND] == 1


def test_three_small_iterations_are_written_out(tmp_path: Path) -> None:
    """So they are by GCC 12.2, and four are not."""
    loops = [
        len(
            context(
                f"def f(a: i32[:]):\n    for i in range({n}):\n        a[i] = a[i] ^ 5\n", tmp_path
            ).flow.loops
        )
        for n in (3, 4)
    ]
    assert loops == [0, 1]
