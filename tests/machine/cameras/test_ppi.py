"""PPI and camera: words arrive at the sensor's pace, wait in a FIFO for the bus, and are lost when that is full."""

from __future__ import annotations

from fractions import Fraction
from math import ceil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.boards import BOARDS
from bfsim.errors import ConfigError
from bfsim.machine.buffers import FrameSize
from bfsim.machine.bus import state as w
from bfsim.machine.bus.transfer_plans import Pace, Transfer, Walk
from bfsim.machine.cameras.ppi import Ppi
from bfsim.machine.memories import Row
from tests.machine.bench import Bench
from tests.machine.rig import STEADY

HEIGHT, WIDTH = 8, 16
SDRAM, OTHER_BANK, L1 = 0x0000_1000, 0x0080_0000, 0xFF80_0000
KIB = 1024
OUTSIDE = 16 * KIB
WORD_TICKS = 100  # 24 MHz of bytes at 600/120: 20 SCLK
FIFO_WORDS = 12  # 4 of the DMA, 8 of the PPI


def new_ppi(bench: Bench, width_px: int = WIDTH, height_px: int = HEIGHT) -> Ppi:
    """Return a PPI with a camera of 16x8 pixels on it, or of others."""
    return Ppi(
        bench.spec,
        FrameSize(width_px, height_px),
        STEADY,
        bench.bus,
        bench.memories,
        number=0,
        outside=bench.memories.outside,
        interrupt=lambda source: None,
    )


def picture_of(bench: Bench) -> tuple[np.ndarray, list[Row]]:
    """Return a picture and the empty rows for it, one behind the other."""
    picture = np.arange(1, HEIGHT * 2 * WIDTH + 1).astype(np.uint8).reshape(HEIGHT, 2 * WIDTH)
    rows = [bench.row(SDRAM + number * 2 * WIDTH, 2 * WIDTH) for number in range(HEIGHT)]
    for row in rows:
        row.array[:] = 0
    return picture, rows


def test_pictures_that_come_too_fast_are_told_of_their_size() -> None:
    """The clock that they would need is not what a user gives."""
    with pytest.raises(
        ConfigError,
        match=r"pictures of 1282x1110 are too large for a camera that sends 30 of them a second: PPI_CLK must be at most .*; "
        "`bfsim record import --resize` makes smaller ones",
    ):
        new_ppi(Bench(outside_nbytes=OUTSIDE), 1282, 1110)


@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize("start", [0, 12_345])
def test_a_line_is_in_memory_at_the_end_of_its_pixels(board: str, start: int) -> None:
    """At the SCLK edge behind its last word the bus takes that; until then some of the line is missing."""
    bench = Bench(board, outside_nbytes=OUTSIDE)
    mode, sclk = bench.spec.sensor.mode(WIDTH, HEIGHT), bench.sclk(1)
    clock_ticks = bench.spec.clocks.tick_hz / mode.ppi_clk_hz
    picture, rows = picture_of(bench)
    new_ppi(bench).receive(picture, rows, start)
    for number, row in enumerate(rows):
        last = start + ceil((number * mode.line_clocks + mode.active_clocks) * clock_ticks)
        granted = ceil(last / sclk) * sclk
        bench.bus.play_until(granted)
        assert not np.array_equal(row.array, picture[number])
        bench.bus.play_until(granted + 1)
        assert np.array_equal(row.array, picture[number])


def test_the_event_is_at_the_end_of_the_last_word() -> None:
    """The closed bank is opened and the last word written."""
    bench = Bench(outside_nbytes=OUTSIDE)
    ppi, (picture, rows) = new_ppi(bench), picture_of(bench)
    end = ppi.receive(picture, rows, 0)
    bench.env.run(until=end)
    last = ceil(ppi.picture_ticks / bench.sclk(1)) * bench.sclk(1)
    assert bench.env.tick == last + bench.sclk(bench.spec.sdram.nRCD + 1)


def test_a_picture_is_shorter_than_a_frame_by_its_blanking() -> None:
    """30 pictures a second, 8 lines of 9 each: the ninth is blank, and so is the end of each line."""
    bench = Bench(outside_nbytes=OUTSIDE)
    ppi, mode = new_ppi(bench), bench.spec.sensor.mode(WIDTH, HEIGHT)
    assert mode.frame_lines == 9
    assert ppi.frame_ticks == bench.spec.clocks.tick_hz / 30
    blank_ticks = Fraction(mode.line_clocks - mode.active_clocks, mode.frame_clocks) * ppi.frame_ticks
    assert ppi.picture_ticks == ceil(Fraction(8, 9) * ppi.frame_ticks - blank_ticks)


def test_lines_use_the_bus_and_are_counted() -> None:
    """Every byte of the picture is written once, in a cycle; refreshes have closed the page since the word before."""
    bench = Bench(outside_nbytes=OUTSIDE)
    picture, rows = picture_of(bench)
    new_ppi(bench).receive(picture, rows, 0)
    bench.play()
    words = HEIGHT * 2 * WIDTH // 4
    traffic = bench.traffic(w.PPI0)
    assert (traffic.read_bytes, traffic.written_bytes) == (0, 4 * words)
    assert (traffic.page_misses, traffic.page_hits) == (words, 0)
    assert traffic.busy == bench.sclk(words * (bench.spec.sdram.nRCD + 1))


# ---- The FIFO


def receive(
    bench: Bench, target: Row, *, word_ticks: Fraction | int = WORD_TICKS, line_words: int = 1000, master: int = w.PPI0
) -> Transfer:  # fmt: skip
    """Let a camera without blanking fill `target` with its noise from tick 0 on."""
    words = target.nbytes // 4
    outside = bench.memories.outside + (master == w.PPI1) * OUTSIDE // 2
    bench.memories.bytes_from(outside, target.nbytes)[:] = target.array
    target.array[:] = 0
    plan = bench.bus.planner.receive(
        master,
        Walk(outside, words, 4, 4),
        Walk(target.offset, words, 4, 4),
        words,
        element_bytes=4,
        pace=Pace(0, line_words, Fraction(word_ticks), line_words * Fraction(word_ticks)),
    )
    return bench.bus.post(plan)


def lost(bench: Bench, transfer: Transfer) -> int:
    """Words that a transfer lost."""
    return bench.bus.words[w.TRANSFERS_AT + transfer.place * w.TRANSFER_WORDS + w.LOST]


def block(bench: Bench, until: int) -> None:
    """Keep everybody from the bus until tick `until`."""
    bench.bus.words[w.COMMAND_FREE] = until
    bench.bus.words[w.NEXT_REFRESH] = w.NEVER


@pytest.mark.parametrize(
    ("blocked_words", "losses"), [(0, 0), (4, 0), (12, 0), (13, 0), (13.05, 1), (14, 1), (30, 17)]
)
def test_a_full_fifo_loses_words(blocked_words: float, losses: int) -> None:
    """The word behind the last that the FIFO holds is lost, unless the bus comes with it."""
    bench = Bench(outside_nbytes=OUTSIDE)
    block(bench, until=int(blocked_words * WORD_TICKS))
    transfer = receive(bench, bench.row(SDRAM, 400))
    bench.play()
    assert lost(bench, transfer) == losses
    assert bench.traffic(w.PPI0).written_bytes == 400 - 4 * losses


def test_the_picture_goes_on_where_the_lost_words_should_be() -> None:
    """All that came later stands that much too early, and the end of the picture is missing."""
    bench = Bench(outside_nbytes=OUTSIDE)
    block(bench, until=30 * WORD_TICKS)
    target = bench.row(SDRAM, 400)
    sent = target.array.view(np.uint32).copy()
    transfer = receive(bench, target)
    (end,) = bench.ends(transfer)
    missing = lost(bench, transfer)
    found = target.array.view(np.uint32)
    assert np.array_equal(found[30 - missing : 100 - missing], sent[30:])
    assert not found[100 - missing :].any()
    assert end >= 100 * WORD_TICKS


def test_what_is_in_the_fifo_is_not_lost() -> None:
    """Of 30 words that came while the bus was blocked the first twelve are kept."""
    bench = Bench(outside_nbytes=OUTSIDE)
    block(bench, until=30 * WORD_TICKS)
    target = bench.row(SDRAM, 400)
    sent = target.array.view(np.uint32).copy()
    receive(bench, target)
    bench.play()
    assert np.array_equal(target.array.view(np.uint32)[:FIFO_WORDS], sent[:FIFO_WORDS])


def test_two_fast_cameras_are_too_much_for_one_bank() -> None:
    """A word in 4 cycles each: two banks take it, one bank that is opened anew for every word does not."""
    losses = {}
    for name, other in (("one bank", SDRAM + 8 * KIB), ("two banks", OTHER_BANK)):
        bench = Bench(outside_nbytes=OUTSIDE)
        transfers = [
            receive(bench, bench.row(address, 4 * KIB), word_ticks=bench.sclk(4), master=master)
            for address, master in ((SDRAM, w.PPI0), (other, w.PPI1))
        ]
        bench.play()
        losses[name] = [lost(bench, each) for each in transfers]
    # from one word to the next tRAS and tRP: 9 cycles, and two of them come in 4
    assert losses["two banks"] == [0, 0]
    assert sum(losses["one bank"]) > 0


def test_a_saturating_copy_does_not_disturb_a_camera() -> None:
    """The PPI comes first: every word is written when it is there, or a word of the copy later."""
    alone, crowded = Bench(outside_nbytes=OUTSIDE), Bench(outside_nbytes=OUTSIDE)
    ends = []
    for bench in (alone, crowded):
        transfer = receive(bench, bench.row(SDRAM, 2 * KIB))
        if bench is crowded:
            copies = [
                bench.stream.copy(bench.row(L1, 8 * KIB), bench.row(OTHER_BANK, 8 * KIB), 0) for _ in range(8)
            ]
            copied = bench.ends(*copies)
            assert copied[-1] > 512 * WORD_TICKS  # it did last as long as the picture
        ends += bench.ends(transfer)
        assert lost(bench, transfer) == 0
    assert 0 <= ends[1] - ends[0] <= bench.sclk(1 + bench.spec.sdram.conflict_sclk)


def test_a_picture_can_come_into_l1() -> None:
    """It needs no bus then, so a blocked one loses nothing."""
    bench = Bench(outside_nbytes=OUTSIDE)
    block(bench, until=200 * WORD_TICKS)
    target = bench.row(L1, 400)
    sent = target.array.copy()
    transfer = receive(bench, target)
    assert bench.ends(transfer) == [100 * WORD_TICKS]
    assert np.array_equal(target.array, sent)
    assert lost(bench, transfer) == 0


@given(
    blocked=st.integers(0, 12_000),
    word_ticks=st.fractions(Fraction(10), Fraction(150), max_denominator=9),
    line_words=st.sampled_from([1, 3, 5, 10, 20, 100]),
)
def test_words_are_written_or_lost(blocked: int, word_ticks: Fraction, line_words: int) -> None:
    """Of 100 words each is one or the other, in any pace; none is written twice, and their order is kept."""
    bench = Bench(outside_nbytes=OUTSIDE)
    block(bench, until=bench.sclk(blocked // bench.sclk(1)))
    target = bench.row(SDRAM, 400)
    target.array.view(np.uint32)[:] = np.arange(1, 101)
    transfer = receive(bench, target, word_ticks=word_ticks, line_words=line_words)
    bench.play()
    found = target.array.view(np.uint32)
    written = found[found > 0].tolist()
    assert len(written) + lost(bench, transfer) == 100
    assert written == sorted(set(written))
    assert bench.traffic(w.PPI0).written_bytes == 4 * len(written)
