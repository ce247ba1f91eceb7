"""A loop that fills an array, or moves what is in it, is a call of memset or memmove, which takes as long as there is to do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bfsim.kernel import GCC_O2
from tests.kernel.beside_gcc import Case, beside_gcc
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


OF_THE_LIBRARY: dict[str, Case] = {
    "a picture at once": (
        """def f(a: u8[:], n: i32) -> None:
    for y in range(12):
        for x in range(16):
            a[y * 16 + x] = 0""",
        176,
        0.13,
    ),
    "a delay line": (
        """def f(a: i16[:], b: i16[:], c: i16[:], n: i32) -> None:
    for i in range(n):
        for k in range(7, 0, -1):
            c[k] = c[k - 1]
        c[0] = a[i]
        s = 0
        for k in range(8):
            s += c[k] * (k + 1)
        b[i] = s >> 5""",
        33049,
        0.02,
    ),
    "insertion into a list": (
        """def f(a: i16[:], n: i32, t: i32) -> None:
    for i in range(n, t, -1):
        a[i] = a[i - 1]
    a[t] = 5""",
        525,
        0.02,
    ),
    "removal from a list": (
        """def f(a: i16[:], n: i32, t: i32) -> i32:
    for i in range(t, n - 1):
        a[i] = a[i + 1]
    return n - 1""",
        522,
        0.07,
    ),
    "removals": (
        """def f(a: i16[:], b: u8[:], n: i32) -> i32:
    m = n
    i = 0
    while i < m:
        if a[i] < 0:
            for j in range(i, m - 1):
                a[j] = a[j + 1]
            m -= 1
        else:
            i += 1
    return m""",
        51067,
        0.01,
    ),
    "two lists": (
        """def f(a: i16[:], b: i16[:], n: i32) -> None:
    for i in range(n - 1):
        a[i] = a[i + 1]
        b[i] = b[i + 1]""",
        1807,
        0.02,
    ),
    "words upwards": (
        """def f(a: i32[:], n: i32) -> None:
    for i in range(n - 1, 0, -1):
        a[i] = a[i - 1]""",
        1674,
        0.01,
    ),
    "words downwards": (
        """def f(a: i32[:], n: i32) -> None:
    for i in range(n - 1):
        a[i] = a[i + 1]""",
        649,
        0.04,
    ),
    "so far that nothing is stored before": (
        """def f(a: u8[:], n: i32) -> None:
    for i in range(100):
        a[i + 120] = a[i]""",
        189,
        0.04,
    ),
    "what was stored is loaded": (
        """def f(a: u8[:], n: i32) -> None:
    for i in range(1, n):
        a[i] = a[i - 1]""",
        213,
        0.02,
    ),
    "an unknown distance": (
        """def f(a: u8[:], n: i32, t: i32) -> None:
    for i in range(n - t):
        a[i] = a[i + t]""",
        213,
        0.01,
    ),
    "rows": (
        """def f(a: u8[:], n: i32) -> None:
    for y in range(8):
        for x in range(16):
            a[128 + y * 16 + x] = a[y * 16 + x]""",
        1261,
        0.01,
    ),
    "rows of an unknown width": (
        """def f(a: u8[:], n: i32) -> None:
    w = n >> 4
    for y in range(10):
        for x in range(w):
            a[y * w + x] = 7""",
        1305,
        0.02,
    ),
    "two fills": (
        """def f(a: u8[:], b: i16[:], n: i32) -> None:
    for i in range(n):
        a[i] = 0
        b[i] = -1""",
        464,
        0.04,
    ),
    "a border": (
        """def f(a: u8[:], n: i32) -> None:
    for x in range(16):
        a[x] = 0
        a[15 * 16 + x] = 0
    for y in range(16):
        a[y * 16] = 0
        a[y * 16 + 15] = 0""",
        331,
        0.02,
    ),
    "fourteen zeros": (
        """def f(a: u8[:], n: i32, t: i32) -> None:
    for y in range(n >> 5):
        for x in range(14):
            a[y + x] = 0""",
        114,
        0.15,
    ),
    "fifteen zeros": (
        """def f(a: u8[:], n: i32, t: i32) -> None:
    for y in range(n >> 5):
        for x in range(15):
            a[y + x] = 0""",
        835,
        0.09,
    ),
    "four bytes": (
        """def f(a: u8[:], n: i32, t: i32) -> None:
    for y in range(n >> 5):
        for x in range(4):
            a[y + x] = t""",
        54,
        0.23,
    ),
    "eight bytes": (
        """def f(a: u8[:], n: i32, t: i32) -> None:
    for y in range(n >> 5):
        for x in range(8):
            a[y + x] = t""",
        824,
        0.07,
    ),
    "ten bytes of zeros": (
        """def f(a: i16[:], n: i32, t: i32) -> None:
    for y in range(n >> 5):
        for x in range(5):
            a[y + x] = 0""",
        94,
        0.2,
    ),
}

test_what_moves_or_fills_costs_what_gcc_makes_of_it, test_what_moves_or_fills_computes_the_same = beside_gcc(
    OF_THE_LIBRARY
)
