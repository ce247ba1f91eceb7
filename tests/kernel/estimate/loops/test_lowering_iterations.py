"""What of a loop a compiler for the Blackfin leaves out, writes out, moves to where it is needed, or computes from what is there."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.twins.lines import grow_segments
from bfsim.kernel import GCC_O2, Kernel
from bfsim.kernel.estimate.costing import optimised
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.operations import Op
from tests.kernel.lowered import context, lowered
from tests.kernel.modules import import_text
from tests.kernel.running import CALLING_GCC

WINDOW = """
@kernel
def f(a: u8[:], out: u8[:], n: i32) -> None:
    for i in range({most}, n - {most}):
        m = 0
        for k in range(-{most}, {most} + 1):
            m = max(m, a[i + k])
        out[i] = m
"""


def code(text: str, folder: Path) -> str:
    """The optimised IR of the only kernel of `text`."""
    kernel: Kernel = import_text(text, folder).f
    return optimised(kernel.function, GCC_O2)


@pytest.mark.parametrize(("most", "loads"), [(1, 3), (2, 1)])
def test_a_loop_is_written_out_if_the_code_does_not_grow(most: int, loads: int, tmp_path: Path) -> None:
    """Three iterations of four statements cost what the loop does; five iterations would cost more."""
    assert code(WINDOW.format(most=most), tmp_path).count("= load i8") == loads


def test_loops_in_loops_are_written_out_from_the_inside(tmp_path: Path) -> None:
    """Four pixels of a square: neither loop is left, and what is left of the kernel is one loop."""
    text = """
@kernel
def f(a: u8[:], w: i32, out: u8[:]) -> None:
    for x in range(w):
        total = 0
        for dy in range(2):
            for dx in range(2):
                total += a[dy * w + 2 * x + dx]
        out[x] = total >> 2
"""
    found = code(text, tmp_path)
    assert found.count("= load i8") == 4
    assert found.count("!llvm.loop") <= 1


def test_a_step_that_is_no_power_of_two_is_not_counted(tmp_path: Path) -> None:
    """The number of iterations would take a division; a shift is fine."""
    text = "def f(a: u8[:], n: i32) -> i32:\n    s = 0\n    i = 0\n    while i < n:\n        s = s ^ a[i]\n        i += {}\n    return s\n"
    assert Op.LOOP_SETUP not in lowered(text.format(3), tmp_path)
    assert Op.LOOP_SETUP in lowered(text.format(4), tmp_path)


def test_a_range_is_one_test(tmp_path: Path) -> None:
    """A difference and an unsigned comparison; the second test has no comparison of its own."""
    text = "def f(c: i32, x: i32) -> i32:\n    if {}:\n        x = x * 7\n    return x\n"
    assert lowered(text.format("c >= 48 and c <= 57"), tmp_path)[Op.COMPARE] == 1
    assert lowered(text.format("c < 48 or c > 57"), tmp_path)[Op.COMPARE] == 1
    assert lowered(text.format("c == 3 or c == 4"), tmp_path)[Op.COMPARE] == 1
    assert lowered(text.format("c >= 48 and x <= 57"), tmp_path)[Op.COMPARE] == 2
    assert lowered(text.format("c == 3 or c == 5"), tmp_path)[Op.COMPARE] == 2


def test_the_second_part_of_a_condition_may_end_in_no_test(tmp_path: Path) -> None:
    """LLVM knows that p < p is false, and leaves a block that only goes on: no range, and no mistake."""
    text = (
        "def f(a: u8[:], x: i32) -> i32:\n"
        "    p = 1\n"
        "    for i in range(-p & 15):\n"
        "        p = a[p & 15]\n"
        "    k = 0\n"
        "    while k < 2 and (p < p or p < x):\n"
        "        k += 1\n"
        "    return p + p | p ^ p\n"
    )
    assert not context(text, tmp_path).ranges


def test_both_ends_of_a_range_are_found(tmp_path: Path) -> None:
    """However the tests are written, the range is 48 to 57, which is one comparison."""
    text = "def f(c: i32, x: i32) -> i32:\n    if {}:\n        x = x * 7\n    return x\n"
    found = lowered(text.format("47 < c and c < 58"), tmp_path)
    assert found[Op.COMPARE] == 1
    assert lowered(text.format("48 <= c <= 57"), tmp_path) == found
    assert lowered(text.format("not (c > 57 or 48 > c)"), tmp_path) == found


def test_a_flag_that_a_loop_carries_is_tested(tmp_path: Path) -> None:
    """What one iteration sets and another tests cannot be threaded; what ends its loop can."""
    carried = "def f(a: u8[:], n: i32) -> i32:\n    s = 0\n    on = 0\n    for i in range(n):\n        if a[i] != 0:\n            on = 0\n        elif on == 0:\n            s += i\n            on = 1\n    return s\n"
    assert not context(carried, tmp_path).jump_threading.names
    (routine, *_) = reversed(read_module(optimised(grow_segments.function, GCC_O2)))
    assert Context(routine, GCC_O2).jump_threading.names  # `found`, which ends the search


def test_the_remainder_written_as_a_difference_is_a_second_call(tmp_path: Path) -> None:
    """x - x / y * y is x % y, and no routine gives both."""
    text = "def f(p: u32, w: u32, out: u32[:]) -> None:\n    y = p // w\n    out[0] = y\n    out[1] = {}\n"
    assert lowered(text.format("p - y * w"), tmp_path) == lowered(text.format("p % w"), tmp_path)
    assert lowered(text.format("p - y * 3"), tmp_path)[Op.CALL] == 1


def test_a_counter_of_bytes_is_read_off_the_pointer(tmp_path: Path) -> None:
    """Where only some iterations want it and each looks at neighbours, nothing steps it; words would need a shift."""
    text = "def f(a: {}[:], n: i32, v: i32) -> i32:\n    at = 0\n    for i in range(n):\n        if a[i] > {}:\n            at = i\n            a[i] = 0\n    return at\n"
    assert context(text.format("u8", "a[i + 1]"), tmp_path).counters.eliminated
    assert not context(text.format("u8", "v"), tmp_path).counters.eliminated
    assert not context(text.format("i32", "a[i + 1]"), tmp_path).counters.eliminated


def test_what_only_some_iterations_load_needs_no_pointer_of_its_own(tmp_path: Path) -> None:
    """The row above is reached from the pointer that every iteration steps."""
    text = "def f(a: u8[:], p: i32, w: i32, n: i32) -> i32:\n    s = 0\n    for x in range(n):\n        if a[p + x] == 0:\n            s += a[p - w + x]\n    return s\n"
    here, above = context(text, tmp_path).induction_variables.all
    assert here.neighbour is None
    assert above.neighbour is here
    assert above.distance == (("%w", -1),)


def test_what_a_loop_sets_up_does_not_run_in_the_loop_before(tmp_path: Path) -> None:
    """LLVM lets a loop lead to the next one of as many iterations; there is a block between them."""
    text = "def f(a: i32[:], b: i32[:], n: i32) -> i32:\n    s = 0\n    for i in range(256):\n        s += a[i]\n        a[i] = s\n    for i in range(256):\n        s ^= b[i]\n        b[i] = s\n    return s\n"
    found = context(text, tmp_path).flow
    for loop in found.loops:
        assert found.innermost(found.entering(loop)) is found.around(loop)


def test_a_result_that_is_wanted_behind_the_next_call_moves_out_of_its_way(tmp_path: Path) -> None:
    """R0 is overwritten by the second call; what the second one returns stays there."""
    text = "def g(x: i32) -> i32:\n    s = 0\n    for i in range(x):\n        s = (s * 5) ^ i\n    return s\n\n\n@kernel\ndef f(x: i32) -> i32:\n    first = g(x)\n    return g({}) - {}\n"
    behind, before = (
        lowered(text.format(*each), tmp_path, CALLING_GCC) for each in (("3", "first"), ("first", "3"))
    )
    assert behind[Op.CALL] == before[Op.CALL] == 2
    assert behind[Op.MOVE] == before[Op.MOVE] + 1
