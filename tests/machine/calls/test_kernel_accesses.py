"""Kernels that reach into L2 and SDRAM themselves, on a whole board: where their stalls are charged, and to what."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from typing import Any

import pytest

from bfsim.api import Core, Frame
from bfsim.chip.boards import BOARDS, board_named
from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError
from bfsim.trace import BoardRecord, StallReason
from tests.machine.kernels import fill, spin, total
from tests.machine.rig import WORDS, Play, every_frame, load, noise, run, stage_of

each_board = pytest.mark.parametrize(
    "name", [name for name, each in BOARDS.items() if len(each.chip.cores) == 2]
)


def reading(buffer: str, times: int = 1) -> Any:
    """Make a main loop that reads every word of `buffer` in one kernel call, so many times in a frame."""

    def read(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)  # until the last lines of both cameras are off the bus
        with core.stage("Work"):
            for _ in range(times):
                yield core.run(total, core.array(buffer))

    return every_frame(read)


def stalls(outcome: BoardRecord, core: str = "A") -> Mapping[StallReason, int]:
    """Stalls of the stage in the last frame."""
    return stage_of(outcome.frames[-1], "Work", core).stall_cclk


def read_cclk(board: BoardSpec, opening_sclk: int = 0) -> int:
    """Cycles that a read of an idle SDRAM stalls, without its own issue cycle."""
    sclk = board.chip.external.core_sync_sclk + board.sdram.nCL + opening_sclk
    return ceil(sclk * board.clocks.sclk_ticks / board.clocks.cclk_ticks) - 1


def test_l2_reads_stall_for_the_latency() -> None:
    """Every read of L2 costs 9 CCLK, one of which is its issue; nothing else stalls."""
    assert stalls(run(reading("in_l2"))) == {StallReason.L2_LATENCY: WORDS * 8}


def test_l2_writes_are_posted() -> None:
    """A store to L2 goes its way while the core goes on, if there is time enough between two of them."""

    def write(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            yield core.run(fill, core.array("in_l2"), 7)

    outcome = run(every_frame(write))
    assert stalls(outcome) == {}
    (traffic,) = [each for each in outcome.traffic if each.memory == "L2"]
    assert (traffic.master, traffic.read_bytes, traffic.written_bytes) == ("core A", 0, 4 * WORDS)


@each_board
def test_sdram_reads_stall_by_page(name: str) -> None:
    """1024 words in two or three pages: all hits but where a page begins or a refresh has closed it."""
    board = board_named(name)
    machine = load(reading("in_sdram"), board=name)
    (row,) = machine._buffers.of["A"]["in_sdram"]
    page_bytes = board.sdram.page_bytes
    pages = (row.offset + row.nbytes - 1) // page_bytes - row.offset // page_bytes + 1
    outcome = machine.run(iter(noise(1)))
    found = dict(stalls(outcome))
    (traffic,) = [each for each in outcome.traffic if (each.memory, each.master) == ("SDRAM", "core A")]
    assert traffic.page_hits + traffic.page_misses + traffic.page_conflicts == WORDS
    assert traffic.page_conflicts < pages <= traffic.page_conflicts + traffic.page_misses
    assert found.pop(StallReason.SDRAM_PAGE_HIT) == traffic.page_hits * read_cclk(board)
    misses = traffic.page_misses * read_cclk(board, board.sdram.miss_sclk)
    met = found.pop(StallReason.SDRAM_PAGE_MISS)
    assert (
        misses <= met <= misses + traffic.page_misses
    )  # parts of a cycle that waits for refreshes leave over
    conflicts = traffic.page_conflicts * read_cclk(board, board.sdram.conflict_sclk)
    assert found.pop(StallReason.SDRAM_PAGE_CONFLICT, 0) == conflicts
    refresh_cclk = board.sdram.refresh_sclk * board.clocks.sclk_ticks // board.clocks.cclk_ticks
    assert found.pop(StallReason.SDRAM_REFRESH) <= traffic.page_misses * refresh_cclk
    # where a wait is no whole number of CCLK, what is left of it counts as arbitration: a cycle each
    assert found.pop(StallReason.EBIU_ARBITRATION, 0) <= traffic.page_misses
    assert found == {}


def test_two_cores_at_the_bus_wait_for_each_other() -> None:
    """Both read SDRAM all the time, from banks of their own: each read waits for a word of the other's at most."""
    alone = run(reading("in_sdram", times=5))
    crowded = run(reading("in_sdram", times=5), reading("in_sdram", times=5))
    assert StallReason.EBIU_ARBITRATION not in stalls(alone)
    waits = [stalls(crowded, core).get(StallReason.EBIU_ARBITRATION, 0) for core in ("A", "B")]
    assert 0 < sum(waits) <= 2 * 5 * WORDS * 5


def test_writes_to_sdram_go_no_faster_than_the_bus() -> None:
    """Posted, a store costs the core one cycle; but many of them in a row must leave over the bus, an SCLK each."""

    def write(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 100_000)
        with core.stage("Work"):
            for _ in range(10):
                yield core.run(fill, core.array("in_sdram"), 7)

    cost = stage_of(run(every_frame(write)).frames[0], "Work")
    depth = board_named("cm-bf561").chip.external.store_buffer
    assert cost.elapsed_cclk >= (10 * WORDS - depth) * 5
    assert cost.elapsed_cclk <= (10 * WORDS * (1 + 13 / 1875) + 10 * 3 * 8) * 5
    assert set(cost.stall_cclk) == {StallReason.STORE_BUFFER}


def test_words_are_counted_per_master() -> None:
    """Every access moves a 32-bit word on the bus; pages are counted by class."""
    outcome = run(reading("in_sdram"), reading("in_sdram"))
    for core in ("A", "B"):
        (traffic,) = [
            each for each in outcome.traffic if (each.memory, each.master) == ("SDRAM", f"core {core}")
        ]
        assert (traffic.read_bytes, traffic.written_bytes) == (4 * WORDS, 0)
        assert traffic.page_hits + traffic.page_misses + traffic.page_conflicts == WORDS


def test_another_core_s_l1_is_out_of_reach() -> None:
    """Rows of the other core cannot be had by name; handed over behind its back, they are refused all the same."""
    stolen = []

    def give(core: Core) -> Play:
        stolen.append(core.array("words"))
        yield from ()

    def take(core: Core) -> Play:
        yield core.run(total, stolen[0])

    with pytest.raises(FirmwareError, match="core B cannot load or store words, which is in COREA_L1_DATA_A"):
        run(give, take)
