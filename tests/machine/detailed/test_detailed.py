"""The detailed mode: closed forms, and the rules of arbitration one by one."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import ceil
from typing import Any

import pytest

from bfsim.chip.boards import board_named
from bfsim.kernel.calls import access_log as log
from bfsim.machine.bus import state as w
from bfsim.machine.detailed.arbiter import Grant, Request
from bfsim.machine.detailed.sdram import Page, SdramBanks
from bfsim.machine.detailed.sdram_arbiter import MdmaTurns, SdramArbiter
from tests.machine.detailed.bus_rig import WORD, Bench, each_board, with_l2

# ---- the SDRAM: each gate from both sides


@pytest.mark.parametrize(
    ("before", "asked_sclk", "write", "page", "command_sclk"),
    [
        ([], 100, False, Page.MISS, 100 + 2),  # tRCD
        ([(0, 0, False)], 100, False, Page.HIT, 100),
        ([(0, 2048, False)], 8, False, Page.CONFLICT, 8 + 2 + 2),  # tRP + tRCD; tRAS is over
        ([(0, 2048, False)], 6, False, Page.CONFLICT, 7 + 2 + 2),  # activated at 0, tRAS 7
        ([(0, 2048, True)], 4, False, Page.CONFLICT, 7 + 2 + 2),  # tRAS holds longer than tWR
        ([(0, 2048, True), (6, 2048, True)], 7, False, Page.CONFLICT, 7 + 2 + 2 + 2),  # written at 7, tWR 2
        ([(0, 0, False)], 3, False, Page.HIT, 3),  # reads follow each other
        ([(0, 0, False)], 3, True, Page.HIT, 2 + 4 + 1),  # the data are through at 6, turn-round 1
        ([(0, 0, False)], 7, True, Page.HIT, 7),
        ([(0, 0, True)], 3, False, Page.HIT, 3),  # behind a write at 2
        ([(0, 0, False)], 100, False, Page.HIT, 100),
    ],
)
def test_sdram_gives_each_command_at_its_earliest_tick(
    before: list[tuple[int, int, bool]], asked_sclk: int, write: bool, page: Page, command_sclk: int
) -> None:
    """CL 3, tRCD 2, tRP 2, tRAS 7, tWR 2: each rule is met to the cycle, and no access waits longer."""
    board = board_named("cm-bf561")
    banks, sclk = SdramBanks(board.sdram, board.clocks), board.clocks.sclk_ticks
    for at, offset, was_write in before:
        banks.issue(at * sclk, offset, write=was_write, beats=1)
    found = banks.probe(asked_sclk * sclk, 0, write=write)
    assert (found.page, found.command) == (page, command_sclk * sclk)
    assert found.through == found.command + (1 if write else 4) * sclk


def test_a_refresh_waits_until_the_banks_can_be_closed_and_closes_them() -> None:
    """Written just before: tWR first, then tRP + tRAS + tRP; the page is closed after it."""
    board = board_named("cm-bf561")
    banks, sclk = SdramBanks(board.sdram, board.clocks), board.clocks.sclk_ticks
    due = banks.refresh_due
    banks.issue(due - 20 * sclk, 0, write=True, beats=1)
    banks.issue(due - sclk, 0, write=True, beats=1)
    banks.refresh()
    assert banks.command_from == due + (2 + 11) * sclk
    assert banks.probe(banks.command_from, 0, write=False).page is Page.MISS
    assert banks.refresh_due == due + 1875 * sclk


# ---- closed forms without contention


@each_board
def test_unloaded_reads_of_sdram(board: str) -> None:
    """Closed bank, open page, other page: 10, 8 and 12 SCLK of CM-BF561, at any offset to SCLK."""
    bench = Bench(board=board)
    spec, page = bench.spec, bench.spec.sdram.page_bytes
    bench.call(0, [(3, log.LOAD, 0), (104, log.LOAD, 4), (206, log.LOAD, page)], 300)
    read = spec.chip.external.core_sync_sclk + spec.sdram.nCL + (WORD // spec.sdram.word_bytes - 1)
    opening = {w.PAGE_HIT: 0, w.PAGE_MISS: spec.sdram.nRCD, w.PAGE_CONFLICT: spec.sdram.nRP + spec.sdram.nRCD}
    ratio = Fraction(bench.sclk, bench.cclk)
    assert bench.stalls() == {reason: ceil((read + sclk) * ratio) - 1 for reason, sclk in opening.items()}


@with_l2
def test_unloaded_accesses_of_l2(board: str) -> None:
    """A load costs the latency; the cycle of its issue is no stall. A store costs nothing."""
    bench = Bench(board=board)
    bench.call(0, [(3, log.LOAD, bench.l2), (50, log.STORE, bench.l2)], 100)
    assert bench.spec.chip.l2
    assert bench.stalls() == {w.L2_LATENCY: bench.spec.chip.l2.read_cclk - 1}


def test_stores_to_l2_go_no_faster_than_its_port() -> None:
    """Five words wait in the store buffer; all others wait for the port, two cycles a word."""
    bench = Bench()
    bench.call(0, [(number, log.STORE, bench.l2) for number in range(60)], 60)
    bench.play()
    ((end, _stalls),) = bench.calls
    assert end >= (60 - 5) * 2 * bench.cclk


@each_board
@pytest.mark.parametrize("count", [1, 10, 11, 41, 160, 250])
def test_streams_of_one_memory_dma(board: str, count: int) -> None:
    """Within a page: to SDRAM a word in a cycle; from it the same, with a pause of 4 after every 40; the rest on top."""
    sdram, fifo_words = board_named(board).sdram, board_named(board).chip.dma.fifo_words
    words_sclk = sdram.nRCD + count * WORD // sdram.word_bytes
    bench = Bench(board=board)
    assert bench.ends(bench.copy(bench.l1, 0, count)) == [words_sclk * bench.sclk]
    bench = Bench(board=board)
    pauses_sclk = (count - 1) // (10 * fifo_words) * fifo_words
    assert bench.ends(bench.copy(0, bench.l1, count)) == [(words_sclk + pauses_sclk + sdram.nCL) * bench.sclk]


def test_a_copy_within_sdram_goes_by_fifos() -> None:
    """Four words are read, then four are written: 8 words, the data of the last read, and the turn-round, each time."""
    bench = Bench()
    (end,) = bench.ends(bench.copy(0, bench.bank, 400))
    assert end is not None
    a_fifo_sclk = 4 + 3 + 1 + 4
    assert end == pytest.approx(100 * a_fifo_sclk * bench.sclk, rel=0.01)


@each_board
def test_a_picture_ends_with_its_last_word(board: str) -> None:
    """Nobody else on the bus: the last word is written when it arrives, at the next edge of SCLK."""
    bench = Bench(board=board)
    word_sclk = Fraction(81, 4)
    (end,) = bench.ends(bench.camera(0, 5, 16, word_sclk))
    arrives = ceil((4 * 18 + 16) * word_sclk) * bench.sclk
    assert end == arrives + WORD // bench.spec.sdram.word_bytes * bench.sclk
    assert bytes(bench.memories.arena[:320]) == bytes(bench.memories.arena[bench.outside :][:320])


def test_rows_of_a_picture_are_told_one_by_one() -> None:
    """The end of each line, and of the picture with its last one."""
    bench = Bench()
    picture, ends = bench.camera(0, 3, 16, Fraction(20)), []

    def watch() -> Any:
        while picture.end is None:
            yield bench.bus.when_row(picture)
            ends.append(bench.env.tick)

    watcher = bench.env.process(watch())
    bench.play()
    assert watcher.processed
    assert ends == [((18 * line + 16) * 20 + 1) * bench.sclk for line in range(3)] == [*ends[:2], picture.end]


# ---- arbitration


@pytest.fixture
def grants(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, Grant]]:
    """Who had the SDRAM bus, and when, in order."""
    found: list[tuple[int, Grant]] = []
    serve = SdramArbiter.serve

    def told(self: SdramArbiter, request: Request) -> Grant:
        grant = serve(self, request)
        found.append((request.master, grant))
        return grant

    monkeypatch.setattr(SdramArbiter, "serve", told)
    return found


def test_no_bus_is_granted_twice(grants: list[tuple[int, Grant]]) -> None:
    """Both cores, two streams and a camera: each grant comes when the one before has let go."""
    bench = Bench()
    bench.copy(0, bench.l1, 200)
    bench.copy(bench.l1 + 4096, bench.bank, 200, w.MDMA1_1)
    bench.camera(2 * bench.bank, 2, 16, Fraction(5))
    for core in (0, 1):
        bench.call(core, [(n, log.STORE if n % 3 else log.LOAD, n * 64) for n in range(200)], 200)
    bench.play()
    assert len(grants) == 200 + 200 + 32 + 400
    assert all(before.free <= after.at for (_, before), (_, after) in pairwise(grants))


@pytest.mark.parametrize(("board", "first"), [("cm-bf561", w.MDMA1_0), ("bf561-ezkit", w.CORE_A)])
def test_cdprio_decides_between_dma_and_core(grants: list[tuple[int, Grant]], board: str, first: int) -> None:
    """Both ask at tick 0: with CDPRIO the DMA goes first, without it the core."""
    bench = Bench(board=board)
    bench.copy(bench.l1, 0, 1)
    bench.call(0, [(0, log.LOAD, 0)])
    bench.play()
    assert grants[0][0] == first


def test_cores_take_turns(grants: list[tuple[int, Grant]]) -> None:
    """Stores of both without an end: neither keeps the other from the bus."""
    bench = Bench()
    for core in (0, 1):
        bench.call(core, [(n, log.STORE, core * bench.bank + 4 * n) for n in range(100)], 100)
    bench.play()
    assert [master for master, _ in grants] == [w.STORES_A, w.STORES_B] * 100


def test_the_lower_channel_goes_first(grants: list[tuple[int, Grant]]) -> None:
    """Two controllers write as fast as they can; DMA1 has the bus until it is done."""
    bench = Bench()
    bench.copy(bench.l1, 0, 30, w.MDMA2_0)
    bench.copy(bench.l1, 0, 30, w.MDMA1_0)
    bench.play()
    assert [master for master, _ in grants] == [w.MDMA1_0] * 30 + [w.MDMA2_0] * 30


def test_urgent_comes_before_the_cores(grants: list[tuple[int, Grant]]) -> None:
    """Without CDPRIO the cores go first, until more than half of the PPI's FIFO of 12 waits."""
    bench = Bench(board="bf561-ezkit")
    for core in (0, 1):
        accesses = [(n, log.WRITE_BACK, core * bench.bank + 4096 + 32 * n) for n in range(100)]
        bench.call(core, accesses, 100)
    bench.ends(bench.camera(2 * bench.bank, 1, 64, Fraction(4)))
    first = next(grant.at for master, grant in grants if master == w.PPI0)
    assert first >= 7 * 4 * bench.sclk  # the seventh word
    assert first < max(grant.at for master, grant in grants if master != w.PPI0)
    assert bench.bus.lost_by(w.PPI0) == 0


def test_a_camera_that_is_too_fast_loses_words() -> None:
    """Each word comes in half a cycle; the FIFO holds 12 at a time, and the picture goes on without the others."""
    bench = Bench()
    (end,) = bench.ends(bench.camera(0, 1, 64, Fraction(1, 2)))
    assert end is not None
    assert 0 < bench.bus.lost_by(w.PPI0) < 64 - 12


def test_memory_dma_streams_take_turns() -> None:
    """HRM of the BF537: bursts of up to P words each, in alternation; with P = 0 stream 0 goes first."""
    turns, order = MdmaTurns(3), []
    for _ in range(9):
        order.append(min((w.MDMA1_0, w.MDMA1_1), key=turns.rank))
        turns.count(order[-1])
    assert order == [w.MDMA1_0] * 3 + [w.MDMA1_1] * 3 + [w.MDMA1_0] * 3
    assert MdmaTurns(0).rank(w.MDMA1_0) < MdmaTurns(0).rank(w.MDMA1_1)


def test_a_load_of_what_is_in_the_store_buffer_waits() -> None:
    """A line fill over a word that is not written yet: the store goes first."""
    bench = Bench()
    bench.call(0, [(0, log.STORE, 20), (1, log.FILL, 0)], 10)
    assert w.STORE_BUFFER in bench.stalls()
