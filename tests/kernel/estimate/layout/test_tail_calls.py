"""The ends of functions as GCC 12 makes them for the Blackfin at -O2: calls that are jumps, and returns that come too early."""

from __future__ import annotations

from collections import Counter as Tally
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.kernel import Kernel
from bfsim.kernel.operations import Op
from tests.kernel.modules import import_text
from tests.kernel.running import CALLING_GCC, run

TEXT = """
@kernel
def g(a: i32, b: i32) -> i32:
    return a * b + (a ^ b)

@kernel
def big(a: i32, b: i32, c: i32, d: i32) -> i32:
    return a * b + (c ^ d)

@kernel
def nothing():
    pass

@kernel
def next_one(a: i32) -> i32:
    return a + 1

@kernel
def fourth(a: i32[:]) -> i32:
    return a[3]

@kernel
def jumps(a: i32, b: i32, c: i32, d: i32) -> i32:
    {body}

@kernel
def few(a: i32, b: i32) -> i32:
    {few}
"""


def operations(folder: Path, name: str = "jumps", body: str = "return 1", few: str = "return 1") -> list[Op]:
    """Operations of a kernel of TEXT, without those of the kernels that it calls."""
    kernel = getattr(import_text(TEXT.format(body=body, few=few), folder), name)
    own = (
        each
        for each in kernel.counters(CALLING_GCC)
        if each.routine == kernel.function.symbol and each.value is None
    )
    return [charge.op for each in own for charge in each.charges for _ in range(charge.times)]


@pytest.mark.parametrize(
    ("body", "calls", "jumps"),
    [
        ("return g(b, a)", 0, 1),
        ("return big(d, c, b, a)", 0, 1),  # the fourth argument has room where the caller's own was
        ("return g(b, a) + 1", 1, 0),
        ("return g(g(a, b), c)", 1, 1),
        ("return a // b", 1, 0),  # a routine of the library
    ],
)
def test_a_call_right_before_the_return_is_a_jump(body: str, calls: int, jumps: int, tmp_path: Path) -> None:
    """`jump.l _g`: no return of its own; RETS is saved only for other calls."""
    found = operations(tmp_path, body=body)
    own = [each for each in found if each is not Op.RETURN]
    assert (own.count(Op.CALL) > 0, own.count(Op.TAIL_CALL)) == (calls > 0, jumps)
    assert (Op.RETURN in found) == (jumps == 0 or "//" in body)
    assert (Op.POP in found) == (calls > 0)


def test_arguments_that_need_more_room_than_the_callers_own_are_called(tmp_path: Path) -> None:
    """Four arguments put one on the stack, where a function of two has none."""
    found = operations(tmp_path, "few", few="return big(a, b, a, b)")
    assert (found.count(Op.CALL), found.count(Op.TAIL_CALL)) == (1, 0)


def test_a_return_on_the_way_does_not_hinder_the_jump(tmp_path: Path) -> None:
    """Where both ways of an `if` end in one return, the way of the call has none."""
    module = import_text(
        TEXT.format(body="return 1", few="if a < 0:\n        return g(a, b)\n    return a + b"), tmp_path
    )
    jumped, added = (run(module.few, a, 4, profile=CALLING_GCC).issue_cclk for a in (-1, 1))
    called = run(module.g, -1, 4, profile=CALLING_GCC).issue_cclk
    assert jumped - called == pytest.approx(
        17, abs=1
    )  # P2 = R0; CC = P2 < 0; IF CC JUMP, taken; R0 = P2; JUMP.L _g
    assert added < jumped - called


SEVERAL_ENDS = """
@kernel
def g(a: i32, b: i32) -> i32:
    return a * b + (a ^ b)

@kernel
def ways(a: i32, b: i32) -> i32:
    if a < 0:
        return g(b, a)
    if b < 0:
        return g(a, a)
    return a + b

@kernel
def clear(out: u8[:], count: i32):
    if count > 0:
        for x in range(count):
            out[x] = 0
"""


def own_by_line(kernel: Kernel, *arguments: Any) -> Tally[tuple[int, str]]:
    """Return how often operations of a kernel's own ran, by line of the kernel and operation; what ran no time is there, too."""
    code = kernel.compile(CALLING_GCC)
    totals = code.new_totals()
    kernel.prepare(code, [each for each in arguments if isinstance(each, np.ndarray)], totals).run(*arguments)
    found: Tally[tuple[int, str]] = Tally()
    for counter, events in zip(code.counters, totals.tolist(), strict=False):
        for place, name, times, _ in counter.line_operations:
            if place.routine == kernel.function.symbol:
                found[place.line, name] += times * events
    return found


@pytest.mark.parametrize(
    ("name", "arguments", "jumps"),
    [
        ("ways", (-1, 4), 1),
        ("ways", (1, -4), 1),
        ("ways", (1, 4), 0),
        ("clear", (np.ones(40, np.uint8), 40), 1),  # of memset
        ("clear", (np.ones(40, np.uint8), 0), 0),
    ],
)
def test_the_return_that_a_jump_leaves_out_is_taken_off_the_line_of_that_return(
    name: str, arguments: tuple[Any, ...], jumps: int, tmp_path: Path
) -> None:
    """The one return of several ends is of another line than the jumps; no line does anything less than no time."""
    found = own_by_line(getattr(import_text(SEVERAL_ENDS, tmp_path), name), *arguments)
    assert {each: times for each, times in found.items() if times < 0} == {}
    assert sum(times for (_, op), times in found.items() if op == Op.TAIL_CALL.value) == jumps
    assert sum(times for (_, op), times in found.items() if op == Op.RETURN.value) == 1 - jumps


@pytest.mark.parametrize(("name", "nops"), [("nothing", 4), ("next_one", 3), ("fourth", 2), ("g", 0)])
def test_short_functions_are_padded(name: str, nops: int, tmp_path: Path) -> None:
    """Four cycles before an RTS at least [anomaly 05000371]; `fourth` moves its argument to a P register."""
    assert operations(tmp_path, name).count(Op.NOP) == nops
    module = import_text(TEXT.format(body="return 1", few="return 1"), tmp_path)
    arguments = {"nothing": (), "next_one": (3,), "fourth": (np.zeros(4, np.int32),), "g": (3, 4)}[name]
    measured = {"nothing": 9, "next_one": 9, "fourth": 9, "g": 11}[name]  # GNU simulator
    assert run(getattr(module, name), *arguments, profile=CALLING_GCC).issue_cclk == measured
