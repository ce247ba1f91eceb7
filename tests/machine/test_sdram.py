"""SDRAM pages: three classes of access, and which one it is depends on the page that the bank has open."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.sdram_parts import MT48LC8M32B2
from bfsim.machine.sdram import Sdram
from tests.machine.rig import Bench

PIECES = st.tuples(st.integers(0, 3), st.integers(0, 4), st.integers(1, 6))


def test_first_access_misses_then_hits_then_conflicts() -> None:
    """A bank starts closed; the same page again is a hit, and another page must close it first."""
    sdram = Sdram(MT48LC8M32B2)
    assert sdram.open(((0, 7, 10),)) == (1, 0)
    assert sdram.open(((0, 7, 10),)) == (0, 0)
    assert sdram.open(((0, 8, 10),)) == (0, 1)


def test_banks_keep_their_pages_apart() -> None:
    """What happens in one bank leaves the open pages of the others alone."""
    sdram = Sdram(MT48LC8M32B2)
    for bank in range(4):
        assert sdram.open(((bank, bank, 1),)) == (1, 0)
    for bank in range(4):
        assert sdram.open(((bank, bank, 1),)) == (0, 0)


@given(st.lists(st.lists(PIECES, min_size=1, max_size=3), max_size=20))
def test_bursts_classify_like_single_words(bursts: list[list[tuple[int, int, int]]]) -> None:
    """A naive model that looks at one word after the other finds the same misses and conflicts."""
    sdram, open_pages = Sdram(MT48LC8M32B2), dict[int, int]()
    for burst in bursts:
        misses = conflicts = 0
        for bank, page, words in burst:
            for _ in range(words):
                before = open_pages.get(bank)
                misses += before is None
                conflicts += before is not None and before != page
                open_pages[bank] = page
        assert sdram.open(tuple(burst)) == (misses, conflicts)


@given(st.integers(0, 32 * 2**20 - 8192), st.integers(1, 8192))
def test_rows_are_split_at_page_borders(address: int, nbytes: int) -> None:
    """The pieces of a row, walked byte by byte, are the pages that its bytes lie in."""
    pages = Bench().row(address, nbytes).pages
    expected = sorted(
        {offset // 2048 for offset in (address, *range(address, address + nbytes, 512), address + nbytes - 1)}
    )
    assert [page for _, page, _ in pages] == expected
    assert [bank for bank, _, _ in pages] == [page * 2048 // (8 * 2**20) for page in expected]
    assert 4 * sum(words for _, _, words in pages) >= nbytes
