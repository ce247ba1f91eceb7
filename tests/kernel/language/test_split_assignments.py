"""An assignment to several targets, and a loop over an array, do what Python does."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bfsim.kernel.c import c_program
from tests.kernel.modules import import_text

TEXT = """
@kernel
def reverse(a: u8[:]):
    i, j = 0, len(a) - 1
    while i < j:
        a[i], a[j] = a[j], a[i]
        i, j = i + 1, j - 1

@kernel
def next_of(state: i32[:]) -> i32:
    state[0] += 1
    return state[0]

@kernel
def in_order(state: i32[:], out: i32[:]):
    out[next_of(state)], x, out[0] = next_of(state), next_of(state), state[0]
    out[1] = out[2] = x

@kernel
def extremes(a: i16[:], found: i32[:]):
    lo = hi = a[0]
    where = 0
    for i, v in enumerate(a):
        if v > hi:
            where = i
        lo, hi = min(lo, v), max(hi, v)
    found[0], found[1], found[2] = lo, hi, where

@kernel
def last_above(a: u8[:], least: i32) -> i32:
    found: u32 = 0
    value_1 = -1
    for v in a:
        if v < least:
            continue
        value_1, found = v, u32(value_1)
        if v == 255:
            break
    return value_1 + i32(found)
"""


def test_swaps_take_the_values_first(tmp_path: Path) -> None:
    """Elements of one array, and names that count."""
    array = np.arange(7, dtype=np.uint8)
    import_text(TEXT, tmp_path).reverse(array)
    assert array.tolist() == [6, 5, 4, 3, 2, 1, 0]


def test_values_are_found_from_left_to_right_and_then_targets(tmp_path: Path) -> None:
    """Calls, too: the index of the first target is the last of three."""
    module = import_text(TEXT, tmp_path)
    found, plain = np.zeros(4, np.int32), [0] * 4
    module.in_order(np.zeros(1, np.int32), found)
    module.in_order.python([0], plain)
    assert found.tolist() == plain == [2, 2, 2, 1]


def test_loops_over_elements(tmp_path: Path) -> None:
    """With a number and without, with `continue` and `break`, in a kernel that has the names that would be taken for hidden ones."""
    module = import_text(TEXT, tmp_path)
    found = np.zeros(3, np.int32)
    module.extremes(np.array([3, -5, 9, 2], np.int16), found)
    assert found.tolist() == [-5, 9, 2]
    row = [10, 200, 7, 255, 254]
    assert module.last_above(np.array(row, np.uint8), 9) == module.last_above.python(row, 9) == 455
    assert module.last_above(np.zeros(0, np.uint8), 9) == -1


def test_their_c_is_that_of_a_loop_that_counts(tmp_path: Path) -> None:
    """A hidden name is one that no other local of the kernel has."""
    module = import_text(TEXT, tmp_path, "loops")
    text = c_program([module.last_above.function]).files["loops.c"]
    assert (
        "for (int32_t value_2 = 0; value_2 < a_length; value_2++) {\n        int32_t v = a[value_2];" in text
    )
    assert "value_1 = value_3;\n        found = value_4;" in text


def test_a_stack_of_targets_costs_what_lines_of_their_own_do(tmp_path: Path) -> None:
    """`lo = hi = a[0]` loads once."""
    module = import_text(
        TEXT.replace("lo = hi = a[0]", "lo = a[0]\n    hi = lo").replace(
            "for i, v in enumerate(a):", "for i in range(len(a)):\n        v = a[i]"
        ),
        tmp_path,
    )
    array, found = np.arange(50, dtype=np.int16), np.zeros(3, np.int32)
    short = import_text(TEXT, tmp_path).extremes
    assert short.cost(array, found, profile="gcc-O2") == module.extremes.cost(array, found, profile="gcc-O2")
