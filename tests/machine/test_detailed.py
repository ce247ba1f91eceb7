"""The detailed mode: closed forms, the rules of arbitration one by one, and the fast mode beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from itertools import pairwise
from math import ceil
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from bfsim.chip.boards import BOARDS, board_named
from bfsim.kernel import access_trace as log
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.transfer_plans import Pace, Transfer, Walk
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.detailed.arbiter import Grant, MdmaTurns, Request, SdramArbiter
from bfsim.machine.detailed.bus import DetailedBus
from bfsim.machine.detailed.sdram import Page, SdramBanks
from bfsim.machine.memories import Memories
from bfsim.machine.simulation import END_OF_TIME, Simulation
from tests.machine.rig import keep_code, write_log

IN_EVERY_RUN = ("cm-bf561", "bf561-ezkit", "cm-bf533")
"""A board of each kind: the others are the first one with other clocks."""


def on_boards(names: Iterable[str]) -> pytest.MarkDecorator:
    """Play a test on each of these."""
    marked = [
        pytest.param(each, marks=() if each in IN_EVERY_RUN else pytest.mark.exhaustive) for each in names
    ]
    return pytest.mark.parametrize("board", marked)


each_board = on_boards(BOARDS)
with_l2 = on_boards(name for name, each in BOARDS.items() if each.chip.l2)
MODES = (WovenBus, DetailedBus)
NBYTES = 1 << 13  # of noise at the beginning of each memory, and of the world outside
CODE_BYTES = 40  # of each routine that is fetched
WORD = 4

CoreAccess = tuple[int, int, int]
"""Cycle of the call, kind, and offset."""


class Bench:
    """One bus with its memories; what tests post is all that happens."""

    def __init__(self, mode: Callable[..., Bus] = DetailedBus, board: str = "cm-bf561") -> None:
        self.spec = board_named(board)
        self.env = Simulation()
        self.memories = Memories(self.spec, NBYTES)
        self.bus = mode(self.env, self.spec, self.memories)
        self.sclk, self.cclk = self.spec.clocks.sclk_ticks, self.spec.clocks.cclk_ticks
        self.l2, self.l1, self.outside = self.memories.sdram_end, self.memories.l1, self.memories.outside
        self.bank = self.spec.sdram.bank_bytes
        self.calls: list[tuple[int, list[int]]] = []
        for number, first in enumerate((0, self.bank, self.l1, self.outside)):
            noise = np.random.default_rng(number).integers(0, 256, NBYTES, np.uint8)
            self.memories.bytes_from(first, NBYTES)[:] = noise

    def copy(
        self, source: int, target: int, count: int, master: int = w.MDMA1_0, setup_sclk: int = 0
    ) -> Transfer:
        """Copy words by a memory DMA."""
        walks = [Walk(first, count, WORD, WORD) for first in (source, target)]
        setup = setup_sclk * self.sclk
        plan = self.bus.planner.copy(master, walks[0], walks[1], count, element_bytes=WORD, setup=setup)
        return self.bus.post(plan)

    def camera(self, target: int, lines: int, words: int, word_sclk: Fraction) -> Transfer:
        """Receive a picture by PPI0, with a pause of two words behind each line."""
        pace = Pace(0, words, word_sclk * self.sclk, (words + 2) * word_sclk * self.sclk)
        walks = [Walk(first, words, WORD, WORD) for first in (self.outside, target)]
        plan = self.bus.planner.receive(
            w.PPI0, walks[0], walks[1], lines * words, element_bytes=WORD, pace=pace
        )
        return self.bus.post(plan)

    def call(self, core: int, accesses: Iterable[CoreAccess], cclk: int = 0, fetches: int = 0) -> None:
        """Make the accesses of a call, and `fetches` of its code (`keep_code`); its end and its stalls come to `calls`."""
        entries = [stamp << log.STAMP_BIT | kind << log.KIND_BIT | offset for stamp, kind, offset in accesses]
        done = self.bus.cores.access(core, 0, cclk, write_log(self.bus.logs, core, entries, fetches))
        done.callbacks.append(
            lambda _event: self.calls.append((self.env.tick, list(self.bus.cores.stalls_of(core))))
        )

    def play(self) -> None:
        """Play everything to its end."""
        self.env.run()
        self.bus.play_until(END_OF_TIME)

    def ends(self, *transfers: Transfer) -> list[int | None]:
        """Play everything and return when each transfer was done."""
        self.play()
        return [each.end for each in transfers]

    def content(self) -> list[bytes]:
        """Return what lies where tests copy from and to, and behind it: to look through all of SDRAM takes half a second."""
        firsts = (0, self.bank, self.l2, self.l1, self.outside)
        return [self.memories.bytes_from(first, 2 * NBYTES).tobytes() for first in firsts]

    def traffic(self) -> list[int]:
        """Return every counter of who moved what."""
        return list(self.bus.words[w.TRAFFIC_AT : w.SUBBANKS_AT])

    def stalls(self) -> dict[int, int]:
        """Play everything and return the stalls of the only call."""
        self.play()
        ((_end, stalls),) = self.calls
        return {reason: cclk for reason, cclk in enumerate(stalls) if cclk}


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
    serve = SdramArbiter._serve

    def told(self: SdramArbiter, request: Request) -> Grant:
        grant = serve(self, request)
        found.append((request.master, grant))
        return grant

    monkeypatch.setattr(SdramArbiter, "_serve", told)
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


# ---- the fast mode beside it


def same(board: str, prepare: Any) -> tuple[Bench, Bench]:
    """Play the same on both buses."""
    benches = [Bench(mode, board) for mode in MODES]
    for bench in benches:
        prepare(bench)
        bench.play()
    return benches[0], benches[1]


@each_board
@pytest.mark.parametrize("kind", [log.LOAD, log.STORE, log.FILL, log.WRITE_BACK, log.FETCH, log.FETCH_LINE])
def test_accesses_of_one_core_are_the_same_in_both_modes(board: str, kind: int) -> None:
    """To SDRAM and to L2, further apart than the store buffer needs to be empty."""
    apart = 120
    offsets = [32 * number * 7 for number in range(20)]
    if board_named(board).chip.l2:
        offsets += [board_named(board).sdram.nbytes + 32 * number for number in range(20)]
    accesses = [(apart * number + number % 7, kind, offset) for number, offset in enumerate(offsets)]
    fast, detailed = same(board, lambda bench: bench.call(0, accesses, apart * 41))
    assert fast.calls == detailed.calls
    assert fast.traffic() == detailed.traffic()


@each_board
@pytest.mark.parametrize("fetches", [1, 10, 77])
@pytest.mark.parametrize("gap_cclk", [2, 5, 150])
def test_fetches_are_the_same_in_both_modes(board: str, fetches: int, gap_cclk: int) -> None:
    """Of code in SDRAM and in L2, faster than it can come and slowly, among the loads of a call."""

    def prepare(bench: Bench) -> None:
        places = [64, bench.bank + 8192, *([bench.l2 + 64] if bench.spec.chip.l2 else [])]
        keep_code(bench.bus.logs, 0, CODE_BYTES, *places)
        loads = [(3 * gap_cclk * each, log.LOAD, 4 * each) for each in range(8)]
        bench.call(0, loads, max(fetches, 3 * len(loads)) * gap_cclk, fetches)

    fast, detailed = same(board, prepare)
    assert fast.calls == detailed.calls
    assert fast.traffic() == detailed.traffic()
    assert fast.stalls()[w.CODE_FETCH] > 0
    first, count = w.SITES_AT, 4 * w.SITE_WORDS
    assert list(fast.bus.words[first : first + count]) == list(detailed.bus.words[first : first + count])


@each_board
@pytest.mark.parametrize(
    ("source", "target"), [("l1", "sdram"), ("sdram", "l1"), ("sdram", "bank"), ("l1", "l1")]
)
@pytest.mark.parametrize("count", [1, 8, 41])
def test_copies_are_the_same_in_both_modes(board: str, source: str, target: str, count: int) -> None:
    """The end to the tick, every byte, every counter."""

    def copy(bench: Bench) -> None:
        places = {"l1": bench.l1, "sdram": 0, "bank": bench.bank}
        bench.transfer = bench.copy(places[source], places[target] + 4096, count, setup_sclk=15)

    fast, detailed = same(board, copy)
    assert fast.transfer.end == detailed.transfer.end
    assert fast.traffic() == detailed.traffic()
    assert fast.content() == detailed.content()


STORES_AND_LOADS = (log.STORE, log.LOAD, log.WRITE_BACK, log.FILL, log.FETCH_LINE, log.TEST_AND_SET)


@pytest.mark.parametrize("gap_cclk", [1, 2, 3, 4, 7, 48])
@pytest.mark.parametrize("kinds", [(each, each) for each in STORES_AND_LOADS] + [(log.STORE, log.LOAD)])
def test_two_cores_take_turns_at_l2_in_both_modes(kinds: tuple[int, int], gap_cclk: int) -> None:
    """512 words each, to memory of their own, with arithmetic between: neither keeps the other away, to a cycle in a call."""

    def prepare(bench: Bench) -> None:
        for core, kind in enumerate(kinds):
            first = bench.l2 + core * 32_768
            accesses = [(gap_cclk * number, kind, first + 32 * number) for number in range(512)]
            bench.call(core, accesses, gap_cclk * 512)

    fast, detailed = same("cm-bf561", prepare)
    ours, theirs = ([end // bench.cclk for end, _ in bench.calls] for bench in (fast, detailed))
    assert ours == pytest.approx(theirs, abs=2)
    if (
        kinds[0] == kinds[1]
    ):  # who begins is ahead by one access at most, and a line takes eight cycles of the port
        assert max(ours) - min(ours) <= max(13, 0.01 * max(ours))
    for (_, split), (_, other) in zip(fast.calls, detailed.calls, strict=True):
        assert split == pytest.approx(other, abs=3)
    assert fast.traffic() == detailed.traffic()


@pytest.mark.parametrize("gap_cclk", [1, 3, 10, 40])
@pytest.mark.parametrize("kind", [log.LOAD, log.STORE])
@pytest.mark.parametrize(("source", "target"), [("l2", "l1"), ("l1", "l2"), ("l2", "l2")])
def test_imdma_and_a_core_share_the_port_of_l2(source: str, target: str, kind: int, gap_cclk: int) -> None:
    """1000 words of the internal DMA beside the accesses of a core: both are later than alone, as much in both modes."""
    spec = board_named("cm-bf561")
    alone_cclk = 1000 * spec.chip.dma.imdma_word_cclk * (2 if source == target else 1)

    def prepare(bench: Bench) -> None:
        places = {"l1": bench.l1, "l2": bench.l2}
        bench.transfer = bench.copy(places[source], places[target] + 8192, 1000, w.IMDMA_0)
        bench.call(
            0, [(gap_cclk * each, kind, bench.l2 + 32_768 + 4 * each) for each in range(400)], 400 * gap_cclk
        )

    fast, detailed = same("cm-bf561", prepare)
    assert fast.transfer.end == pytest.approx(detailed.transfer.end, abs=2 * fast.cclk)
    assert fast.transfer.end > alone_cclk * fast.cclk
    ((ours, our_stalls),), ((theirs, their_stalls),) = fast.calls, detailed.calls
    assert ours == pytest.approx(theirs, abs=2 * fast.cclk)
    assert our_stalls == pytest.approx(their_stalls, abs=2)
    assert our_stalls[w.L2_PORT] + our_stalls[w.STORE_BUFFER] > 0 or kind == log.STORE
    assert fast.traffic() == detailed.traffic()
    assert fast.content() == detailed.content()


@pytest.mark.parametrize("count", [1, 7, 1000])
@pytest.mark.parametrize(("source", "target"), [("l2", "l1"), ("l1", "l2"), ("l1", "l1")])
def test_imdma_alone_keeps_its_pace(source: str, target: str, count: int) -> None:
    """Two cycles a word, as without the port."""

    def copy(bench: Bench) -> None:
        places = {"l1": bench.l1, "l2": bench.l2}
        bench.transfer = bench.copy(places[source], places[target] + 8192, count, w.IMDMA_1)

    fast, detailed = same("cm-bf561", copy)
    word_cclk = fast.spec.chip.dma.imdma_word_cclk
    assert fast.transfer.end == detailed.transfer.end == count * word_cclk * fast.cclk
    assert fast.traffic() == detailed.traffic()


@pytest.mark.parametrize("kind", [log.LOAD, log.STORE])
def test_a_core_that_spins_takes_time_at_the_port_of_l2(kind: int) -> None:
    """Its tries lock the port for 11 of 19 cycles: loads of the other core wait for it, as long in both modes."""
    accesses = 300

    def prepare(bench: Bench) -> None:
        bench.call(
            0, [(10 * each, kind, bench.l2 + 8192 + 4 * each) for each in range(accesses)], 10 * accesses
        )
        bench.bus.cores.spin(1, 0)

    benches = [Bench(mode) for mode in MODES]
    for bench in benches:
        prepare(bench)
        bench.env.run(until=bench.env.timeout(40 * accesses * bench.cclk))
        bench.bus.settle()
    fast, detailed = benches
    ((ours, our_stalls),), ((theirs, their_stalls),) = fast.calls, detailed.calls
    assert ours == pytest.approx(theirs, abs=12 * fast.cclk)
    assert our_stalls == pytest.approx(their_stalls, abs=12)
    if kind == log.LOAD:
        assert accesses // 2 < our_stalls[w.L2_PORT] < 11 * accesses
    done = [bench.bus.cores.stop_spinning(1) for bench in benches]
    for bench, event in zip(benches, done, strict=True):
        bench.env.run(until=event)
    tries = [
        traffic[(w.NO_BUFFER_IN_L2 * w.MASTERS + w.CORE_B) * w.TRAFFIC_WORDS] // 4
        for traffic in (fast.traffic(), detailed.traffic())
    ]
    assert tries[0] == pytest.approx(40 * accesses / 19, rel=0.05)
    assert tries[0] == pytest.approx(tries[1], abs=2)


def accesses_by_chance(seed: int, core: int, bench: Bench) -> list[CoreAccess]:
    """Return 1500 reads and writes of all banks and of L2: some of what a frame has, so that chance evens out.

    The code of the call that makes them is in L2 and in SDRAM.
    """
    keep_code(bench.bus.logs, core, CODE_BYTES, bench.l2 + 4096, 3 * bench.bank)
    chance, stamp, found = Random(f"{seed} {core}"), 0, []
    memories = (*(number * bench.bank for number in range(4)), bench.l2)
    kinds = (log.LOAD, log.LOAD, log.FILL, log.FETCH, log.STORE, log.WRITE_BACK)
    for _ in range(1500):
        stamp += chance.choice((1, 5, 20, 60))
        found.append((stamp, chance.choice(kinds), chance.choice(memories) + 32 * chance.randrange(200)))
    return found


@pytest.mark.parametrize("gap_cclk", [1, 30])
def test_a_core_alone_waits_for_nobody(gap_cclk: int) -> None:
    """Two pages of a bank in turn, as fast as can be: its own tRAS is part of the page conflict, not arbitration."""

    def prepare(bench: Bench) -> None:
        bench.call(0, [(gap_cclk * each, log.LOAD, each % 2 * 8192 + 4 * each) for each in range(100)], 3000)

    fast, detailed = same("cm-bf561", prepare)
    assert fast.calls == detailed.calls
    assert fast.stalls()[w.PAGE_CONFLICT] > 0
    assert w.ARBITRATION not in fast.stalls()


@pytest.mark.exhaustive
def test_stalls_are_split_alike_in_both_modes() -> None:
    """Random traffic of both cores beside a stream and a camera: each reason to 5 % of it and 0.5 % of all stalls."""
    sums = []
    for mode in MODES:
        total = np.zeros(w.STALLS, np.int64)
        for seed in range(5):
            bench = Bench(mode)
            for core in (0, 1):
                accesses = accesses_by_chance(seed, core, bench)
                bench.call(core, accesses, accesses[-1][0] + 1, fetches=300)
            bench.copy(bench.l1, bench.bank, 500)
            bench.camera(2 * bench.bank, 8, 16, Fraction(20))
            bench.play()
            total += np.sum([stalls for _, stalls in bench.calls], axis=0)
        sums.append(total)
    ours, theirs = sums
    assert (theirs > 0).all()
    assert ours.tolist() == pytest.approx(theirs.tolist(), rel=0.05, abs=0.005 * int(theirs.sum()))


@pytest.mark.exhaustive
@given(seed=st.integers(0, 1000), words=st.sampled_from((160, 500, 2000)), word_sclk=st.integers(2, 120))
@settings(max_examples=12, derandomize=True, phases=[Phase.generate])
def test_random_traffic_is_within_the_aims(seed: int, words: int, word_sclk: int) -> None:
    """Two cores in all memories, a stream to SDRAM and a camera: 5 % of each core's call, 2 % of the whole.

    20 cycles a word are VGA at 24 MHz, SCLK 120 MHz.
    """

    def prepare(bench: Bench) -> None:
        for core in (0, 1):
            accesses = accesses_by_chance(seed, core, bench)
            bench.call(core, accesses, accesses[-1][0] + 1, fetches=300)
        bench.transfers = [
            bench.copy(bench.l1, bench.bank, words),
            bench.camera(2 * bench.bank, 8, 16, Fraction(word_sclk)),
        ]

    fast, detailed = same("cm-bf561", prepare)
    ours, theirs = (sorted(end for end, _ in bench.calls) for bench in (fast, detailed))
    assert theirs == pytest.approx(ours, rel=0.05)
    ends = [[*(end for end, _ in each.calls), *(t.end for t in each.transfers)] for each in (fast, detailed)]
    assert max(ends[1]) == pytest.approx(max(ends[0]), rel=0.02)
    assert (fast.memories.arena == detailed.memories.arena).all()
