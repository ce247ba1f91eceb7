"""`--sanitize`: a kernel is checked as it is written, the arrays stay as they are, and the cycles do not change."""

from __future__ import annotations

import numpy as np
import pytest

from bfsim.errors import KernelError
from bfsim.kernel import i32, kernel, u8, u32
from tests.kernel import cost_kernels
from tests.kernel.running import cclk


@kernel
def load(row: u8[:], i: i32) -> i32:
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


@kernel
def look(row: u8[:], i: i32) -> i32:
    seen = row[i]  # noqa: F841  # the compiler sees that, too
    half = 100 // i  # noqa: F841
    return i


@pytest.mark.parametrize(("index", "words"), [(8, "index 8 is outside of row"), (0, "100 // 0 is undefined")])
def test_what_the_compiler_leaves_out_is_checked_as_well(index: int, words: str) -> None:
    """A load and a quotient that nobody uses are no part of the compiled kernel, but a mistake in its source."""
    assert look(row_of(), index) == index
    with pytest.raises(KernelError, match=words):
        look.sanitize((row_of(), index))


@kernel
def shift(a: i32, n: i32, row: u8[:]) -> i32:
    masked = a >> (n & 31)
    up = a << n
    row[(u32(a) >> u32(31 - n)) & 7] = 1
    return masked + up


@pytest.mark.parametrize(("count", "line", "told"), [(-1, 4, -1), (40, 4, 40), (32, 4, 32)])
def test_a_shift_beyond_the_bits_is_told(count: int, line: int, told: int) -> None:
    """The compiled kernel takes its lower five bits: a negative one went unnoticed. `31 - n` is 0 to 31 for those that are right."""
    shift(1, count, row_of())
    place = f"{__file__}:{shift.function.first_line + line - 1}: "
    with pytest.raises(
        KernelError, match=rf"^{place}a shift is by {told} in kernel shift; a shift must be by 0 to 31\n"
    ):
        shift.sanitize((1, count, row_of()))
    for right in (0, 1, 31):
        shift.sanitize((1, right, row_of()))


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


def test_a_kernel_that_is_bound_once_is_checked_again_and_again() -> None:
    """On what its arrays have by then, with other numbers, and after a mistake; each time they stay as they are."""
    row, other = row_of(), np.zeros(5, np.uint32)
    check = call.sanitizer((row, other))
    for n in (2, 8, 0, 3, 6):
        row += 1
        other += 1
        before = row.tolist(), other.tolist()
        if n > len(other):
            with pytest.raises(KernelError, match="index 5 is outside of other"):
                check((row, other, n))
        else:
            check((row, other, n))
        assert (row.tolist(), other.tolist()) == before


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


@kernel
def doubled(a: i32, n: i32) -> i32:
    return a << n


def test_an_estimated_shift_takes_the_lower_five_bits_of_its_amount() -> None:
    """As the page of the kernel language says: without `--sanitize` nothing checks it."""
    assert [doubled(3, n) for n in (1, 33, -31, 32)] == [6, 6, 6, 3]
