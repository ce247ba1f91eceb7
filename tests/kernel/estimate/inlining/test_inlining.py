"""What is inlined, and that nothing else than cycles and code changes by it: values, calls and lines are counted as before."""

from __future__ import annotations

from collections import Counter as Tally
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.explain import explain
from bfsim.kernel import GCC_O0, GCC_O2, VDSP_O2, CompilerProfile, Kernel
from bfsim.kernel.estimate.inlining import gimple_size
from bfsim.kernel.estimate.inlining.inlining import Decision, Why, decisions
from bfsim.kernel.profile import Inlines
from tests.kernel.modules import import_text
from tests.kernel.running import CALLING_GCC, CALLING_VDSP, run

LARGE = """
def {name}(a: i32[:], x: i32) -> i32:
    total = x
    for i in range(4, len(a) - 4):
        if a[i] > total and a[i - 1] < a[i + 1]:
            total = total * 3 + a[i + 2] - a[i - 3]
        elif a[i] < x:
            total = total ^ a[i + 4]
        a[i] = total + (x << 2)
    return total
"""
SMALL = """
def twice(x: i32) -> i32:
    return x + x
"""
PUT = """
def put(out: u8[:], bits: u32[:], value: u32, n: i32, at: i32):
    bits[{0}0] = (bits[{0}0] << n) | value
    bits[{0}1] += u32(n)
    while bits[{0}1] >= 8:
        bits[{0}1] -= 8
        out[bits[{0}2]] = bits[{0}0] >> bits[{0}1]
        bits[{0}2] += 1


def top(out: u8[:], bits: u32[:], row: u8[:], k: i32) -> i32:
    for i in range(len(row)):
        q = row[i] >> k
        if q < 12:
            put(out, bits, u32(q), q + 1, i)
            put(out, bits, u32(row[i]), k, i)
        else:
            put(out, bits, 0xFFF, 12, i)
            put(out, bits, u32(row[i]), 8, i)
    return i32(bits[2])
"""
TOP = """
@kernel
def top(a: i32[:]) -> i32:
    s = 0
    for i in range(len(a)):
        s = s + {expression}
    return s
"""


def kernels(text: str, folder: Path, name: str | None = None) -> Any:
    """Import kernels; the decorator is written before each `def`."""
    return import_text(
        text.replace("\ndef ", "\n@kernel\ndef ").replace("@kernel\n@kernel", "@kernel"), folder, name
    )


def decided(kernel: Kernel, profile: CompilerProfile = GCC_O2) -> dict[str, Decision]:
    """What became of the calls of each kernel, by its name."""
    return {each.callee.rsplit("_", 1)[-1]: each for each in decisions(kernel.function, profile)}


def counted(
    kernel: Kernel, profile: CompilerProfile, *arguments: Any
) -> tuple[Tally[str], Tally[tuple[str, int]]]:
    """Run a kernel; return how often each kernel was entered, and how often each of their lines ran at its most."""
    code = kernel.compile(profile)
    totals = code.new_totals()
    arrays = [each for each in arguments if isinstance(each, np.ndarray)]
    kernel.prepare(code, arrays, totals).run(*arguments)
    entered: Tally[str] = Tally()
    lines: Tally[tuple[str, int]] = Tally()
    for counter, events in zip(code.counters, totals.tolist(), strict=True):
        for symbol, *_ in counter.enters:
            entered[symbol.rsplit("_", 1)[-1]] += events
        for place, _, _ in counter.line_cclk if counter.value is None else ():
            key = (place.routine.rsplit("_", 1)[-1], place.line)
            lines[key] = max(lines[key], events)
    return entered, lines


def test_a_small_kernel_of_the_same_file_is_inlined(tmp_path: Path) -> None:
    """The code shrinks by it: no call, no return, and the sum of the operations that do something."""
    top = kernels(SMALL + TOP.format(expression="twice(a[i])"), tmp_path).top
    assert decided(top)["twice"].why is Why.SHRINKS
    a = np.arange(20, dtype=np.int32)
    inlined, called = (run(top, a, profile=each) for each in (GCC_O2, CALLING_GCC))
    assert inlined.value == called.value == 2 * a.sum()
    per_call = 5 + 5  # CALL and RTS
    assert called.issue_cclk - inlined.issue_cclk > len(a) * per_call
    assert set(top.code_bytes(GCC_O2)) == {top.function.symbol}  # nothing calls the other one any more


def test_what_is_called_once_is_inlined_whatever_its_size(tmp_path: Path) -> None:
    """A static kernel with one call goes away; with two calls, code would grow."""
    once = kernels(LARGE.format(name="large") + TOP.format(expression="large(a, i)"), tmp_path).top
    assert (decided(once)["large"].inlined, decided(once)["large"].why) == (True, Why.ONCE)
    twice = kernels(
        LARGE.format(name="large") + TOP.format(expression="large(a, i) + large(a, 2 * i)"), tmp_path
    ).top
    assert (decided(twice)["large"].inlined, decided(twice)["large"].why) == (False, Why.LARGE)


def test_of_accesses_to_what_is_handed_over_half_are_expected_to_go(tmp_path: Path) -> None:
    """So state[0] makes a kernel half a statement larger, and state[n] a whole one: GCC 12.2 inlines this one with the first alone."""
    fixed, chosen = (decided(kernels(PUT.format(place), tmp_path).top)["put"] for place in ("", "at + "))
    assert (fixed.inlined, fixed.why) == (True, Why.SMALL)
    assert not chosen.inlined
    assert chosen.growth > fixed.growth


def test_calls_from_other_kernels_of_the_file_count(tmp_path: Path) -> None:
    """What `top` calls once is called twice if another kernel of its file calls it too."""
    other = TOP.format(expression="large(a, 2 * i)").replace("def top", "def other")
    module = kernels(LARGE.format(name="large") + TOP.format(expression="large(a, i)") + other, tmp_path)
    assert not decided(module.top)["large"].inlined
    assert not decided(module.other)["large"].inlined


def test_a_kernel_that_the_file_names_elsewhere_is_not_static(tmp_path: Path) -> None:
    """Who runs it by itself keeps it: one call among kernels is not the only one."""
    text = LARGE.format(name="large") + TOP.format(expression="large(a, i)")
    assert kernels(text, tmp_path).large.function.is_static
    module = kernels(text + "\nstages = [large, top]\n", tmp_path)
    assert not module.large.function.is_static
    assert not decided(module.top)["large"].inlined


def test_a_kernel_of_another_file_is_called(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """C files are compiled one by one; a profile may see the whole program."""
    monkeypatch.syspath_prepend(tmp_path)
    kernels(SMALL, tmp_path, "helpers_apart")
    top = kernels("from helpers_apart import twice\n" + TOP.format(expression="twice(a[i])"), tmp_path).top
    assert (decided(top)["twice"].inlined, decided(top)["twice"].why) == (False, Why.UNSEEN)
    assert decided(top, replace(GCC_O2, inlines=Inlines.PROGRAM))["twice"].inlined


def test_without_optimisation_or_by_the_profile_nothing_is_inlined(tmp_path: Path) -> None:
    """-O0 calls, and so does a profile that says so."""
    top = kernels(SMALL + TOP.format(expression="twice(a[i])"), tmp_path).top
    assert decided(top, GCC_O0) == decided(top, CALLING_GCC) == {}


EARLY_RETURN = """
def first_above(a: i32[:], limit: i32, begin: i32) -> i32:
    for i in range(begin, len(a)):
        if a[i] > limit:
            return i
    return -1

def clamp(x: i32) -> i32:
    if x < 0:
        return 0
    if x > 9:
        return 9
    return x

def top(a: i32[:], b: u8[:]) -> i32:
    s = 0
    for i in range(len(b)):
        s = s * 3 + first_above(a, b[i], 0) + clamp(i - 4)
        if clamp(s) == 9:
            s = clamp(b[i]) - 20
    return s
"""


def test_values_calls_and_lines_are_those_of_real_calls(tmp_path: Path) -> None:
    """Early returns, loops and arrays in what is inlined: the same results, as many calls, each line as often."""
    top = kernels(EARLY_RETURN, tmp_path).top
    a, b = np.array([3, 9, 2, 40], np.int32), np.arange(0, 50, 3).astype(np.uint8)
    values = {run(top, a, b, profile=each).value for each in (VDSP_O2, CALLING_VDSP)}
    assert len(values) == 1
    assert all(each.inlined for each in decided(top, VDSP_O2).values())
    entered, lines = counted(top, VDSP_O2, a, b)
    called, called_lines = counted(top, CALLING_VDSP, a, b)
    assert entered == called == {"top": 1, "above": len(b), "clamp": called["clamp"]}
    tests = [("above", 4), ("top", 5)]  # lines that every compiler leaves where they are
    assert [lines[each] for each in tests] == [called_lines[each] for each in tests]
    assert lines[tests[0]] > len(b)


def test_the_explanation_says_what_became_of_each_call(tmp_path: Path) -> None:
    """Own lines are own cycles; those of an inlined kernel stand under its name; the reasons are told."""
    top = kernels(
        LARGE.format(name="large") + SMALL + TOP.format(expression="large(a, i) + twice(i)"), tmp_path
    ).top
    found = explain(top, GCC_O2)
    assert {(each.callee, each.inlined, each.why) for each in found.kernel_calls} == {
        ("large", True, Why.ONCE.value), ("twice", True, Why.SHRINKS.value),
    }  # fmt: skip
    large = next(each for each in found.inlined if each.kernel == "large")
    by_text = {each.text.strip(): each for each in large.lines}
    assert by_text["a[i] = total + (x << 2)"].operations
    assert not any("total" in each.text for each in found.lines)
    bytes_of = sum(each.nbytes for each in top.counters(GCC_O2))
    assert found.code_bytes == bytes_of


def test_an_estimate_is_made_once_for_all_programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The cache has what another process would estimate again, to the last bit; another text is estimated by itself."""
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))
    text = LARGE.format(name="large") + SMALL + TOP.format(expression="large(a, i) + twice(i)")
    again = gimple_size.estimate.__wrapped__  # as in a process that has estimated nothing
    top = kernels(text, tmp_path).top.function
    made = again(top)
    assert {each.callee.rpartition("_")[2] for each in made.calls} == {"large", "twice"}
    estimated = []
    monkeypatch.setattr(gimple_size, "_estimated", lambda function: estimated.append(function) or made)
    changed = kernels(text.replace("s = 0", "s = 1"), tmp_path).top.function
    assert [again(each) for each in (top, changed)] == [made, made]
    assert estimated == [changed]


def test_bits_that_are_counted_are_one_statement(tmp_path: Path) -> None:
    """So a helper that counts those of four words is small enough; with as many other operations it is not."""
    count = """
def count(a: u32[:], at: i32) -> i32:
    total = 0
    for k in range(4):
        v = a[at + k] ^ a[k]
        v = v - ((v >> 1) & 0x55555555)
        v = (v & 0x33333333) + ((v >> 2) & 0x33333333)
        v = (v + (v >> 4)) & 0x0F0F0F0F
        total += i32((v * 0x01010101) >> 24)
    return total


def top(a: u32[:], out: i32[:]) -> i32:
    least = 129
    for i in range(len(out)):
        out[i] = count(a, 4 * i)
        least = min(least, count(a, i))
    return least
"""
    assert decided(kernels(count, tmp_path).top)["count"].inlined
    other = count.replace("0x01010101", "0x01010103")
    assert not decided(kernels(other, tmp_path).top)["count"].inlined
