"""Conflicts in L1: a sub-bank that a DMA uses while the core does; the expected number in closed form."""

from __future__ import annotations

import sys

import pytest

from bfsim.api import Buffer, Core, Frame, i32
from bfsim.machine.dma.config import DmaConfig
from bfsim.trace import REST, BoardRecord, StallReason
from tests.machine.kernels import spin, total
from tests.machine.made_boards import CHIP, assert_accounted, in_work, play
from tests.machine.rig import Play, every_frame, stage_of

SUBBANK = CHIP.l1.subbank_bytes
WORDS = SUBBANK // 4
BANKS = Buffer("banks", i32, 3 * WORDS, "L1_data_b", rows=2)
"""Each row has at least two whole sub-banks."""
LARGE = Buffer("large", i32, 4 * WORDS, "sdram_bank2")


def sub_banks(address: int, nbytes: int) -> range:
    """Numbers of the sub-banks that so many bytes lie in."""
    return range(address // SUBBANK, (address + nbytes - 1) // SUBBANK + 1)


def begin_moving(core: Core, address: int, words: int) -> Play:
    """Have DMA write so many words to an address in L1."""
    dma = core.memory_dma("MDMA1_0")
    registers = {"X_COUNT": words, "X_MODIFY": 4}
    dma.program(
        source={"START_ADDR": core.array("large").address, **registers},
        destination={"START_ADDR": address, **registers},
    )
    yield from dma.start(DmaConfig(), DmaConfig(WNR=True))


def loading(*, moved_words: int, calls: int, at_bank: int) -> tuple[BoardRecord, dict[str, int]]:
    """Let DMA write a sub-bank of L1 while the core sums up a row of three; return the run and what is known of it."""
    known: dict[str, int] = {}

    def work(core: Core, frame: Frame) -> Play:
        row, other = core.rows("banks")
        target = (row if at_bank < 4 else other).address
        target = -(-target // SUBBANK) * SUBBANK + (SUBBANK if at_bank % 4 == 2 else 0)
        shared = [each for each in sub_banks(row.address, row.nbytes) if each == target // SUBBANK]
        known["banks"], known["shared"] = len(sub_banks(row.address, row.nbytes)), len(shared)
        if moved_words:
            yield from begin_moving(core, target, moved_words)
        for _ in range(calls):
            yield core.run(total, row)
        yield from core.memory_dma("MDMA1_0").wait()

    outcome = play(in_work(work), more=(BANKS, LARGE))
    assert_accounted(outcome)
    return outcome, known


def conflicts(outcome: BoardRecord) -> tuple[int, int]:
    """Conflicts of the stage, and its cycles without them."""
    cost = stage_of(outcome.frames[0], "Work")
    stalled = cost.stall_cclk.get(StallReason.L1_CONFLICT, 0)
    return stalled, cost.elapsed_cclk - stalled


@pytest.mark.parametrize("moved_words", [1, 100, WORDS])
@pytest.mark.parametrize("calls", [1, 3])
@pytest.mark.parametrize("at_bank", [1, 2])
def test_words_of_dma_meet_the_core_s_share_of_the_cycles(moved_words: int, calls: int, at_bank: int) -> None:
    """Words that came into the sub-bank, times its accesses in each cycle of the stage: rounded down, a cycle each."""
    outcome, known = loading(moved_words=moved_words, calls=calls, at_bank=at_bank)
    stalled, elapsed_cclk = conflicts(outcome)
    assert known["shared"] == 1
    accesses = calls * 3 * WORDS / known["banks"]  # spread evenly over the sub-banks of the row
    assert stalled == int(moved_words * accesses / elapsed_cclk) * CHIP.l1.conflict_cclk
    assert (stalled > 0) == (moved_words > 1)


def test_without_dma_there_are_none() -> None:
    """Every cycle has the sub-bank for itself."""
    outcome, _ = loading(moved_words=0, calls=3, at_bank=1)
    assert conflicts(outcome)[0] == 0


def test_other_sub_banks_do_not_matter() -> None:
    """DMA into the row that no kernel reads."""
    outcome, known = loading(moved_words=WORDS, calls=3, at_bank=6)
    assert known["shared"] == 0
    assert conflicts(outcome)[0] == 0


def test_work_without_memory_meets_no_dma() -> None:
    """The core computes in registers while the words come."""

    def work(core: Core, frame: Frame) -> Play:
        row = core.rows("banks")[0]
        yield from begin_moving(core, row.address, WORDS)
        yield core.run(spin, 3000)
        yield from core.memory_dma("MDMA1_0").wait()

    assert conflicts(play(in_work(work), more=(BANKS, LARGE)))[0] == 0


def test_each_stage_pays_for_its_own_dma() -> None:
    """DMA that ended before a stage began costs that one nothing."""

    def move(core: Core) -> Play:
        row = core.rows("banks")[0]
        yield from begin_moving(core, row.address, WORDS)
        yield core.run(total, row)
        yield from core.memory_dma("MDMA1_0").wait()

    def read(core: Core) -> Play:
        yield core.run(total, core.rows("banks")[0])

    def work(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            yield from move(core)
        with core.stage("More work"):
            yield from read(core)

    (frame,) = play(every_frame(work), more=(BANKS, LARGE)).frames
    assert stage_of(frame, "Work").stall_cclk[StallReason.L1_CONFLICT] > 0
    for stage in ("More work", REST):
        assert StallReason.L1_CONFLICT not in stage_of(frame, stage).stall_cclk


@pytest.mark.xfail(
    strict=True, reason="the bus is behind the core's clock when a stage ends that never waited"
)
def test_a_stage_that_ends_ahead_of_time_pays_too() -> None:
    """The words came while its kernels ran, though nobody has looked at the bus since."""

    def work(core: Core, frame: Frame) -> Play:
        row = core.rows("banks")[0]
        yield from begin_moving(core, row.address, WORDS)
        for _ in range(3):
            yield core.run(total, row)

    assert conflicts(play(in_work(work), more=(BANKS, LARGE)))[0] > 0


def test_a_profiler_may_watch() -> None:
    """It keeps the arrays that numpy's methods are called on, so none of these can grow where it is."""

    def work(core: Core, frame: Frame) -> Play:
        for row in core.rows("banks")[: frame.index + 1]:  # a new group of calls, when there is one already
            yield core.run(total, row)

    unwatched = play(in_work(work), frames=2, more=(BANKS,))
    before = sys.getprofile()
    sys.setprofile(lambda *_: None)
    try:
        watched = play(in_work(work), frames=2, more=(BANKS,))
    finally:
        sys.setprofile(before)
    assert watched == unwatched
