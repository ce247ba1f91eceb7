"""Truth values, constants and calls as newcomers write them mean what Python means: in native code, in C and in estimates."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from bfsim.kernel import GCC_O0, GCC_O2, Kernel
from bfsim.kernel.c import CProgram
from tests.kernel.host_c import call, compiled, copies, exported, needs_compiler
from tests.kernel.modules import import_text

TEXT = """
from enum import IntEnum

class Mode(IntEnum):
    OFF, RUN = 0, 3

DEBUG, QUIET = True, False
START = Mode.RUN

@kernel
def digit(row: u8[:], at: i32) -> i32:
    return row[at & 7] - ord("0") + ord(b"$")

@kernel
def joined(row: u8[:], x: i32, y: i32) -> i32:
    found = 0
    if x and y > 0:
        found += 1
    if not x or y or row[0] > 9:
        found += 2
    while row[1] and found < 9:
        row[1] -= 1
        found += 3
    return found + (16 if (x and y) or not (row[2] or x) else 32)

@kernel
def compared(row: u8[:], x: i32, y: i32) -> i32:
    signs = (x < 0) != (y < 0)
    found = 1 if signs else 2
    if (x < row[3]) == (y > x):
        found += 4
    if signs == (row[4] > y) and signs != True:
        found += 8
    if (x < 3) == (y < 3) == signs:
        found += 16
    return found

@kernel
def crossings(row: u8[:], x: i32, y: i32) -> i32:
    found = 0
    above = False
    for i in range(len(row)):
        now = row[i] > (y & 255)
        if now != above:
            found += 1
        above = now
    return found

@kernel
def named(row: u8[:], x: i32, y: i32) -> i32:
    if DEBUG and x:
        row[0] = Mode.RUN
    if QUIET or x == START or y == Mode.OFF:
        return digit(row, y)
    return row[0] + START

@kernel
def bounded(row: u8[:], x: i32, y: i32) -> i32:
    return min(x, y, row[0]) ^ max(row[1], x, y, 40, 50) + max(1, 2, 3)

@kernel
def chosen(row: u8[:], x: i32, y: i32) -> i32:
    bits: u32 = 1 if x < 0 else 0
    for i in range(len(row)):
        bits = (bits << 1) | (1 if row[i] < 40 else 0)
        bits += 0 if y < 0 else (3 if x > y else 2)
    return i32(bits)
"""
NAMES = ("joined", "compared", "crossings", "named", "bounded", "chosen")


@pytest.fixture(scope="module")
def kernels(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """The kernels of TEXT."""
    return import_text(TEXT, tmp_path_factory.mktemp("truth"), "truth")


@pytest.fixture(scope="module")
def library(kernels: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> tuple[CProgram, ctypes.CDLL]:
    """The same in C, compiled with every warning an error."""
    folder = tmp_path_factory.mktemp("c")
    program = exported([getattr(kernels, name) for name in NAMES], folder)
    return program, compiled(program, folder)


def chance() -> list[tuple[Any, ...]]:
    """Arguments at random, small ones and zeros more often than others."""
    random = np.random.default_rng(7)
    rows = [random.integers(0, 256, 8, np.uint8) * random.integers(0, 2, 8, np.uint8) for _ in range(200)]
    return [(row, *random.integers(-4, 5, 2).tolist()) for row in rows]


def in_lists(arguments: Sequence[Any]) -> list[Any]:
    """Return arguments as plain Python takes them."""
    return [each.tolist() if isinstance(each, np.ndarray) else each for each in arguments]


@pytest.mark.parametrize("name", NAMES)
def test_native_code_computes_what_plain_python_computes(name: str, kernels: ModuleType) -> None:
    """Results and arrays are the same, and both ways of each test are met."""
    kernel: Kernel = getattr(kernels, name)
    results = set()
    for arguments in chance():
        here, there = copies(arguments), in_lists(arguments)
        result = kernel(*here)
        assert result == kernel.python(*there)
        assert here[0].tolist() == there[0]
        results.add(result)
    assert len(results) > 3


@needs_compiler
@pytest.mark.parametrize("name", NAMES)
def test_c_computes_what_plain_python_computes(
    name: str, kernels: ModuleType, library: tuple[CProgram, ctypes.CDLL]
) -> None:
    """Results and arrays are the same."""
    kernel: Kernel = getattr(kernels, name)
    for arguments in chance():
        here, there = copies(arguments), in_lists(arguments)
        assert call(library[1], library[0], kernel, *here) == kernel.python(*there)
        assert here[0].tolist() == there[0]


@pytest.mark.parametrize("name", NAMES)
def test_estimates_exist_and_optimising_helps(name: str, kernels: ModuleType) -> None:
    """Each kernel takes some cycles, and more of them unoptimised."""
    kernel: Kernel = getattr(kernels, name)
    optimised, plain = (
        sum(kernel.cost(*copies(each), profile=profile.name) for each in chance()[:20])
        for profile in (GCC_O2, GCC_O0)
    )
    assert 20 * 5 < optimised < plain < 10 * optimised


def test_c_names_what_the_module_names(library: tuple[CProgram, ctypes.CDLL]) -> None:
    """Truth values and members under a name of the module keep it; a choice of many is one of two at a time."""
    text = library[0].files["truth.c"]
    assert "#define DEBUG 1\n#define QUIET 0\n#define START 3\n" in text
    assert "if (DEBUG != 0 && x != 0) {" in text
    assert "bool signs = (x < 0) != (y < 0);" in text
    assert "return min(min(x, y), row[0])" in text


PAIRS = {
    "a and b > 0": "a != 0 and b > 0",
    "a or not b": "a != 0 or b == 0",
    "(a < 0) != (b < 0)": "(a ^ b) < 0",
    "min(a, b, 9) > 2": "min(min(a, b), 9) > 2",
    "a == Mode.RUN": "a == 3",
    "a == ord('a')": "a == 97",
}


@pytest.mark.parametrize("profile", [GCC_O2, GCC_O0], ids=lambda each: each.name)
@pytest.mark.parametrize("short", PAIRS)
def test_what_means_the_same_costs_the_same(short: str, profile: Any, tmp_path: Path) -> None:
    """Each new way to write a test is estimated as what GCC makes of it."""
    head = "from enum import IntEnum\nclass Mode(IntEnum):\n    RUN = 3\n"
    texts = [
        f"{head}@kernel\ndef f(a: i32, b: i32) -> i32:\n    if {test}:\n        return 7\n    return 9\n"
        for test in (short, PAIRS[short])
    ]
    one, other = (import_text(each, tmp_path).f for each in texts)
    for a, b in ((0, 3), (3, 0), (-3, 9), (97, -1)):
        assert one(a, b) == other(a, b)
        assert one.cost(a, b, profile=profile.name) == other.cost(a, b, profile=profile.name)


def test_helpers_of_plain_python_are_plain_python(kernels: ModuleType) -> None:
    """Arrays that are lists are passed on, numbers do not wrap, and afterwards a kernel is what it was."""
    assert kernels.named.python([1, 2, 3], 0, 0) == 1 - 48 + 36
    with pytest.raises(IndexError):
        kernels.named.python([], 0, 0)
    with pytest.raises(ValueError, match=r"row must be an array u8\[:\], not list"):
        kernels.digit([1, 2, 3], 0)
    assert kernels.digit(np.array([50, 0, 0, 0, 0, 0, 0, 0], np.uint8), 0) == 38
