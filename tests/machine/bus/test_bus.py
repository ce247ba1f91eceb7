"""Who has the bus: DMA before the cores or behind them, urgent requests, traffic control, and all of them at once."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from bfsim.chip.boards import CM_BF561
from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError
from bfsim.kernel.calls.access_log import LOAD, STORE
from bfsim.machine.bus import state as w
from bfsim.machine.bus.transfer_plans import Pace, Transfer, Walk
from bfsim.trace import StallReason
from tests.machine.bench import Bench, Call

SDRAM, OTHER_PAGE, OTHER_BANK, THIRD_BANK = 0x0000_0000, 0x0000_1000, 0x0080_0000, 0x0100_0000
L1, L1_B, L2 = 0xFF80_0000, 0xFF90_0000, 0xFEB0_0000
A, B = 0, 1
READS = 40
WORD_TICKS = 100
LONG = 10_000


def without_pauses(board: BoardSpec = CM_BF561) -> BoardSpec:
    """Return the board with memory DMA that reads a word in every cycle."""
    return replace(board, chip=replace(board.chip, dma=replace(board.chip.dma, read_word_sclk=Fraction(1))))


def read(bench: Bench, core: int = A, reads: int = READS) -> Call:
    """Let a core read words of the third bank one after the other; its page is open after the first."""
    return bench.call(
        core,
        [(cycle, LOAD, THIRD_BANK + 4 * cycle) for cycle in range(reads)],
        begin=bench.sclk(15),
        cclk=reads,
    )


def write_all(bench: Bench, nbytes: int = 16 * 1024) -> Transfer:
    """Saturate the bus: copy from L1 to SDRAM, a word in every cycle."""
    return bench.stream.copy(bench.row(L1, nbytes), bench.row(SDRAM, nbytes), 0)


# ---- DMA and cores


def test_dma_over_core_keeps_the_core_waiting_for_all_of_a_copy() -> None:
    """CDPRIO set: while the copy has a word to write in every cycle the core reads nothing."""
    bench = Bench(dma_over_core=True)
    copy, call = write_all(bench, 4096), read(bench)
    (end,) = bench.ends(copy)
    assert end == bench.sclk(
        15 + 1024 + 2 * 2 + 2 + 2
    )  # two pages: a miss, and tWR, tRP and tRCD for the next
    assert call.end is not None
    assert call.end > end
    waited = call.stalls[StallReason.EBIU_ARBITRATION] * bench.cclk(1)
    assert abs(waited - (end - bench.sclk(15))) <= bench.sclk(1)


def test_core_first_lets_the_core_read_as_if_it_were_alone() -> None:
    """CDPRIO clear: the bus is free again when a read comes to it; the copy loses what each read needs."""
    crowded, alone = Bench(dma_over_core=False), Bench(dma_over_core=False)
    copy, call, undisturbed = write_all(crowded, 4096), read(crowded), read(alone)
    alone.play()
    (end,) = crowded.ends(copy)
    assert call.stalls == undisturbed.stalls
    sdram = crowded.spec.sdram
    # its cycle, and the latency and the turn-round before the next word is written
    each_sclk = 1 + sdram.nCL + sdram.turn_round_sclk
    assert end == crowded.sclk(15 + 1024 + 8 + READS * each_sclk)


def test_a_copy_that_reads_lets_the_core_in_when_it_pauses() -> None:
    """DMA first, but every 40 words it pauses for 4 cycles: no read waits for longer than that."""
    bench = Bench(dma_over_core=True)
    bench.stream.copy(bench.row(SDRAM, 32 * 1024), bench.row(L1, 32 * 1024), 0)
    call = read(bench)
    bench.play()
    between_pauses = 44 + bench.spec.sdram.conflict_sclk + bench.spec.sdram.refresh_sclk
    assert call.stalls[StallReason.EBIU_ARBITRATION] <= READS * between_pauses * 5
    assert call.stalls[StallReason.EBIU_ARBITRATION] >= READS * 5  # its pauses are not for the core alone


@pytest.mark.parametrize("dma_over_core", [True, False])
def test_stores_wait_in_their_buffer_as_loads_do(dma_over_core: bool) -> None:
    """More of them than the buffer holds: behind the copy with CDPRIO, before it without."""
    bench = Bench(dma_over_core=dma_over_core)
    copy = write_all(bench, 4096)
    call = bench.call(
        A, [(0, STORE, THIRD_BANK + 4 * number) for number in range(10)], begin=bench.sclk(16), cclk=10
    )
    (end,) = bench.ends(copy)
    assert call.end is not None
    assert (call.end > end) == dma_over_core


def test_a_core_at_l2_never_meets_the_bus() -> None:
    """Whatever goes on at the SDRAM, and whoever is first there."""
    bench = Bench(dma_over_core=True)
    write_all(bench)
    call = bench.call(A, [(cycle, LOAD, L2) for cycle in range(READS)], begin=bench.sclk(20), cclk=READS)
    bench.play()
    assert call.stalls == {StallReason.L2_LATENCY: READS * 8}


# ---- Devices


def receive(bench: Bench, nbytes: int = 400, master: int = w.PPI0, word_ticks: int = WORD_TICKS) -> Transfer:
    """Let a camera write a word every 20 cycles to the second bank."""
    words = nbytes // 4
    target = bench.row(OTHER_BANK, nbytes)
    plan = bench.bus.planner.receive(
        master,
        Walk(bench.memories.outside, words, 4, 4),
        Walk(target.offset, words, 4, 4),
        words,
        element_bytes=4,
        pace=Pace(0, words, Fraction(word_ticks), Fraction(words * word_ticks)),
    )
    return bench.bus.post(plan)


def written_at(bench: Bench, ticks: int) -> int:
    """Play up to tick `ticks`, itself excluded; return how many words of the picture were written."""
    bench.bus.play_until(ticks)
    return bench.traffic(w.PPI0).written_bytes // 4


def test_the_lower_channel_comes_first() -> None:
    """The picture's first word is there at cycle 20 and the copy is not through: the camera has the next cycle."""
    bench = Bench(outside_nbytes=4096)
    write_all(bench)
    receive(bench)
    assert written_at(bench, WORD_TICKS) == 0
    assert written_at(bench, WORD_TICKS + bench.sclk(1)) == 1


def test_an_urgent_camera_comes_before_the_lower_channel() -> None:
    """A word comes in every cycle, and from the lower channel in every second one: each waits until half of its FIFO is full.

    Without that rule the lower channel would have every second cycle, and fourteen words of the other one would wait.
    """
    bench = Bench(outside_nbytes=4096)
    receive(bench, master=w.PPI0, word_ticks=bench.sclk(2))
    receive(bench, master=w.PPI1, word_ticks=bench.sclk(1))
    bench.bus.play_until(bench.sclk(25))
    lower, upper = (bench.traffic(each).written_bytes // 4 for each in (w.PPI0, w.PPI1))
    assert 12 - lower == 12 // 2
    assert 24 - upper == 12 // 2 + 2  # one has just come, and one comes while the other camera has the bus


def turned_round(bench: Bench, ticks: int) -> int:
    """Return when the word behind the first can be written, if that one is granted at `ticks`, right behind a read."""
    sdram = bench.spec.sdram
    return ticks + bench.sclk(sdram.nCL + sdram.turn_round_sclk + 1)


def test_a_request_against_the_direction_waits_until_it_is_urgent() -> None:
    """DEB_TRAFFIC_PERIOD prefers the reads of a copy; the camera gets the bus when half of its FIFO is full.

    Then writes are preferred: all that waits goes at once.
    """
    bench = Bench(without_pauses(), deb_period_transfers=LONG, outside_nbytes=4096)
    bench.bus.words[w.LAST_WRITE] = 1  # the copy's first word begins a period
    bench.stream.copy(bench.row(SDRAM, 32 * 1024), bench.row(L1, 32 * 1024), 0)
    transfer = receive(bench)
    half = (12 // 2 + 1) * WORD_TICKS  # six wait, and the seventh comes
    assert written_at(bench, half) == 0
    assert written_at(bench, half + bench.sclk(1)) == 1
    assert written_at(bench, turned_round(bench, half)) == 1
    assert written_at(bench, turned_round(bench, half) + bench.sclk(6)) == 7
    bench.play()
    assert bench.bus.words[w.TRANSFERS_AT + transfer.place * w.TRANSFER_WORDS + w.LOST] == 0


def test_a_period_ends() -> None:
    """After so many words of a direction the camera has its turn, as it would without the rule: five words wait."""
    bench = Bench(without_pauses(), deb_period_transfers=85, outside_nbytes=4096)
    bench.bus.words[w.LAST_WRITE] = 1
    sdram = bench.spec.sdram
    bench.stream.copy(bench.row(SDRAM, 32 * 1024), bench.row(L1, 32 * 1024), 0)
    receive(bench)
    over = bench.sclk(15 + sdram.nRCD + 1 + 85)
    assert over // WORD_TICKS == 5
    assert written_at(bench, over) == 0
    assert written_at(bench, over + bench.sclk(1)) == 1
    assert written_at(bench, turned_round(bench, over)) == 1
    assert written_at(bench, turned_round(bench, over) + bench.sclk(4)) == 5


def opposite_streams(bench: Bench, nbytes: int = 4096) -> tuple[int, int]:
    """One stream reads SDRAM and one writes it; return when each is done, in SCLK."""
    reads, writes = bench.new_stream(w.MDMA1_0), bench.new_stream(w.MDMA1_1)
    ends = bench.ends(
        reads.copy(bench.row(SDRAM, nbytes), bench.row(L1, nbytes), 0),
        writes.copy(bench.row(L1_B, nbytes), bench.row(OTHER_BANK, nbytes), 0),
    )
    return ends[0] // bench.sclk(1), ends[1] // bench.sclk(1)


@pytest.mark.parametrize("period", [1, 4, 15])
def test_traffic_control_keeps_the_bus_in_its_direction(period: int) -> None:
    """The stream that writes has the bus when the other one pauses, every 40 words, and keeps it for a period."""
    plain, controlled = opposite_streams(Bench()), opposite_streams(Bench(deb_period_transfers=period))
    pauses = (1024 - 1) // 40
    assert controlled == (plain[0] + pauses * period, plain[1])


def test_what_needs_no_bus_has_no_part_in_traffic_control() -> None:
    """A core that reads L2 changes nothing at the bus."""
    alone = opposite_streams(Bench(deb_period_transfers=15))
    bench = Bench(deb_period_transfers=15)
    bench.call(A, [(8 * cycle, LOAD, L2) for cycle in range(1500)], cclk=12_000)
    assert opposite_streams(bench) == alone


def send(bench: Bench, words: int = 40) -> tuple[Transfer, bytes]:
    """Let a link take 16 bits every 100 ticks from the second bank; return what it does and the bytes it should send."""
    source = bench.row(OTHER_BANK, 2 * words)
    plan = bench.bus.planner.send(
        w.SPI,
        Walk(source.offset, words, 2, 2),
        Walk(bench.memories.outside, words, 2, 2),
        words,
        element_bytes=2,
        pace=Pace(0, words, Fraction(WORD_TICKS), Fraction(words * WORD_TICKS)),
    )
    return bench.bus.post(plan), source.array.tobytes()


def test_a_link_takes_its_words_in_time() -> None:
    """The link begins with the first words in its FIFO of four, which is filled again whenever half of it is empty."""
    bench = Bench(outside_nbytes=4096)
    transfer, expected = send(bench)
    first = bench.sclk(bench.spec.sdram.nRCD + bench.spec.sdram.nCL + 2)  # two words: half a FIFO
    bench.bus.play_until(first + 2 * WORD_TICKS)
    assert bench.traffic(w.SPI).read_bytes == 8
    bench.bus.play_until(first + 2 * WORD_TICKS + 1)
    assert bench.traffic(w.SPI).read_bytes == 12
    assert bench.ends(transfer) == [first + 40 * WORD_TICKS]
    assert bench.memories.bytes_from(bench.memories.outside, 80).tobytes() == expected


def test_a_link_is_urgent_before_it_runs_dry() -> None:
    """Against the direction that DEB_TRAFFIC_PERIOD prefers, it has the bus by the time its fifth word is due."""
    bench = Bench(deb_period_transfers=LONG, outside_nbytes=4096)
    write_all(bench)
    send(bench)
    bench.bus.play_until(5 * WORD_TICKS)
    assert bench.traffic(w.SPI).read_bytes == 16


def test_a_link_that_runs_dry_holds_its_clock() -> None:
    """The bus is blocked for 20 of its words, and the FIFO holds four: the others come 16 words later, and some SCLK."""
    bench = Bench(outside_nbytes=4096)
    transfer, _ = send(bench)
    bench.bus.play_until(WORD_TICKS)
    bench.bus.words[w.COMMAND_FREE] = 20 * WORD_TICKS
    bench.play()
    late = bench.ends(transfer)[0] - (40 + 16) * WORD_TICKS
    assert 0 < late <= bench.sclk(12)


# ---- Everything else


def test_a_transfer_that_is_done_is_known_without_waiting() -> None:
    """Nobody knows the end before the last word was granted; from then on everybody does."""
    bench = Bench()
    transfer = write_all(bench, 640)
    granted = bench.sclk(15 + 2 + 160 - 1)
    bench.bus.play_until(granted)
    assert transfer.end is None
    bench.bus.play_until(granted + 1)
    assert transfer.end == granted + bench.sclk(1)


def test_an_event_comes_at_the_end_and_not_before() -> None:
    """Others that wait for later ends do not disturb it."""
    bench = Bench()
    first, second = write_all(bench, 640), write_all(bench, 640)
    seen = []
    for transfer in (second, first):
        event = bench.bus.when_done(transfer)
        assert event.callbacks is not None
        event.callbacks.append(lambda _event: seen.append(bench.env.tick))
    bench.env.run()
    assert seen == [first.end, second.end]


def test_too_many_transfers_are_refused() -> None:
    """Whoever never waits for the DMA is told so."""
    bench = Bench()
    for _ in range(w.MAX_TRANSFERS):
        write_all(bench, 4)
    with pytest.raises(FirmwareError, match="DMA must have at most 256 transfers to do at a time"):
        write_all(bench, 4)
    bench.play()
    write_all(bench, 4)


def test_transfers_that_are_done_make_room() -> None:
    """Long after each is over there is a next one; nobody has asked for any of them."""
    bench = Bench()
    for number in range(w.MAX_TRANSFERS + 1):
        bench.env.run(until=LONG * (number + 1))
        write_all(bench, 4)
