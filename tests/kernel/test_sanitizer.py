"""`--sanitize`: every index is checked, the arrays stay as they are, and the cycles do not change."""

from __future__ import annotations

import re

import numpy as np
import pytest

from bfsim.errors import KernelError
from bfsim.kernel import Kernel, i32, kernel, u8, u32
from tests.kernel import cost_kernels
from tests.kernel.running import cclk


@kernel
def load(row: u8[:], i: i32) -> i32:
    return row[i]


@kernel
def load_far(row: u8[:], i: u32) -> i32:
    return row[i]


@kernel
def store(row: u8[:], other: u32[:], i: i32):
    row[0] = 9
    other[i] = 1
    row[1] = 9


@kernel
def call(row: u8[:], other: u32[:], n: i32):
    for i in range(n):
        row[i] = 7
        store(row, other, i)


@kernel
def smooth(source: u8[:], target: u8[:]):
    for i in range(1, len(source)):
        target[i] = source[source[i] & 7]


def row_of(n: int = 8) -> np.ndarray[tuple[int], np.dtype[np.uint8]]:
    """Return the bytes 0, 1, 2 ..."""
    return np.arange(n, dtype=np.uint8)


def place(checked: Kernel, text: str) -> str:
    """Return file:line of the line of `checked` that has `text`, as a pattern."""
    lines = checked.function.source.splitlines()
    number = next(i for i, line in enumerate(lines) if text in line)
    return re.escape(f"{__file__}:{checked.function.first_line + number}: ")


@pytest.mark.parametrize("index", [-1, 8, 9, 2**31 - 1, -(2**31)])
def test_an_index_outside_of_its_array_is_an_error(index: int) -> None:
    """A load below 0 or at the length of its array is refused with file, line, array, kernel and index."""
    what = f"index {index} is outside of row in kernel load; an index must be 0 or more and less than len"
    with pytest.raises(KernelError, match=place(load, "return row") + what + r"\(row\)\n    return row\[i\]"):
        load.sanitize((row_of(), index))


@pytest.mark.parametrize("index", [0, 7])
def test_an_index_inside_of_its_array_is_none(index: int) -> None:
    """The first and the last element can be loaded."""
    load.sanitize((row_of(), index))


def test_an_unsigned_index_is_shown_unsigned() -> None:
    """A u32 beyond 2**31 is named as the kernel has it, not as a negative number."""
    with pytest.raises(KernelError, match="index 4294967290 is outside of row"):
        load_far.sanitize((row_of(), 4294967290))


def test_a_store_outside_of_its_array_is_an_error() -> None:
    """A store is checked as a load is, and its own array is named."""
    with pytest.raises(
        KernelError, match=place(store, "other[i]") + "index 2 is outside of other in kernel store"
    ):
        store.sanitize((row_of(), np.zeros(2, np.uint32), 2))


def test_an_error_in_a_callee_names_the_callee() -> None:
    """The message points into the kernel whose line it is, and nothing runs after it."""
    with pytest.raises(
        KernelError, match=place(store, "other[i]") + "index 3 is outside of other in kernel store"
    ):
        call.sanitize((row_of(), np.zeros(3, np.uint32), 8))


def test_the_next_run_is_checked_anew() -> None:
    """A kernel that was caught once can be right the next time."""
    with pytest.raises(KernelError):
        load.sanitize((row_of(), 8))
    load.sanitize((row_of(), 3))


@pytest.mark.parametrize("n", [2, 8])
def test_a_checked_run_leaves_the_arrays_untouched(n: int) -> None:
    """Whether it is caught or not, a checked run writes nothing that stays."""
    row, other = row_of(), np.zeros(5, np.uint32)
    try:
        call.sanitize((row, other, n))
    except KernelError:
        assert n == 8
    np.testing.assert_array_equal(row, row_of())
    assert not other.any()


def test_arrays_that_overlap_are_checked_as_they_are() -> None:
    """A kernel that is given one row twice is checked on that one row: what it stores, it loads."""
    row = np.full(9, 200, np.uint8)
    smooth.sanitize((row[:-1], row[1:]))
    np.testing.assert_array_equal(row, np.full(9, 200, np.uint8))


def test_a_read_only_row_can_be_checked() -> None:
    """A row that must not be written can be the source of a checked run."""
    source = row_of()
    source.flags.writeable = False
    smooth.sanitize((source, row_of()))


def test_checking_changes_no_cycles() -> None:
    """A kernel costs the same before, after and without a checked run."""
    words = np.zeros(20, np.uint32)
    before = cclk(cost_kernels.copy_words, words, words.copy())
    cost_kernels.copy_words.sanitize((words, words.copy()))
    assert cclk(cost_kernels.copy_words, words, words.copy()) == before
