"""A core at L2 and SDRAM: what each kind of access stalls it, alone, behind its own stores, and beside the other core."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.boards import BOARDS
from bfsim.kernel.calls.access_log import FETCH, FETCH_LINE, FILL, LOAD, STORE, WRITE_BACK
from bfsim.machine.bus import state as w
from bfsim.trace import StallReason
from tests.machine.bench import Bench, Call

SDRAM, OTHER_PAGE, OTHER_BANK, L2 = 0x0000_0000, 0x0000_0800, 0x0080_0000, 0xFEB0_0000
A, B = 0, 1
REFRESH_DUE = 1875  # SCLK
Access = tuple[int, int, int]
Stalls = dict[StallReason, int]
both_ratios = pytest.mark.parametrize("board", ["cm-bf561", "cm-bf561-ratings"])
HIT, MISS, CONFLICT = (
    StallReason.SDRAM_PAGE_HIT,
    StallReason.SDRAM_PAGE_MISS,
    StallReason.SDRAM_PAGE_CONFLICT,
)


def play(bench: Bench, *accesses: Access, begin: int = 0, core: int = A) -> Call:
    """Play one call of a core to its end."""
    call = bench.call(core, accesses, begin=begin, cclk=len(accesses))
    bench.play()
    return call


def read_cclk(bench: Bench, opening_sclk: int = 0) -> int:
    """Cycles that a read of an idle SDRAM stalls: its SCLK cycles in CCLK, rounded up, without the read's own."""
    chip, clocks = bench.spec.chip, bench.spec.clocks
    sclk = chip.external.core_sync_sclk + bench.spec.sdram.nCL + opening_sclk
    return ceil(sclk * clocks.sclk_ticks / clocks.cclk_ticks) - 1


def test_unloaded_reads_of_sdram_in_cycles() -> None:
    """8, 10 and 12 SCLK for hit, miss and conflict: 40, 50, 60 CCLK at 600/120, 36, 45, 54 at 600/133 1/3."""
    for name, expected in (("cm-bf561", (39, 49, 59)), ("cm-bf561-ratings", (35, 44, 53))):
        bench = Bench(name)
        sdram = bench.spec.sdram
        assert tuple(read_cclk(bench, each) for each in (0, sdram.miss_sclk, sdram.conflict_sclk)) == expected


# ---- Alone


@both_ratios
@pytest.mark.parametrize("begin_cclk", range(10))
def test_a_load_from_sdram_stalls_by_page(board: str, begin_cclk: int) -> None:
    """Closed bank, open page, other page: the closed form, whatever the phase to SCLK; and nothing else stalls."""
    bench = Bench(board)
    sdram = bench.spec.sdram
    accesses = [(number, LOAD, each) for number, each in enumerate((SDRAM, SDRAM + 4, OTHER_PAGE))]
    begin = bench.cclk(begin_cclk)
    call = play(bench, *accesses, begin=begin)
    assert call.stalls == {
        MISS: read_cclk(bench, sdram.miss_sclk),
        HIT: read_cclk(bench),
        CONFLICT: read_cclk(bench, sdram.conflict_sclk),
    }
    assert call.end == begin + bench.cclk(3 + sum(call.stalls.values()))


@both_ratios
def test_a_load_from_l2_stalls_for_the_latency(board: str) -> None:
    """Every read costs its latency, one cycle of which is its issue."""
    bench = Bench(board)
    assert bench.spec.chip.l2 is not None
    call = play(bench, *((cycle, LOAD, L2 + 4 * cycle) for cycle in range(10)))
    assert call.stalls == {StallReason.L2_LATENCY: 10 * (bench.spec.chip.l2.read_cclk - 1)}


def test_a_narrow_bus_takes_two_cycles_a_word() -> None:
    """The CM-BF533 has 16 data lines: a load is there a cycle later, and counts two accesses of its page."""
    bench = Bench("cm-bf533")
    call = play(bench, (0, LOAD, SDRAM), (1, LOAD, SDRAM + 4))
    assert call.stalls == {MISS: read_cclk(bench, 1 + bench.spec.sdram.miss_sclk), HIT: read_cclk(bench, 1)}
    traffic = bench.traffic(w.CORE_A)
    assert (traffic.read_bytes, traffic.page_hits, traffic.page_misses) == (8, 3, 1)


@pytest.mark.parametrize("kind", [FILL, FETCH, FETCH_LINE])
def test_lines_and_code_are_waited_for_up_to_their_first_word(kind: int) -> None:
    """The rest of a line comes while the core goes on, but the next line is asked for behind it."""
    bench = Bench()
    reason = StallReason.CACHE_FILL if kind == FILL else StallReason.CODE_FETCH
    nbytes = w.FETCH_BYTES if kind == FETCH else bench.spec.chip.cache.line_bytes
    accesses = [(number, kind, SDRAM + nbytes * number) for number in range(3)]
    stalled = read_cclk(bench, bench.spec.sdram.miss_sclk) + 2 * read_cclk(bench)
    rest_cclk = 0 if kind == FETCH else (nbytes // 4 - 1) * bench.sclk(1) // bench.spec.clocks.cclk_ticks
    assert play(bench, *accesses).stalls == {reason: stalled + 2 * rest_cclk}
    traffic = bench.traffic(w.CORE_A)
    assert (traffic.read_bytes, traffic.page_misses) == (3 * nbytes, 1)
    assert traffic.page_hits == 3 * nbytes // 4 - 1


@pytest.mark.parametrize("kind", [FILL, FETCH, FETCH_LINE])
def test_lines_and_code_in_l2_stall_for_the_latency(kind: int) -> None:
    """The first 64 bits come as a load's do."""
    bench = Bench()
    assert bench.spec.chip.l2 is not None
    reason = StallReason.CACHE_FILL if kind == FILL else StallReason.CODE_FETCH
    assert play(bench, (0, kind, L2)).stalls == {reason: bench.spec.chip.l2.read_cclk - 1}
    nbytes = w.FETCH_BYTES if kind == FETCH else bench.spec.chip.cache.line_bytes
    assert bench.traffic(w.CORE_A, w.NO_BUFFER_IN_L2).read_bytes == nbytes


def test_a_refresh_in_the_way_is_told_apart() -> None:
    """Asked for when it begins, the core waits for all of it, and finds the bank closed."""
    bench = Bench()
    sdram = bench.spec.sdram
    play(bench, (0, LOAD, SDRAM))
    call = play(bench, (0, LOAD, SDRAM), begin=bench.sclk(REFRESH_DUE))
    assert call.stalls == {
        MISS: read_cclk(bench, sdram.miss_sclk),
        StallReason.SDRAM_REFRESH: sdram.refresh_sclk * 5,
    }


# ---- Its own stores


@pytest.mark.parametrize("address", [SDRAM, L2])
def test_stores_are_posted_as_long_as_the_buffer_has_room(address: int) -> None:
    """As many as it is deep cost the core nothing, even all in one cycle; with one more it waits."""
    depth = Bench().spec.chip.external.store_buffer
    for count, waits in ((depth, False), (depth + 1, True)):
        bench = Bench()
        call = play(bench, *((0, STORE, address + 4 * number) for number in range(count)))
        assert (set(call.stalls) == {StallReason.STORE_BUFFER}) == waits
        memory = w.NO_BUFFER_IN_L2 if address == L2 else w.NO_BUFFER_IN_SDRAM
        assert bench.traffic(w.STORES_A, memory).written_bytes == 4 * count


@both_ratios
@pytest.mark.parametrize("more", [1, 2, 40])
def test_many_stores_go_at_the_pace_of_the_bus(board: str, more: int) -> None:
    """All in one cycle: the core is through when all but a buffer full have left, the page's opening and a cycle each."""
    bench = Bench(board)
    depth, clocks = bench.spec.chip.external.store_buffer, bench.spec.clocks
    call = play(bench, *((0, STORE, SDRAM + 4 * number) for number in range(depth + more)))
    left_sclk = bench.spec.sdram.nRCD + more
    (stalled,) = call.stalls.values()
    assert abs(stalled * clocks.cclk_ticks - bench.sclk(left_sclk)) < bench.sclk(
        1
    )  # CCLK edges between SCLK's


def test_many_stores_to_l2_go_at_the_pace_of_its_port() -> None:
    """Two cycles each, of which one is the store's own where they come one a cycle."""
    bench = Bench()
    assert bench.spec.chip.l2 is not None
    depth, count = bench.spec.chip.external.store_buffer, 100
    call = play(bench, *((cycle, STORE, L2 + 4 * cycle) for cycle in range(count)))
    left = (count - depth) * bench.spec.chip.l2.next_cclk
    (stalled,) = call.stalls.values()
    assert (
        abs(stalled - (left - (count - 1))) < bench.spec.chip.l2.next_cclk
    )  # a word leaves as its two cycles begin


def test_a_load_overtakes_stores_to_other_words() -> None:
    """Five stores wait; the load waits for the one that has the bus, two cycles of opening and one of data."""
    bench = Bench()
    stores = [(0, STORE, SDRAM + 4 * number) for number in range(5)]
    call = play(bench, *stores, (1, LOAD, SDRAM + 512))
    # the load's own edge is the first one, at 5 cycles; the bus is free at the third
    assert call.stalls == {HIT: read_cclk(bench), StallReason.EBIU_ARBITRATION: 2 * 5}


@pytest.mark.parametrize("byte", range(4))
def test_a_load_of_a_queued_word_waits_until_all_stores_are_done(byte: int) -> None:
    """Any byte of the word, written last of five: opening and five words, from cycle 1 on, and then the load."""
    bench = Bench()
    stores = [(0, STORE, SDRAM + 4 * number) for number in range(5)]
    call = play(bench, *stores, (1, LOAD, SDRAM + 16 + byte))
    done_cclk = (bench.spec.sdram.nRCD + 5) * 5
    assert call.stalls == {StallReason.STORE_BUFFER: done_cclk - 1, HIT: read_cclk(bench)}


def test_a_load_of_l2_overtakes_stores_to_sdram() -> None:
    """Loads and stores of different memories do not meet."""
    call = play(Bench(), *((0, STORE, SDRAM + 4 * number) for number in range(5)), (1, LOAD, L2))
    assert call.stalls == {StallReason.L2_LATENCY: 8}


def test_stores_go_on_when_the_call_is_over() -> None:
    """The next call finds the bus busy with them."""
    bench = Bench()
    first = bench.call(A, [(0, STORE, SDRAM + 4 * number) for number in range(5)], cclk=1)
    bench.env.run()
    assert first.end == bench.cclk(1)
    second = play(bench, (0, LOAD, SDRAM + 512), begin=bench.cclk(1))
    assert second.stalls[StallReason.EBIU_ARBITRATION] == 2 * 5


def test_a_line_leaves_through_the_store_buffer() -> None:
    """The changed line is posted, so the new one is there as soon as without it; its eight words follow."""
    bench = Bench()
    call = play(bench, (0, LOAD, SDRAM), (1, WRITE_BACK, SDRAM + 64), (1, FILL, SDRAM + 128))
    assert call.stalls == {MISS: read_cclk(bench, bench.spec.sdram.miss_sclk), StallReason.CACHE_FILL: 39}
    assert bench.traffic(w.STORES_A).written_bytes == 32
    assert bench.traffic(w.STORES_A).page_hits == 8


def test_a_line_that_just_left_is_written_before_it_is_read() -> None:
    """Memory has the old line until then."""
    call = play(Bench(), (0, STORE, OTHER_BANK), (0, WRITE_BACK, SDRAM), (1, FILL, SDRAM))
    # a word and eight, each behind the opening of its page
    assert call.stalls == {StallReason.STORE_BUFFER: (2 + 1 + 2 + 8) * 5 - 1, StallReason.CACHE_FILL: 39}


def test_a_line_with_a_queued_word_waits_for_it() -> None:
    """Written through without a line of its own, a word is on its way when another word of its line is read."""
    call = play(Bench(), (0, STORE, OTHER_BANK), (0, STORE, SDRAM + 8), (1, FILL, SDRAM))
    assert StallReason.STORE_BUFFER in call.stalls


def test_a_core_alone_never_waits_for_arbitration() -> None:
    """A store that it made itself to another page must recover before this one can be opened."""
    call = play(Bench(), (0, LOAD, SDRAM), (1, STORE, SDRAM), (2, LOAD, OTHER_PAGE))
    assert StallReason.EBIU_ARBITRATION not in call.stalls


# ---- Two cores


def play_both(bench: Bench, a: Sequence[Access], b: Sequence[Access]) -> tuple[Call, Call]:
    """Play a call of each core, from the same tick on."""
    calls = bench.call(A, a, cclk=len(a)), bench.call(B, b, cclk=len(b))
    bench.play()
    return calls


def test_two_cores_share_the_port_of_l2() -> None:
    """Asked for in the same cycle, core B's word comes as much later as core A's holds the port."""
    bench = Bench()
    assert bench.spec.chip.l2 is not None
    a, b = play_both(bench, [(0, LOAD, L2)], [(0, LOAD, L2 + 64)])
    assert a.stalls == {StallReason.L2_LATENCY: 8}
    assert b.stalls == {StallReason.L2_LATENCY: 8, StallReason.L2_PORT: bench.spec.chip.l2.next_cclk}


def test_two_cores_take_turns_at_the_bus() -> None:
    """Words of one open page: a cycle behind each other, and each of them waits once at most."""
    bench = Bench()
    play(bench, (0, LOAD, SDRAM))
    calls = [bench.call(core, [(0, LOAD, SDRAM + 64 * core)], begin=500, cclk=1) for core in (A, B)]
    bench.play()
    # core A had the bus last
    assert calls[B].stalls == {HIT: 39}
    assert calls[A].stalls == {HIT: 39, StallReason.EBIU_ARBITRATION: 5}


def test_one_bank_is_slower_than_two() -> None:
    """Both cores read all the time, each its own page: the pages are in the same bank, or in two."""
    stalls = {}
    for name, other in (("one bank", OTHER_PAGE), ("two banks", OTHER_BANK)):
        a, b = play_both(
            Bench(),
            [(cycle, LOAD, SDRAM + 4 * cycle) for cycle in range(40)],
            [(cycle, LOAD, other + 4 * cycle) for cycle in range(40)],
        )
        stalls[name] = [sum(call.stalls.values()) for call in (a, b)]
        assert (CONFLICT in a.stalls) == (name == "one bank")
    # in two banks each read is a hit and waits for a word of the other core at most
    assert max(stalls["two banks"]) <= 40 * (39 + 5) + 2 * 2 * 5
    # in one bank each read finds its page closed by the other core, and waits for that one's tRAS
    assert min(stalls["one bank"]) >= 39 * 59


# ---- Whatever a core does

accesses = st.lists(
    st.tuples(
        st.integers(0, 30),
        st.sampled_from([LOAD, LOAD, STORE, STORE, FILL, WRITE_BACK, FETCH, FETCH_LINE]),
        st.sampled_from([SDRAM, OTHER_PAGE, OTHER_BANK, L2]),
        st.integers(0, 8).map(lambda number: 32 * number),
    ),
    min_size=1,
    max_size=25,
)


def in_order(drawn: Sequence[tuple[int, int, int, int]]) -> list[Access]:
    """Make accesses of what hypothesis drew: (cycles since the last one, kind, memory, place in it)."""
    found, stamp = [], 0
    for wait, kind, memory, place in drawn:
        stamp += wait
        found.append((stamp, kind, memory + place))
    return found


@given(
    name=st.sampled_from([name for name in BOARDS if name != "cm-bf533"]),
    of_a=accesses,
    of_b=accesses,
    begin=st.integers(0, 4000),
)
def test_every_cycle_of_a_call_is_issued_or_stalled(
    name: str, of_a: list[tuple[int, int, int, int]], of_b: list[tuple[int, int, int, int]], begin: int
) -> None:
    """issue + stall = elapsed for both cores, and no access is faster than its memory."""
    bench = Bench(name)
    begin = bench.cclk(begin)
    made = [in_order(each) for each in (of_a, of_b)]
    issue = [each[-1][0] + len(each) for each in made]
    calls = [bench.call(core, made[core], begin=begin, cclk=issue[core]) for core in (A, B)]
    bench.play()
    assert bench.spec.chip.l2 is not None
    for call, log, cclk in zip(calls, made, issue, strict=True):
        assert call.end == begin + bench.cclk(cclk + sum(call.stalls.values()))
        waits = [address for _, kind, address in log if kind not in {STORE, WRITE_BACK}]
        least = sum(
            bench.spec.chip.l2.read_cclk - 1 if address >= L2 else read_cclk(bench) for address in waits
        )
        assert sum(call.stalls.values()) >= least


@given(drawn=accesses)
def test_a_core_moves_what_it_asks_for(drawn: list[tuple[int, int, int, int]]) -> None:
    """Every byte of its log is counted once, read or written, in the memory where it lies."""
    bench = Bench()
    log = in_order(drawn)
    play(bench, *log)
    size = {LOAD: 4, STORE: 4, FETCH: 8, FILL: 32, FETCH_LINE: 32, WRITE_BACK: 32}
    for memory in (w.NO_BUFFER_IN_SDRAM, w.NO_BUFFER_IN_L2):
        asked = [
            (kind, size[kind]) for _, kind, address in log if (address >= L2) == (memory == w.NO_BUFFER_IN_L2)
        ]
        written = sum(nbytes for kind, nbytes in asked if kind in {STORE, WRITE_BACK})
        assert bench.traffic(w.STORES_A, memory).written_bytes == written
        assert bench.traffic(w.CORE_A, memory).read_bytes == sum(nbytes for _, nbytes in asked) - written
