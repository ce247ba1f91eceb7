"""Memory DMA: what each path takes, alone and beside another stream, closed forms beside the simulation."""

from __future__ import annotations

from math import ceil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.boards import BOARDS
from bfsim.machine.bus import state as w
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.memories import Row
from tests.machine.bench import Bench

SDRAM, OTHER_PAGE, OTHER_BANK = 0x0000_1000, 0x0000_2000, 0x0080_0000
L1, L1_B, L2, LATE = 0xFF80_0000, 0xFF90_0000, 0xFEB0_0000, 50_000
KIB = 1024
two_cores = pytest.mark.parametrize("board", [name for name in BOARDS if name != "cm-bf533"])
each_board = pytest.mark.parametrize("board", BOARDS)


def words_of(bench: Bench, nbytes: int) -> int:
    """Bus cycles of the data alone: a word each, or less than one in the narrower elements that odd sizes need."""
    element = min(4, nbytes & -nbytes)
    return nbytes // element * max(1, element // bench.spec.sdram.word_bytes)


def pauses_sclk(bench: Bench, elements: int) -> int:
    """Cycles that a memory DMA pauses before the last of `elements` that it reads: a FIFO full of them every so often."""
    dma = bench.spec.chip.dma
    return int((elements - 1) * (dma.read_word_sclk - 1) / dma.fifo_words) * dma.fifo_words


def crossings(bench: Bench, nbytes: int) -> int:
    """Page borders in a row that begins with a page."""
    return (nbytes - 1) // bench.spec.sdram.page_bytes


def read_sclk(bench: Bench, nbytes: int) -> int:
    """From a closed bank to L1: start-up, page, words and pauses, latency."""
    sdram, words = bench.spec.sdram, words_of(bench, nbytes)
    elements = nbytes // min(bench.spec.chip.dma.word_bytes, nbytes & -nbytes)
    startup = bench.spec.chip.dma.startup_sclk
    openings = sdram.nRCD + crossings(bench, nbytes) * sdram.conflict_sclk
    return startup + openings + words + pauses_sclk(bench, elements) + sdram.nCL


def write_sclk(bench: Bench, nbytes: int) -> int:
    """From L1 to a closed bank: the master gives its data and goes."""
    sdram = bench.spec.sdram
    openings = sdram.nRCD + crossings(bench, nbytes) * (sdram.nWR + sdram.conflict_sclk)
    return bench.spec.chip.dma.startup_sclk + openings + words_of(bench, nbytes)


def copy(bench: Bench, source: int, target: int, nbytes: int = 640, at: int = 0) -> Transfer:
    """Post a copy of a row at `source` to one at `target`."""
    return bench.stream.copy(bench.row(source, nbytes), bench.row(target, nbytes), at)


@each_board
@pytest.mark.parametrize("nbytes", [1, 4, 6, 160, 640, 1280])
def test_a_copy_from_sdram_takes_start_up_page_words_pauses_and_latency(board: str, nbytes: int) -> None:
    """The closed form, in whole SCLK cycles, and every byte is there."""
    bench = Bench(board)
    source, target = bench.row(SDRAM, nbytes), bench.row(L1, nbytes)
    assert bench.ends(bench.stream.copy(source, target, 0)) == [bench.sclk(read_sclk(bench, nbytes))]
    assert np.array_equal(source.array, target.array)


@each_board
@pytest.mark.parametrize("nbytes", [1, 4, 6, 640, 1280])
def test_a_copy_to_sdram_has_no_pauses_and_no_latency(board: str, nbytes: int) -> None:
    """A word a cycle on the open page."""
    bench = Bench(board)
    assert bench.ends(copy(bench, L1, SDRAM, nbytes)) == [bench.sclk(write_sclk(bench, nbytes))]


def test_the_known_cycles_of_a_line() -> None:
    """640 bytes at 600/120, worked out by hand: 15 + 2 + 160 + 3 x 4 + 3 in, 15 + 2 + 160 out."""
    assert read_sclk(Bench(), 640) == 192
    assert write_sclk(Bench(), 640) == 177


def test_a_copy_between_banks_fills_and_empties_its_fifo() -> None:
    """Four words in, their latency, the turn-round, four words out: 12 cycles a burst; both pages are opened once."""
    bench = Bench()
    sdram, dma = bench.spec.sdram, bench.spec.chip.dma
    burst = dma.fifo_words + sdram.nCL + sdram.turn_round_sclk + dma.fifo_words
    # the write's page opens in the turn-round and a cycle more
    opening = sdram.nRCD + max(sdram.nRCD - sdram.turn_round_sclk, 0)
    expected = dma.startup_sclk + opening + 160 // dma.fifo_words * burst
    assert bench.ends(copy(bench, SDRAM, OTHER_BANK)) == [bench.sclk(expected)]
    traffic = bench.traffic(w.MDMA1_0)
    assert (traffic.read_bytes, traffic.written_bytes) == (640, 640)
    assert (traffic.page_hits, traffic.page_misses, traffic.page_conflicts) == (318, 2, 0)


def test_a_copy_within_one_bank_opens_a_page_for_every_lot() -> None:
    """Reads and writes close each other's page; what was written must recover first."""
    bench = Bench()
    sdram, dma = bench.spec.sdram, bench.spec.chip.dma
    reading = sdram.nWR + sdram.conflict_sclk + dma.fifo_words + sdram.nCL
    writing = sdram.conflict_sclk + dma.fifo_words
    first = sdram.nRCD + dma.fifo_words + sdram.nCL + writing
    expected = dma.startup_sclk + first + (160 // dma.fifo_words - 1) * (reading + writing)
    assert bench.ends(copy(bench, SDRAM, OTHER_PAGE)) == [bench.sclk(expected)]
    assert bench.traffic(w.MDMA1_0).page_conflicts == 79


@two_cores
@pytest.mark.parametrize(("source", "target"), [(L1, L1_B), (L1, L2), (L2, L1)])
def test_a_copy_on_the_chip_leaves_the_bus_alone(board: str, source: int, target: int) -> None:
    """A word per SCLK after the start-up, and nothing at the SDRAM."""
    bench = Bench(board)
    dma = bench.spec.chip.dma
    expected = dma.startup_sclk + ceil(160 * dma.on_chip_word_sclk)
    assert bench.ends(copy(bench, source, target)) == [bench.sclk(expected)]
    assert not any(bench.traffic(w.MDMA1_0))
    in_l2 = bench.traffic(w.MDMA1_0, w.NO_BUFFER_IN_L2)
    assert (in_l2.read_bytes, in_l2.written_bytes) == (640 * (source == L2), 640 * (target == L2))


@two_cores
def test_the_internal_dma_is_clocked_by_cclk(board: str) -> None:
    """Two CCLK a word between L1 and L2."""
    bench = Bench(board)
    bench.stream = bench.new_stream(w.IMDMA_0)
    dma = bench.spec.chip.dma
    assert bench.ends(copy(bench, L2, L1)) == [
        bench.sclk(dma.startup_sclk) + bench.cclk(160 * dma.imdma_word_cclk)
    ]


def test_copies_of_a_stream_follow_each_other() -> None:
    """The next one starts up when the one before is done; its page is open by then."""
    bench = Bench()
    first, second = (copy(bench, SDRAM, L1) for _ in range(2))
    duration = read_sclk(bench, 640)
    again = duration - bench.spec.sdram.nRCD
    assert bench.ends(first, second) == [bench.sclk(duration), bench.sclk(duration + again)]


def test_a_later_copy_does_not_overtake() -> None:
    """A copy that may start at once still waits for the one asked for before it, which may not."""
    bench = Bench()
    first, second = copy(bench, L1, SDRAM, at=LATE), copy(bench, L1, SDRAM)
    duration = write_sclk(bench, 640)
    # a refresh has closed the page before the first one, none comes between the two
    assert bench.ends(first, second) == [
        LATE + bench.sclk(duration),
        LATE + bench.sclk(2 * duration - bench.spec.sdram.nRCD),
    ]


@pytest.mark.parametrize("at", [0, 999, 1000, 1001, 1004, 1005])
def test_a_copy_starts_at_its_time_and_never_in_the_past(at: int) -> None:
    """Asked for at tick 1000: earlier means now, later means then, and the bus takes it at the next SCLK edge."""
    bench = Bench()
    bench.env.run(until=1000)
    begin = ceil(max(at, 1000) / bench.sclk(1)) * bench.sclk(1)
    assert bench.ends(copy(bench, SDRAM, L1, at=at)) == [begin + bench.sclk(read_sclk(bench, 640))]


def test_a_word_is_read_when_the_bus_reads_it() -> None:
    """What is written to the source before that moment arrives; what is written after it does not."""
    bench = Bench()
    source, target = bench.row(SDRAM, 4), bench.row(L1, 4)
    bench.stream.copy(source, target, 0)
    granted = bench.sclk(bench.spec.chip.dma.startup_sclk)
    source.array[:] = 1
    bench.bus.play_until(granted)
    source.array[:] = 2
    bench.bus.play_until(granted + 1)
    source.array[:] = 3
    bench.play()
    assert target.array.tolist() == [2, 2, 2, 2]


def test_a_faster_bus_never_slows_a_lone_copy() -> None:
    """Time from first to last, in seconds: 133 1/3 MHz against 120 MHz."""
    seconds = []
    for board in ("cm-bf561", "cm-bf561-ratings"):
        bench = Bench(board)
        (end,) = bench.ends(copy(bench, SDRAM, L1))
        seconds.append(end / bench.spec.clocks.tick_hz)
    assert seconds[1] < seconds[0]


# ---- Streaming


def stream(bench: Bench, source: int, target: int, rounds: int = 12) -> int:
    """Copy 16 KB so many times in a row; return how long that took, in SCLK, without the start-ups."""
    rows = bench.row(source, 16 * KIB), bench.row(target, 16 * KIB)
    *_, end = bench.ends(*(bench.stream.copy(*rows, 0) for _ in range(rounds)))
    return end // bench.sclk(1) - rounds * bench.spec.chip.dma.startup_sclk


@pytest.mark.parametrize(
    ("source", "target", "peak_word_sclk"),
    [
        (SDRAM, L1, 1.1),
        (L1, SDRAM, 1.0),
        (SDRAM, OTHER_BANK, 3.0),  # in bursts of four: 4 + 3 + 1 + 4 cycles
        (L1, L1_B, 1.0),
        (L1, L2, 1.0),
        (L2, L1, 1.0),
    ],
)
def test_streaming_comes_near_its_peak_and_never_beyond(
    source: int, target: int, peak_word_sclk: float
) -> None:
    """What is missing is refresh, its share of the bus and no more, the pages, and the last word's latency."""
    bench = Bench()
    words = 12 * 16 * KIB // 4
    took = stream(bench, source, target)
    sdram, traffic = bench.spec.sdram, bench.traffic(w.MDMA1_0)
    openings = traffic.page_misses * sdram.nRCD + traffic.page_conflicts * (sdram.nRAS + sdram.nRP)
    refreshes = bench.bus.words[w.REFRESHES] * (sdram.refresh_sclk + sdram.nCL)
    peak = int(words * peak_word_sclk)
    assert peak - 4 <= took <= peak + openings + refreshes + 12 * sdram.nCL
    if SDRAM not in {source, target}:
        assert took == peak


def test_the_share_of_refresh() -> None:
    """11 cycles in 1875 are gone, and each refresh has the page opened again."""
    usual, rare = Bench(), Bench()
    sdram = usual.spec.sdram
    rare.bus.words[w.NEXT_REFRESH] = w.NEVER
    took = stream(usual, L1, SDRAM, rounds=40)
    lost = took - stream(rare, L1, SDRAM, rounds=40)
    refreshes = usual.bus.words[w.REFRESHES]
    startups = 40 * usual.spec.chip.dma.startup_sclk
    assert refreshes == (took + startups) // 1875
    assert sdram.refresh_sclk == 11
    # each waits for the words written last and opens its page again; some are over before a start-up is, or fall
    # where a page is opened anyway
    assert 0.95 * refreshes * 13 <= lost < (refreshes + 1) * (sdram.nWR + sdram.refresh_sclk + sdram.nRCD)


# ---- Beside another stream


def both(bench: Bench, first: tuple[Row, Row], second: tuple[Row, Row]) -> list[int]:
    """Copy two rows by the two streams of a controller; return when each was done, in SCLK."""
    streams = bench.new_stream(w.MDMA1_0), bench.new_stream(w.MDMA1_1)
    ends = bench.ends(streams[0].copy(*first, 0), streams[1].copy(*second, 0))
    return [each // bench.sclk(1) for each in ends]


def outward(bench: Bench, targets: tuple[int, int], nbytes: int = 2048) -> list[int]:
    """Copy from L1 to two places in SDRAM at a time."""
    sources = bench.row(L1, nbytes), bench.row(L1_B, nbytes)
    rows = [bench.row(each, nbytes) for each in targets]
    return both(bench, (sources[0], rows[0]), (sources[1], rows[1]))


def test_the_first_stream_comes_first() -> None:
    """It is done as if it were alone; the other one gets what is left, here nothing before that."""
    bench = Bench()
    alone = write_sclk(bench, 2048)
    assert outward(bench, (SDRAM, OTHER_BANK)) == [alone, alone + bench.spec.sdram.nRCD + 512]


def test_a_stream_that_reads_leaves_its_pauses_to_the_other() -> None:
    """Words of the second stream go where the first one pauses; turning the bus costs that one little."""
    bench = Bench()
    reading = bench.row(SDRAM, 2048), bench.row(L1, 2048)
    writing = bench.row(L1_B, 2048), bench.row(OTHER_BANK, 2048)
    read_end, write_end = both(bench, reading, writing)
    sdram = bench.spec.sdram
    assert 15 + 1024 <= write_end < read_end + sdram.nRCD + 512
    # of each pause of 4 cycles, the write uses some and delays the read by less than a burst
    pauses = pauses_sclk(bench, 512) // 4
    assert read_end - read_sclk(bench, 2048) <= pauses * (sdram.nCL + sdram.turn_round_sclk) + sdram.nRCD


@pytest.mark.parametrize(("target", "word_sclk"), [(OTHER_BANK, 1), (OTHER_PAGE, 9)])
def test_two_streams_in_one_bank_close_each_other_s_page(target: int, word_sclk: int) -> None:
    """Word by word in turn: a cycle each in two banks; in one bank tRC, which is tRAS + tRP, for each."""
    bench = Bench(mdma_period_transfers=1)
    sdram = bench.spec.sdram
    if target == OTHER_PAGE:
        assert word_sclk == sdram.nRAS + sdram.nRP
    ends = outward(bench, (SDRAM, target), 640)
    assert abs(max(ends) - (15 + 320 * word_sclk)) <= 15 + sdram.refresh_sclk
    assert max(ends) - min(ends) <= word_sclk


def test_round_robin_of_one_word() -> None:
    """With MDMA_ROUND_ROBIN_PERIOD 1 both streams are done at about the same time."""
    first, second = outward(Bench(mdma_period_transfers=1), (SDRAM, OTHER_BANK))
    assert abs(first - second) <= 1


@pytest.mark.parametrize("period", [2, 8, 31])
def test_round_robin_gives_both_streams_a_period(period: int) -> None:
    """Each moves so many words before the other has its turn, so they are done a period apart (HRM, 5-54)."""
    first, second = outward(Bench(mdma_period_transfers=period), (SDRAM, OTHER_BANK))
    assert abs(first - second) <= period + 1


# ---- Whatever is copied


@given(
    st.lists(
        st.tuples(st.sampled_from([SDRAM, OTHER_BANK, L1, L2]), st.integers(1, 700), st.integers(0, 5000)),
        max_size=12,
    )
)
def test_copies_end_in_order_and_keep_every_byte(copies: list[tuple[int, int, int]]) -> None:
    """Whatever is asked for and when: first come, first served, no faster than the closed form, nothing lost."""
    bench = Bench()
    rows = [
        (bench.row(address, nbytes), bench.row(L1_B + 1024 * number, nbytes))
        for number, (address, nbytes, _) in enumerate(copies)
    ]
    asked = [bench.stream.copy(*pair, at) for pair, (_, _, at) in zip(rows, copies, strict=True)]
    free_at = 0
    for (source, target), (_, nbytes, at), end in zip(rows, copies, bench.ends(*asked), strict=True):
        assert end >= max(free_at, at) + bench.sclk(bench.spec.chip.dma.startup_sclk + ceil(nbytes / 4))
        assert np.array_equal(source.array, target.array)
        free_at = end
    from_sdram = [nbytes for address, nbytes, _ in copies if address in {SDRAM, OTHER_BANK}]
    assert bench.traffic(w.MDMA1_0).read_bytes == sum(from_sdram)
