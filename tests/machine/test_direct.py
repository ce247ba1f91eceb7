"""Kernels that reach into L2 and SDRAM themselves: what each access stalls, and what a crowded bus adds."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from typing import Any

import pytest

from bfsim.api import Core, Frame, FrameSize
from bfsim.chip.boards import BOARDS, board_named
from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError
from bfsim.machine.board import Outcome
from bfsim.trace import StallReason
from tests.machine.kernels import fill, first, spin, total
from tests.machine.rig import WORDS, Play, every_frame, load, noise, run, stage_of

each_board = pytest.mark.parametrize("name", BOARDS)


def reading(buffer: str, times: int = 1) -> Any:
    """Make a main loop that reads every word of `buffer` in one kernel call, so many times in a frame."""

    def read(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)  # until the last lines of both cameras are off the bus
        with core.stage("Work"):
            for _ in range(times):
                yield core.run(total, core.array(buffer))

    return every_frame(read)


def stalls(outcome: Outcome, core: str = "A") -> Mapping[StallReason, int]:
    """Stalls of the stage in the last frame."""
    return stage_of(outcome.frames[-1], "Work", core).stall_cclk


def read_cclk(board: BoardSpec, opening_sclk: int = 0) -> int:
    """Cycles that a read of SDRAM stalls: its SCLK cycles in CCLK, rounded up, without its own issue cycle."""
    ratio = board.clocks.cclk_hz / board.clocks.sclk_hz
    return ceil((board.chip.core_sdram_read_sclk + opening_sclk) * ratio) - 1


def test_unloaded_reads_of_sdram_in_cycles() -> None:
    """8, 10 and 12 SCLK for hit, miss and conflict: 40, 50, 60 CCLK at 600/120, 36, 45, 54 at 600/133 1/3."""
    for name, expected in (("cm-bf561", (39, 49, 59)), ("cm-bf561-ratings", (35, 44, 53))):
        board = board_named(name)
        opening = (0, board.sdram.miss_sclk, board.sdram.conflict_sclk)
        assert tuple(read_cclk(board, each) for each in opening) == expected


def test_l2_reads_stall_for_the_latency() -> None:
    """Every read of L2 costs 9 CCLK, one of which is its issue; nothing else stalls."""
    latency_cclk = board_named("cm-bf561").chip.l2_read_cclk
    assert stalls(run(reading("in_l2"))) == {StallReason.L2_LATENCY: WORDS * (latency_cclk - 1)}


def test_l2_writes_are_posted() -> None:
    """A store to L2 goes its way while the core goes on."""

    def write(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            yield core.run(fill, core.array("in_l2"), 7)

    outcome = run(every_frame(write))
    assert stalls(outcome) == {}
    (traffic,) = [each for each in outcome.traffic if each.memory == "L2"]
    assert (traffic.master, traffic.read_bytes, traffic.written_bytes) == ("core A", 0, 4 * WORDS)


@each_board
def test_sdram_reads_stall_by_page(name: str) -> None:
    """1024 words cross two or three pages: the first closed, the others behind another open page, all else hits."""
    board = board_named(name)
    machine = load(reading("in_sdram"), board=name)
    (row,) = machine._buffers["A"]["in_sdram"]
    conflicts = len(row.pages) - 1
    found = stalls(machine.run(iter(noise(1))))
    assert found == {
        StallReason.SDRAM_PAGE_HIT: (WORDS - 1 - conflicts) * read_cclk(board),
        StallReason.SDRAM_PAGE_MISS: read_cclk(board, board.sdram.miss_sclk),
        StallReason.SDRAM_PAGE_CONFLICT: conflicts * read_cclk(board, board.sdram.conflict_sclk),
    }


def test_two_rows_of_one_bank_conflict_at_every_change() -> None:
    """First and last line of a picture lie on different pages; reading another bank in between changes nothing."""

    def alternate(core: Core, frame: Frame) -> Play:
        image = core.rows("image")
        yield core.run(spin, 1000)
        with core.stage("Work"):
            for row in (image[0], frame.rows[-1], image[-1], frame.rows[-1], image[0]):
                yield core.run(first, row)

    board = board_named("cm-bf561")
    assert stalls(run(every_frame(alternate), size=FrameSize(64, 48))) == {
        StallReason.SDRAM_PAGE_MISS: read_cclk(board, board.sdram.miss_sclk),
        StallReason.SDRAM_PAGE_HIT: read_cclk(board),  # the camera's line, the second time
        # two changes in the picture, and the camera's line, whose end the camera wrote to the next page
        StallReason.SDRAM_PAGE_CONFLICT: 3 * read_cclk(board, board.sdram.conflict_sclk),
    }


def test_an_unloaded_bus_adds_nothing() -> None:
    """One core alone, at any offset to SCLK, never waits for itself."""

    def read(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)
        with core.stage("Work"):
            for turns in range(12):
                yield core.run(spin, turns)
                yield core.run(first, core.rows("image")[0])

    assert StallReason.EBIU_ARBITRATION not in stalls(run(every_frame(read)))


def test_two_cores_at_the_bus_wait_for_each_other() -> None:
    """Both read SDRAM all the time: the bus is busy for 4 of the 8 SCLK of each read, and two of them fill it."""
    alone = run(reading("in_sdram", times=20))
    crowded = run(reading("in_sdram", times=20), reading("in_sdram", times=20))
    assert StallReason.EBIU_ARBITRATION not in stalls(alone)
    waits = [stalls(crowded, core).get(StallReason.EBIU_ARBITRATION, 0) for core in ("A", "B")]
    assert sum(waits) > 0
    busy_cclk = sum(each.busy_cclk for each in crowded.traffic if each.memory == "SDRAM")
    slowest = max(stage_of(crowded.frames[0], "Work", core).elapsed_cclk for core in ("A", "B"))
    assert slowest >= 20 * 2 * WORDS * 4 * 5  # the bus's own time is a lower bound
    assert busy_cclk >= 20 * 2 * WORDS * 4 * 5


def test_writes_to_sdram_go_no_faster_than_the_bus() -> None:
    """Posted, a store costs the core one cycle; but many of them in a row must leave over the bus, an SCLK each."""

    def write(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 100_000)
        with core.stage("Work"):
            for _ in range(10):
                yield core.run(fill, core.array("in_sdram"), 7)

    cost = stage_of(run(every_frame(write)).frames[0], "Work")
    assert cost.elapsed_cclk >= 9 * WORDS * 5
    assert set(cost.stall_cclk) == {StallReason.EBIU_ARBITRATION}


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
