"""Object code that reaches into L2 and SDRAM itself: each access is charged, to its line and its array, as those of other kernels are."""

from __future__ import annotations

from typing import Any

from bfsim.api import Core, Frame, i32, kernel_from
from bfsim.chip.boards import board_named
from bfsim.kernel import GCC_O2
from bfsim.kernel.build import Build
from bfsim.trace import AccessRecord, BoardRecord, StallReason
from tests.machine.calls.test_kernel_accesses import read_cclk
from tests.machine.kernels import spin
from tests.machine.placements import changed
from tests.machine.rig import Play, every_frame, run, stage_of
from tests.sums import DATA

SUMS = DATA / "sums.o"
sums = kernel_from(SUMS, "sums", row=i32[:], out=i32[:], n=i32, first=i32, result=i32)
"""Reads four bytes of `row` for each of n - 3 words that it stores in `out`, by a function of its own, in its line 9."""
N = 16
READS, WRITES = 4 * (N - 3), N - 3
POPPED, PUSHED = 1 + 1 + 5 + 2 * (N - 3), 1 + 5 + 2 * (N - 3)
"""Words that it takes from its stack, and puts there: an argument, RETS, five registers; and two registers in each call that it makes."""
STACK = "RESERVE(OWN(stack), OWN(stack_length) = STACK_LENGTH, 4)\n"
IN_L2 = "OWN(L2)\n      {\n         INPUT_SECTION_ALIGN(4)\n"


def calling(row: str, out: str) -> Any:
    """Make a main loop that calls it once on two buffers."""

    def call(core: Core, _frame: Frame) -> Play:
        yield core.run(spin, 1000)  # until the last lines of both cameras are off the bus
        with core.stage("Work"):
            yield core.run(sums, core.array(row), core.array(out), N, 0)

    return every_frame(call)


def timed(main: Any, **how: Any) -> BoardRecord:
    """Run it as the GNU simulator times it: without interlocks."""
    return run(main, build=Build(GCC_O2), **how)


def in_work(outcome: BoardRecord) -> list[AccessRecord]:
    """What accesses of the stage waited, by line and buffer."""
    return [each for each in outcome.accesses if each.stage == "Work" and each.stall_cclk]


def test_reads_of_l2_stall_for_the_latency() -> None:
    """Each costs 9 CCLK, one of which is its issue; the stack and what is in L1 cost nothing."""
    outcome = timed(calling("in_l2", "words"))
    cost = stage_of(outcome.frames[0], "Work")
    assert cost.stall_cclk == {StallReason.L2_LATENCY: READS * 8}
    assert cost.issue_cclk == stage_of(timed(calling("words", "words")).frames[0], "Work").issue_cclk
    (found,) = in_work(outcome)
    assert (found.symbol, found.line, found.buffer) == ("_weighted", 9, "in_l2")
    (traffic,) = [each for each in outcome.traffic if (each.memory, each.master) == ("L2", "core A")]
    assert (traffic.read_bytes, traffic.written_bytes) == (4 * READS, 0)


def test_accesses_are_counted_by_line_and_array() -> None:
    """Wherever the arrays are: those of the code itself, to its stack and tables, are none of them."""
    for row, out in (("words", "in_l2"), ("in_l2", "words")):
        found = {
            (each.symbol, each.buffer.split()[0]): (each.reads, each.writes)
            for each in timed(calling(row, out)).accesses
            if each.stage == "Work"
        }
        assert found == {("_weighted", row): (READS, 0), ("sums_o_sums", out): (0, WRITES)}


def test_stores_to_l2_are_posted() -> None:
    """They go their way while the core goes on."""
    outcome = timed(calling("words", "in_l2"))
    assert stage_of(outcome.frames[0], "Work").stall_cclk == {}
    (traffic,) = [each for each in outcome.traffic if (each.memory, each.master) == ("L2", "core A")]
    assert (traffic.read_bytes, traffic.written_bytes) == (0, 4 * WRITES)


def test_reads_of_sdram_stall_by_page() -> None:
    """The first opens the page, all others hit it, unless a refresh comes between."""
    board = board_named("cm-bf561")
    outcome = timed(calling("in_sdram", "words"))
    found = dict(stage_of(outcome.frames[0], "Work").stall_cclk)
    (traffic,) = [each for each in outcome.traffic if (each.memory, each.master) == ("SDRAM", "core A")]
    opened = traffic.page_misses + traffic.page_conflicts
    assert (traffic.page_hits + opened, opened <= 2) == (READS, True)
    assert found.pop(StallReason.SDRAM_PAGE_HIT) == traffic.page_hits * read_cclk(board)
    miss = read_cclk(board, board.sdram.miss_sclk)
    assert found.pop(StallReason.SDRAM_PAGE_MISS, 0) in range(
        traffic.page_misses * miss, traffic.page_misses * (miss + 1) + 1
    )
    assert {each.buffer for each in in_work(outcome)} == {"in_sdram (A)"}


def test_one_call_may_reach_several_memories() -> None:
    """Each access is charged to the array that it hits."""
    outcome = timed(calling("in_l2", "in_sdram"))
    assert {(each.symbol, each.buffer) for each in in_work(outcome)} >= {("_weighted", "in_l2")}
    traffic = {
        (each.memory, each.read_bytes, each.written_bytes)
        for each in outcome.traffic
        if each.master == "core A"
    }
    assert traffic == {("L2", 4 * READS, 0), ("SDRAM", 0, 4 * WRITES)}


def test_a_stack_outside_of_l1_takes_its_time() -> None:
    """Each word that is taken from it costs the latency; of no buffer, in the lines that spill or come back."""
    ldf = changed("thesis.ldf", (STACK, ""), (IN_L2, f"{IN_L2}         {STACK}"))
    outcome = timed(calling("words", "words"), ldf=ldf)
    cost = stage_of(outcome.frames[0], "Work")
    assert cost.stall_cclk[StallReason.L2_LATENCY] == POPPED * 8
    (traffic,) = [each for each in outcome.traffic if (each.memory, each.master) == ("L2", "core A")]
    assert (traffic.read_bytes, traffic.written_bytes) == (4 * POPPED, 4 * PUSHED)
    assert {each.buffer for each in in_work(outcome)} == {""}
    assert {each.symbol for each in in_work(outcome)} == {"_weighted", "sums_o_sums"}
    inside = stage_of(timed(calling("words", "words")).frames[0], "Work")
    assert (inside.stall_cclk, inside.issue_cclk) == ({}, cost.issue_cclk)
