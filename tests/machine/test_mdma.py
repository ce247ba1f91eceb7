"""Memory DMA: one stream copies rows one after the other while the cores do something else."""

from __future__ import annotations

from math import ceil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.boards import BOARDS
from bfsim.machine.mdma import Transfer
from tests.machine.rig import Bench

SDRAM, OTHER_BANK, L1, L1_B, L2 = 0x0000_1000, 0x0080_0000, 0xFF80_0000, 0xFF90_0000, 0xFEB0_0000
each_board = pytest.mark.parametrize("board", BOARDS)


def read_sclk(bench: Bench, words: int) -> int:
    """Cycles to bring `words` words from a closed bank: start-up, page, latency, words."""
    chip, sdram = bench.spec.chip, bench.spec.sdram
    return chip.mdma_startup_sclk + sdram.nRCD + sdram.nCL + ceil(words * chip.mdma_read_sclk)


def ends(bench: Bench, *transfers: Transfer) -> list[int]:
    """Run the simulation to its end and return when each transfer was done."""
    bench.advance()
    return [each.end for each in transfers if each.end is not None]


@each_board
@pytest.mark.parametrize("nbytes", [1, 4, 6, 640, 1280])
def test_a_copy_from_sdram_takes_start_up_page_latency_and_words(board: str, nbytes: int) -> None:
    """The closed form, in whole SCLK cycles, for rows that are no multiple of a word, too; and every byte is there."""
    bench = Bench(board)
    source, target = bench.row(SDRAM, nbytes), bench.row(L1, nbytes)
    copy = bench.stream.copy(source, target, 0)
    assert ends(bench, copy) == [bench.sclk(read_sclk(bench, ceil(nbytes / 4)))]
    assert np.array_equal(source.array, target.array)


def test_a_copy_to_sdram_has_no_latency() -> None:
    """160 words to a closed bank."""
    bench = Bench()
    chip, sdram = bench.spec.chip, bench.spec.sdram
    copy = bench.stream.copy(bench.row(L1, 640), bench.row(SDRAM, 640), 0)
    assert ends(bench, copy) == [bench.sclk(chip.mdma_startup_sclk + sdram.nRCD + 160)]


def test_a_copy_within_sdram_reads_and_then_writes() -> None:
    """Both bursts are on the one bus; what comes in goes out."""
    bench = Bench()
    copy = bench.stream.copy(bench.row(SDRAM, 640), bench.row(OTHER_BANK, 640), 0)
    assert ends(bench, copy) == [bench.sclk(read_sclk(bench, 160) + bench.spec.sdram.nRCD + 160)]
    assert bench.account.read_bytes == bench.account.written_bytes == 640


@pytest.mark.parametrize("address", [L1_B, L2])
def test_a_copy_on_the_chip_leaves_the_bus_alone(address: int) -> None:
    """A word per SCLK after the start-up, and nothing at the SDRAM."""
    bench = Bench()
    copy = bench.stream.copy(bench.row(L1, 642), bench.row(address, 642), 0)
    assert ends(bench, copy) == [bench.sclk(bench.spec.chip.mdma_startup_sclk + 161)]
    assert bench.account.busy_ticks == 0
    assert bench.ebiu.hold(0, 1) == 0


def test_copies_of_a_stream_follow_each_other() -> None:
    """The next one starts up when the one before is done; its page is open by then."""
    bench = Bench()
    source, target = bench.row(SDRAM, 640), bench.row(L1, 640)
    first, second = (bench.stream.copy(source, target, 0) for _ in range(2))
    duration = read_sclk(bench, 160)
    assert ends(bench, first, second) == [
        bench.sclk(duration),
        bench.sclk(2 * duration - bench.spec.sdram.nRCD),
    ]


def test_a_later_copy_does_not_overtake() -> None:
    """A copy that may start at once still waits for the one asked for before it, which may not."""
    bench = Bench()
    source, target = bench.row(SDRAM, 640), bench.row(L1, 640)
    first = bench.stream.copy(source, target, 50_000)
    second = bench.stream.copy(source, target, 0)
    duration = read_sclk(bench, 160)
    assert ends(bench, first, second) == [
        50_000 + bench.sclk(duration),
        50_000 + bench.sclk(2 * duration - bench.spec.sdram.nRCD),
    ]


@pytest.mark.parametrize("at", [0, 999, 1000, 1001])
def test_a_copy_starts_at_its_time_and_never_in_the_past(at: int) -> None:
    """Asked for at tick 1000: earlier means now, later means then, and the bus takes it at the next SCLK edge."""
    bench = Bench()
    bench.advance(1000)
    copy = bench.stream.copy(bench.row(SDRAM, 640), bench.row(L1, 640), at)
    begin = -(-max(at, 1000) // 5) * 5
    assert ends(bench, copy) == [begin + bench.sclk(read_sclk(bench, 160))]


def test_bytes_are_read_when_the_copy_starts() -> None:
    """What is written to the source before that moment arrives; what is written after it does not."""
    bench = Bench()
    source, target = bench.row(SDRAM, 4), bench.row(L1, 4)
    bench.stream.copy(source, target, 100)
    source.array[:] = 1
    bench.advance(100)
    source.array[:] = 2
    bench.advance()
    assert target.array.tolist() == [1, 1, 1, 1]


def test_two_streams_share_the_bus() -> None:
    """Both start up together; the second one's burst waits for the first one's, and nobody else does."""
    bench = Bench()
    other = bench.new_stream()
    first = bench.stream.copy(bench.row(SDRAM, 640), bench.row(L1, 640), 0)
    second = other.copy(bench.row(OTHER_BANK, 640), bench.row(L1_B, 640), 0)
    duration = read_sclk(bench, 160)
    burst = duration - bench.spec.chip.mdma_startup_sclk
    assert ends(bench, first, second) == [bench.sclk(duration), bench.sclk(duration + burst)]


@given(
    st.lists(
        st.tuples(st.sampled_from([SDRAM, OTHER_BANK, L1, L2]), st.integers(1, 700), st.integers(0, 5000)),
        max_size=12,
    )
)
def test_copies_end_in_order_and_keep_every_byte(copies: list[tuple[int, int, int]]) -> None:
    """Whatever is asked for and when: first come, first served, no faster than the closed form, nothing lost."""
    bench = Bench()
    chip = bench.spec.chip
    asked = [
        bench.stream.copy(bench.row(address, nbytes), bench.row(L1_B + 1024 * number, nbytes), at)
        for number, (address, nbytes, at) in enumerate(copies)
    ]
    free_at = 0
    for transfer, end in zip(asked, ends(bench, *asked), strict=True):
        least_sclk = chip.mdma_startup_sclk + transfer.source.words
        assert end >= max(free_at, transfer.at) + bench.sclk(least_sclk)
        assert np.array_equal(transfer.source.array, transfer.destination.array)
        free_at = end
    assert bench.account.read_bytes == sum(
        nbytes for address, nbytes, _ in copies if address in (SDRAM, OTHER_BANK)
    )


def test_a_faster_bus_never_slows_a_lone_copy() -> None:
    """Time from first to last, in seconds: 133 1/3 MHz against 120 MHz."""
    seconds = []
    for board in ("cm-bf561", "cm-bf561-ratings"):
        bench = Bench(board)
        copy = bench.stream.copy(bench.row(SDRAM, 640), bench.row(L1, 640), 0)
        (end,) = ends(bench, copy)
        seconds.append(end / bench.spec.clocks.tick_hz)
    assert seconds[1] < seconds[0]
