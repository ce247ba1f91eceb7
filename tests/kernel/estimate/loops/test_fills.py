"""A loop that fills an array is a call of memset, which takes as long as there is to fill."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bfsim.kernel import GCC_O2
from tests.kernel.modules import import_text
from tests.kernel.running import run

CLEAR = """
@kernel
def clear(row: u8[:]):
    for i in range(len(row)):
        row[i] = 0
"""
ONES = """
@kernel
def ones(row: i32[:], n: i32):
    for i in range(n):
        row[i] = -1
"""


@pytest.mark.parametrize(
    ("nbytes", "measured"), [(1, 70), (3, 70), (4, 113), (16, 123), (31, 121), (256, 198), (2000, 743)]
)
def test_filling_bytes_costs_what_gcc_costs(nbytes: int, measured: int, tmp_path: Path) -> None:
    """GCC 12.2 with newlib's memset under the GNU simulator, from a call to its return: within three cycles."""
    clear = import_text(CLEAR, tmp_path).clear
    row = np.ones(nbytes, np.uint8)
    assert run(clear, row, profile=GCC_O2).issue_cclk == pytest.approx(measured, abs=3)
    assert not row.any()


@pytest.mark.parametrize(("words", "measured"), [(1, 117), (4, 127), (64, 202), (500, 747)])
def test_filling_words_costs_by_their_bytes(words: int, measured: int, tmp_path: Path) -> None:
    """Four bytes each; the shift of the count and a move are missing."""
    ones = import_text(ONES, tmp_path).ones
    row = np.zeros(512, np.int32)
    assert run(ones, row, words, profile=GCC_O2).issue_cclk == pytest.approx(measured, abs=6)
    assert (row == -1).sum() == words


def test_nothing_to_fill_is_no_call(tmp_path: Path) -> None:
    """A test, and the return."""
    assert run(import_text(ONES, tmp_path).ones, np.zeros(4, np.int32), 0, profile=GCC_O2).issue_cclk < 25


def test_every_call_counts_by_itself(tmp_path: Path) -> None:
    """Two fills of eight bytes are no fill of sixteen."""
    text = (
        ONES
        + "\n@kernel\ndef twice(row: i32[:], n: i32):\n    for k in range(2):\n        for i in range(n):\n            row[i] = -1\n"
    )
    twice = import_text(text, tmp_path).twice
    row = np.zeros(512, np.int32)
    short, longer = (run(twice, row, n, profile=GCC_O2).issue_cclk for n in (2, 3))
    assert short == longer
    assert run(twice, row, 4, profile=GCC_O2).issue_cclk == short + 2 * 5


FILLED_AND_SEARCHED = """
@kernel
def first_change(row: u8[:], seen: i16[:], n: i32) -> i32:
    for i in range(n):
        seen[i] = -1
    at = 0
    for i in range(n):
        if i > 0:
            at += row[i] - row[i - 1]
        seen[row[i] & 7] = at
    return at
"""


def test_what_is_tested_in_a_first_iteration_alone_leaves_a_fill_as_it_is(tmp_path: Path) -> None:
    """What cleans up behind jump threading left out what counts the fill, which ended the estimate."""
    kernel = import_text(FILLED_AND_SEARCHED, tmp_path).first_change
    row, seen = np.arange(64, dtype=np.uint8), np.zeros(64, np.int16)
    assert run(kernel, row, seen, 64, profile=GCC_O2).value == 63
