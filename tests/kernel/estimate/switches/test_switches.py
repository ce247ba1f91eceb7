"""Chains of tests of one value for numbers: jumps by tables, loads from them, states that lead on, tests for bits of a mask; and the signs of dividends."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from bfsim.errors import KernelError
from bfsim.kernel import GCC_O2
from bfsim.kernel.estimate.costing import optimised
from bfsim.kernel.estimate.switches.hidden_numbers import revealed
from bfsim.kernel.rules import Rule
from tests.kernel.beside_gcc import beside_gcc, check_meaning
from tests.kernel.decisions import Decisions
from tests.kernel.modules import kernel_of
from tests.tiers import exhaustive

IN_A_LOOP = """
def f(a: u8[:], o: u8[:], n: i32) -> i32:
    s = 0
    t = 0
    for i in range(n):
        c = {}
{}
    return s + t
"""
ARMS = ("s += 3", "s -= t", "t += 5", "t = s >> 1", "s = t * 3", "s ^= t", "o[i] = s & 255")


def chain(number: int, *, last: str = "o[0] = t & 255") -> str:
    """Return tests for the numbers from 0 on, and what is done in each case."""
    rows = [
        f"        {'elif' if case else 'if'} c == {case}:\n            {ARMS[case]}" for case in range(number)
    ]
    return "\n".join((*rows, f"        else:\n            {last}"))


def states(*arms: str) -> str:
    """Return a machine whose state is tested for the numbers from 0 on."""
    rows = [
        f"        {'elif' if case else 'if'} t == {case}:\n            {arm}" for case, arm in enumerate(arms)
    ]
    return "\n".join(rows)


SET = "\n            ".join
PACKETS = states(
    SET(("if c > 128:", "    t = 1")),
    SET(("t = 2", "s = c")),
    SET(("s ^= c", "t = 3")),
    SET(("s += c", "t = 4")),
    SET(("if c > 192:", "    t = 5")),
    SET(("o[i] = s & 255", "t = 0")),
)
CHOOSING_STATES = states(
    SET(("if c > 64:", "    t = 1")),
    "t = 2 if c > 32 else 3",
    SET(("s = c", "t = 3")),
    "t = 4 if c & 1 else 5",
    SET(("s += 1", "if c > 200:", "    t = 5")),
    SET(("o[i] = s & 255", "t = 6")),
    SET(("s += c", "t = 0")),
)
GAIT = states(
    "t = 1",
    SET(("s += c", "if c & 3 == 0:", "    t = 2")),
    SET(("s -= 1", "if c & 7 == 0:", "    t = 3")),
    SET(("s ^= c", "t = 4")),
    SET(("o[i] = s & 255", "if c & 1:", "    t = 5")),
    SET(("s = s >> 1", "t = 1")),
)
CONSTANTS = """        v = 0
        if c == 0:
            v = 31
        elif c == 1:
            v = 7
        elif c == 2:
            v = 19
        elif c == 3:
            v = 100
        elif c == 4:
            v = -5
        elif c == 5:
            v = 77
        s += v"""
ANY_OF = "        if {}:\n            s += 1"
DIGITS = """
def f(a: i16[:], o: u8[:], n: i32) -> i32:
    k = 0
    for i in range(n >> 3):
        v = a[i]
        left = u32(v)
        if v < 0:
            o[k] = 45
            k += 1
            left = u32(-v)
        while left > 0:
            o[k & 255] = left % 10 + 48
            left //= 10
            k += 1
    return k
"""
PLACES = """
def f(a: u16[:], o: u8[:], n: i32) -> i32:
    s = 0
    w = n >> 3
    for i in range(n):
        p = a[i]
        y = p // w
        x = p - y * w
        s += x ^ y
    return s
"""

# Without these rules estimates are off by up to 112 %.
CASES = {
    "four cases": (IN_A_LOOP.format("a[i] & 7", chain(4)), 6635, 0.04),
    "six cases": (IN_A_LOOP.format("a[i] & 7", chain(6)), 5781, 0.04),
    "seven cases of a byte": (IN_A_LOOP.format("a[i]", chain(7)), 6039, 0.02),
    "packets": (IN_A_LOOP.format("a[i]", PACKETS), 4488, 0.03),
    "states that are chosen": (IN_A_LOOP.format("a[i]", CHOOSING_STATES), 4446, 0.17),
    "states in turn": (IN_A_LOOP.format("a[i]", GAIT), 4360, 0.36),
    "constants": (IN_A_LOOP.format("a[i] & 7", CONSTANTS), 7100, 0.07),
    "blanks": (
        IN_A_LOOP.format("a[i]", ANY_OF.format("c == 32 or c == 9 or c == 10 or c == 13")),
        4460,
        0.02,
    ),
    "low numbers": (
        IN_A_LOOP.format("a[i] & 31", ANY_OF.format("c == 2 or c == 7 or c == 12 or c == 17")),
        4529,
        0.09,
    ),
    "neighbours": (IN_A_LOOP.format("a[i]", ANY_OF.format("c == 88 or c == 89 or c == 90")), 3804, 0.01),
    "a bit apart": (IN_A_LOOP.format("a[i]", ANY_OF.format("c == 69 or c == 101")), 4208, 0.01),
    "both sides of 0": (
        IN_A_LOOP.format("(a[i] & 15) - 6", ANY_OF.format("c == -6 or c == 1 or c == 4 or c == 8")),
        4926,
        0.03,
    ),
    "-1 and 1": (IN_A_LOOP.format("(a[i] & 3) - 1", ANY_OF.format("c == -1 or c == 1")), 4319, 0.1),
    "neighbours first": (
        IN_A_LOOP.format("a[i] & 7", chain(7).replace("c == 0", "c == 7 or c == 0")),
        5673,
        0.04,
    ),
    "neighbours to one place first": (
        IN_A_LOOP.format("a[i] & 15", chain(7).replace("c == 0", "c == 8 or c == 9 or c == 0")),
        5803,
        0.17,
    ),
    "none of them": (
        IN_A_LOOP.format("a[i]", ANY_OF.format("c != 32 and c != 9 and c != 10 and c != 13")),
        7692,
        0.18,
    ),
    "digits of a number's size": (DIGITS, 31109, 0.01),
    "places of a picture": (PLACES, 87246, 0.08),
}


test_estimates_are_near_what_gcc_makes, test_they_compute_what_python_does = beside_gcc(
    CASES, counts=(8, 9, 17, 90, 200)
)


def text_of(name: str, folder: Path, *without: Rule) -> str:
    """Return the IR that is costed of a case."""
    kernel = kernel_of(CASES[name][0], folder)
    return optimised(kernel.function, replace(GCC_O2, without=without))


def test_five_tests_that_do_nothing_else_are_a_switch(tmp_path: Path) -> None:
    """The first one of a loop's body is none of them, for it stands behind the load; fewer are branches."""
    assert "switch" not in text_of("four cases", tmp_path)
    assert "i8 5, label" in text_of("six cases", tmp_path)


def test_states_lead_past_the_switch(tmp_path: Path) -> None:
    """Of a machine whose states set the next one, the switch has those alone that do not always."""
    assert "i32 3, label" in text_of("packets", tmp_path, Rule.STATE_MACHINES)
    assert "i32 3, label" not in text_of("packets", tmp_path)


def test_tests_that_only_choose_load_from_a_table(tmp_path: Path) -> None:
    """The table has a constant for each number, and the index is checked before."""
    text = text_of("constants", tmp_path)
    assert "constant [5 x i32] [i32 7, i32 19, i32 100, i32 -5, i32 77]" in text
    assert "switch" in text_of("constants", tmp_path, Rule.CONSTANT_TABLES)


@pytest.mark.parametrize(
    ("name", "tests"),
    [
        ("blanks", ("icmp ult i32", ", 24", "lshr i32 8388627,")),  # 9 to 32: bits 0, 1, 4 and 23
        ("low numbers", ("lshr i32 135296,",)),  # bits 7, 12 and 17 of 0 to 31
        ("neighbours", ("icmp ult i32", ", 3")),
        ("a bit apart", ("and i32", ", -33", "icmp eq i32", ", 69")),
    ],
)
def test_numbers_that_lead_to_one_place_are_tested_together(
    name: str, tests: tuple[str, ...], tmp_path: Path
) -> None:
    """A range, a mask, or a number without a bit."""
    text = text_of(name, tmp_path)
    assert all(each in text for each in tests)
    assert text.count("icmp eq i8") == (name == "low numbers")


def test_names_of_one_function_do_not_reveal_those_of_another() -> None:
    """Each function has names of its own, and what is hidden in one may be revealed as a hidden one."""
    function = "define i32 @{}(i32 %a, i32 %b) {{\n  %h = call i32 @bfsim.hides(i32 {})\n{}  ret i32 {}\n}}\n"
    again = "  %g = call i32 @bfsim.hides(i32 %h)\n"
    text = revealed(function.format("one", "%a", "", "%h") + function.format("other", "%b", again, "%g"))
    assert [row for row in text.splitlines() if "ret" in row] == ["  ret i32 %a", "  ret i32 %b"]


def test_nothing_is_hidden_from_what_is_costed(tmp_path: Path) -> None:
    """The calls that hide numbers from LLVM are gone in the end."""
    assert all("hides" not in text_of(name, tmp_path) for name in CASES)


@pytest.mark.parametrize("seed", [*range(12), *exhaustive(*range(12, 120))])
def test_kernels_that_decide_by_chance_compute_what_python_does(seed: int, tmp_path: Path) -> None:
    """Of such kernels one in 300 was compiled wrongly, or not at all, while these rules were made. Lines that are never reached are refused."""
    text = Decisions(Random(seed)).kernel()
    try:
        check_meaning(text, GCC_O2, tmp_path, (8, 60, 200))
    except KernelError as error:
        assert "this line is never reached" in str(error)
