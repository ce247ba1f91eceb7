"""The bus to SDRAM: how long a burst takes, closed forms against the model, and when the next one may begin."""

from __future__ import annotations

from math import ceil

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.boards import BOARDS
from bfsim.machine.ebiu import BurstRate
from bfsim.machine.memories import Row
from tests.machine.rig import Bench

PAGE = 2048
BANK = 8 * 2**20
each_board = pytest.mark.parametrize("board", BOARDS)


def read(bench: Bench, row: Row, now: int = 0) -> int:
    """Read `row` at the rate of an MDMA; return the tick at which it is done."""
    rate = BurstRate(bench.spec.chip.mdma_read_sclk, bench.spec.sdram.nCL)
    return bench.ebiu.burst(bench.account, now, row, rate, write=False)


def write(bench: Bench, row: Row, now: int = 0) -> int:
    """Write `row` at the rate of an MDMA; return the tick at which it is done."""
    return bench.ebiu.burst(bench.account, now, row, BurstRate(bench.spec.chip.mdma_write_sclk), write=True)


def words_sclk(bench: Bench, words: int, *, is_write: bool = False) -> int:
    """Cycles of the words alone, from the chip's data."""
    chip = bench.spec.chip
    return ceil(words * (chip.mdma_write_sclk if is_write else chip.mdma_read_sclk))


@each_board
def test_a_read_takes_its_words_the_page_and_the_latency(board: str) -> None:
    """160 words on a closed, on the open and on another page: only the page's opening differs."""
    bench = Bench(board)
    sdram = bench.spec.sdram
    here, other = bench.row(0, 640), bench.row(PAGE, 640)
    duration = words_sclk(bench, 160) + sdram.nCL
    now = 0
    for row, opening_sclk in ((here, sdram.nRCD), (here, 0), (other, sdram.nRP + sdram.nRCD)):
        done = read(bench, row, now)
        assert done - now == bench.sclk(duration + opening_sclk)
        now = done


def test_a_write_has_no_latency() -> None:
    """The master gives its data and goes; 160 words to a closed bank are 162 cycles."""
    bench = Bench()
    assert write(bench, bench.row(0, 640)) == bench.sclk(160 + bench.spec.sdram.nRCD)


def test_a_row_across_a_page_border_opens_two_pages() -> None:
    """The bank is closed first and has the first page open then: one miss, one conflict."""
    bench = Bench()
    sdram = bench.spec.sdram
    done = write(bench, bench.row(PAGE - 320, 640))
    assert done == bench.sclk(160 + sdram.miss_sclk + sdram.conflict_sclk)
    assert (bench.account.page_hits, bench.account.page_misses, bench.account.page_conflicts) == (158, 1, 1)


def test_two_rows_of_one_bank_fight_for_its_page() -> None:
    """Read and written in turn, rows of one bank conflict every time; in two banks they hit after the first."""
    for other_address, extra_sclk in ((PAGE, Bench().spec.sdram.conflict_sclk), (BANK, 0)):
        bench = Bench()
        source, target = bench.row(0, 640), bench.row(other_address, 640)
        read(bench, source)
        start = write(bench, target)
        middle = read(bench, source, start)
        end = write(bench, target, middle)
        assert middle - start == bench.sclk(words_sclk(bench, 160) + bench.spec.sdram.nCL + extra_sclk)
        assert end - middle == bench.sclk(160 + extra_sclk)


@each_board
def test_a_burst_waits_until_the_bus_is_free_and_no_longer(board: str) -> None:
    """Asked for before, at and after the tick at which the bus gets free: the gate is tight on both sides."""
    for late_ticks in (-1000, -1, 0):
        bench = Bench(board)
        row = bench.row(0, 640)
        free_at = write(bench, row)
        assert write(bench, row, free_at + late_ticks) == free_at + bench.sclk(160)
    bench = Bench(board)
    free_at = write(bench, bench.row(0, 640))
    assert write(bench, bench.row(0, 640), free_at + 1) == free_at + bench.sclk(1 + 160)


@each_board
@given(now=st.integers(0, 10_000))
def test_bursts_begin_at_sclk_edges(board: str, now: int) -> None:
    """The bus is clocked by SCLK: a request between two edges waits for the next one, less than a cycle."""
    bench = Bench(board)
    start = bench.ebiu.hold(now, 1)
    assert start % bench.spec.clocks.sclk_ticks == 0
    assert now <= start < now + bench.spec.clocks.sclk_ticks


@given(st.lists(st.tuples(st.integers(0, 300), st.integers(1, 50)), max_size=30))
def test_bursts_never_overlap_and_leave_no_gap_while_someone_waits(requests: list[tuple[int, int]]) -> None:
    """Asked in the order of time, each begins at its time or when the one before is over, whichever is later."""
    bench = Bench()
    now = free_at = 0
    for wait_sclk, sclk in requests:
        now += bench.sclk(wait_sclk)
        start = bench.ebiu.hold(now, sclk)
        assert start == max(now, free_at)
        free_at = start + bench.sclk(sclk)


def test_busy_time_is_the_time_of_the_bursts() -> None:
    """The account has every byte, and the ticks that the bus was held, without the waiting for it."""
    bench = Bench()
    row = bench.row(0, 640)
    first_done = read(bench, row)
    second_done = write(bench, row)
    assert second_done == bench.account.busy_ticks > first_done
    assert (bench.account.read_bytes, bench.account.written_bytes) == (640, 640)
