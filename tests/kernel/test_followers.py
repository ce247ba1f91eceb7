"""The memory follower: every access of a kernel outside L1 is classified as the memories would."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.kernel import i32, kernel, u8
from bfsim.kernel.followers import Access, Follower
from tests.kernel.running import run

PAGE_BITS, BANK_BITS = 6, 9
PAGE_BYTES = 1 << PAGE_BITS
L2 = np.zeros(256, np.uint8)
SDRAM = np.zeros(4 << BANK_BITS, np.uint8)


@kernel
def stroll(source: u8[:], target: u8[:], start: i32, step: i32, n: i32) -> i32:
    total = 0
    for i in range(n):
        here = source[start + i * step]
        total += here
        target[i * step] = here
    return total


def follower() -> Follower:
    """Return the follower of the two memories, with every bank closed."""
    return Follower(L2, SDRAM, PAGE_BITS, BANK_BITS)


def counts_of(accesses: list[int] | None) -> dict[Access, int]:
    """Return the classes that occurred."""
    assert accesses is not None
    return {kind: count for kind, count in zip(Access, accesses, strict=True) if count}


class Pages:
    """The rule in plain Python: a bank has one page open; another one conflicts, a closed bank misses."""

    def __init__(self) -> None:
        self.open: dict[int, int] = {}

    def access(self, offset: int, *, write: bool) -> Access:
        """Return the class of one access and open its page."""
        bank, page = offset >> BANK_BITS, offset >> PAGE_BITS
        last = self.open.get(bank)
        self.open[bank] = page
        kind = "HIT" if last == page else "MISS" if last is None else "CONFLICT"
        return Access[f"PAGE_{kind}_{'WRITE' if write else 'READ'}"]


def test_accesses_to_l2_are_counted() -> None:
    """Loads and stores in L2 are told apart; L1 is not followed."""
    l1 = np.zeros(64, np.uint8)
    work = run(stroll, L2, l1, 0, 1, 40, follower=follower())
    assert counts_of(work.accesses) == {Access.L2_READ: 40}
    work = run(stroll, l1, L2, 0, 1, 40, follower=follower())
    assert counts_of(work.accesses) == {Access.L2_WRITE: 40}


def test_a_row_in_one_page_misses_once() -> None:
    """The first access opens the page, every other one hits it."""
    work = run(stroll, SDRAM, L2, 0, 1, PAGE_BYTES, follower=follower())
    expected = {Access.PAGE_MISS_READ: 1, Access.PAGE_HIT_READ: PAGE_BYTES - 1, Access.L2_WRITE: PAGE_BYTES}
    assert counts_of(work.accesses) == expected


def test_two_rows_in_one_bank_conflict_every_time() -> None:
    """A load from one page and a store to another one of the same bank close each other's page."""
    target = SDRAM[2 * PAGE_BYTES : 3 * PAGE_BYTES]
    work = run(stroll, SDRAM, target, 0, 1, 10, follower=follower())
    assert counts_of(work.accesses) == {
        Access.PAGE_MISS_READ: 1,
        Access.PAGE_CONFLICT_READ: 9,
        Access.PAGE_CONFLICT_WRITE: 10,
    }


def test_two_rows_in_two_banks_do_not_disturb_each_other() -> None:
    """Every bank keeps a page of its own open."""
    work = run(stroll, SDRAM, SDRAM[1 << BANK_BITS :], 0, 1, 10, follower=follower())
    assert counts_of(work.accesses) == {
        Access.PAGE_MISS_READ: 1,
        Access.PAGE_HIT_READ: 9,
        Access.PAGE_MISS_WRITE: 1,
        Access.PAGE_HIT_WRITE: 9,
    }


def test_pages_stay_open_between_calls_and_counts_do_not() -> None:
    """What a call has opened, the next one finds; the counts of a call are its own."""
    one = follower()
    run(stroll, SDRAM, L2, 0, 1, 3, follower=one)
    assert one.open_pages[:4].tolist() == [0, -1, -1, -1]
    work = run(stroll, SDRAM, L2, 3, 1, 2, follower=one)
    assert counts_of(work.accesses) == {Access.PAGE_HIT_READ: 2, Access.L2_WRITE: 2}


def test_following_changes_neither_pixels_nor_cycles() -> None:
    """The followed build stores the same values, returns the same and issues the same cycles."""
    source = np.arange(64, dtype=np.uint8)
    plain, seen = np.zeros(64, np.uint8), np.zeros(64, np.uint8)
    bare = run(stroll, source, plain, 0, 1, 64)
    followed = run(stroll, source, seen, 0, 1, 64, follower=follower())
    assert (bare.issue_cclk, bare.value) == (followed.issue_cclk, followed.value)
    assert bare.accesses is None
    np.testing.assert_array_equal(plain, seen)


@settings(max_examples=60, deadline=None)
@given(start=st.integers(0, 600), step=st.integers(0, 90), n=st.integers(0, 15), bank=st.integers(0, 3))
def test_any_stride_meets_the_pages_that_the_rule_says(start: int, step: int, n: int, bank: int) -> None:
    """Hits, misses and conflicts of a strided walk are those of the rule in plain Python, access by access."""
    target_at = min(bank << BANK_BITS, len(SDRAM) - 15 * 90)
    pages, expected = Pages(), dict.fromkeys(Access, 0)
    for i in range(n):
        expected[pages.access(start + i * step, write=False)] += 1
        expected[pages.access(target_at + i * step, write=True)] += 1
    work = run(stroll, SDRAM, SDRAM[target_at:], start, step, n, follower=follower())
    assert work.accesses == list(expected.values())
