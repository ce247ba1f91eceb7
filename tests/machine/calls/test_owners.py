"""Every cycle has an owner: a kernel, its line, its buffer and the path to it, or something that no kernel does."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.random_traffic import SIZE, hammer, pictures
from bfsim.api import Core, Frame, i32, kernel
from bfsim.chip.boards import CM_BF561
from bfsim.kernel import GCC_O0, VDSP_O2, CompilerProfile
from bfsim.kernel.build import Build
from bfsim.kernel.costs import call_paths
from bfsim.linker import link
from bfsim.machine.board import Board
from bfsim.machine.symbols import symbols_of
from bfsim.trace import BoardRecord, OwnerCost, StallReason
from tests.machine.kernels import copy, first, spin
from tests.machine.made_boards import in_work, play
from tests.machine.owners import assert_owned
from tests.machine.rig import WORDS, Play, cycles_of, every_frame
from tests.machine.steps import LDFS, STEPS, Step, main_of
from tests.tiers import exhaustive


@given(STEPS, STEPS, st.booleans(), st.sampled_from(list(LDFS)))
@settings(max_examples=25, deadline=None)
def test_owners_of_chance_firmware_fill_every_stage(
    of_a: list[Step], of_b: list[Step], handles: bool, ldf: str
) -> None:
    """Whatever the cores do, and in whichever order they meet."""
    mains = main_of(of_a, handles=handles), main_of(of_b, handles=handles)
    assert_owned(play(*mains, frames=2, ldf=LDFS[ldf]))


@pytest.mark.parametrize("ldf", sorted(set(LDFS) - {"sdram"}))  # where the internal DMA reaches nothing
@pytest.mark.parametrize("seed", [0, *exhaustive(1)])
def test_owners_of_random_traffic_fill_every_stage(seed: int, ldf: str) -> None:
    """Firmware that hammers SDRAM and L2 from both cores, while rings and cameras run."""
    firmware = hammer(seed)
    places = link(LDFS[ldf], symbols_of(firmware, SIZE), CM_BF561.chip.regions)
    assert_owned(Board(CM_BF561, firmware, SIZE, places).run(pictures(2, seed)))


@pytest.mark.parametrize("later", [1, 3])
def test_owners_of_a_single_count_fill_every_stage_when_others_come(later: int) -> None:
    """A first frame with one kernel of one block: what others charge, frame after frame, is laid beside it."""

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(first, core.rows("image")[0])
        for number in range(later * frame.index):
            yield core.run(spin, 10 + number)
        if frame.index > 1:
            yield core.run(copy, core.rows("image")[1], core.array("single_row"))

    assert_owned(play(every_frame(work), frames=4))


# ---- whose they are


def owner(outcome: BoardRecord, name: str, core: str = "A", stage: str = "Work") -> OwnerCost:
    """Return what an owner cost a core in a stage of the first frame."""
    (cycles,) = [each for each in outcome.frames[0].cores if each.core == core]
    (found,) = [each for each in cycles.owners if (each.owner, each.stage) == (name, stage)]
    return found


@kernel
def sum_of(row: i32[:], count: i32) -> i32:
    result = 0
    for x in range(count):
        result += row[x]
    return result


@kernel
def twice(row: i32[:]) -> i32:
    return sum_of(row, 2)


@kernel
def both(near: i32[:], far: i32[:], other: i32[:]) -> i32:
    return sum_of(near, 3) + sum_of(far, 5) + twice(other)


def read_all(core: Core, frame: Frame) -> Play:
    """Call `both` on L1, SDRAM and L2."""
    yield core.run(both, *(core.array(name) for name in ("words", "in_sdram", "in_l2")))


@pytest.mark.parametrize("profile", [GCC_O0, VDSP_O2])
def test_a_callee_is_told_apart_by_path_and_by_buffer(profile: CompilerProfile) -> None:
    """One kernel is called three times, on arrays in three memories and through another kernel: each has its own waits."""
    outcome = play(in_work(read_all), build=Build(profile))
    assert_owned(outcome)
    mine = [each for each in outcome.accesses if each.symbol.endswith("sum_of")]
    assert {each.buffer: each.reads for each in mine} == {"words (A)": 3, "in_sdram (A)": 5, "in_l2": 2}
    stalls = {each.buffer: set(each.stall_cclk) for each in mine}
    assert stalls["words (A)"] == set()
    assert stalls["in_l2"] == {StallReason.L2_LATENCY}
    assert StallReason.SDRAM_PAGE_HIT in stalls["in_sdram (A)"]
    calls = {tuple(symbol.rsplit("owners_")[-1] for symbol in each.path): each for each in outcome.paths}
    assert {path: each.calls for path, each in calls.items()} == {
        ("both",): 1,
        ("both", "sum_of"): 2,
        ("both", "twice"): 1,
        ("both", "twice", "sum_of"): 1,
    }
    through = calls["both", "twice", "sum_of"]
    assert set(through.stall_cclk) - {StallReason.INTERLOCK} == {StallReason.L2_LATENCY}
    assert 0 < through.issue_cclk < calls["both", "sum_of"].issue_cclk


def test_a_program_of_too_many_paths_is_told_apart_by_kernel_alone(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Where each path had its own counters there would be too many: each kernel has one path then, and the sums hold."""

    @kernel
    def one_way(row: i32[:], other: i32[:]) -> i32:
        return sum_of(row, 4) + sum_of(other, 5) + twice(row)

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(one_way, core.array("in_sdram"), core.array("in_l2"))

    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(call_paths, "MOST_COUNTERS", 0)
    outcome = play(in_work(work), build=Build(GCC_O0))
    assert_owned(outcome)
    assert sorted(each.calls for each in outcome.paths) == [1, 1, 3]


def test_a_line_waits_for_the_buffer_that_it_reads() -> None:
    """Of the lines of a kernel only that with the load waits, and for as long as the stage did."""
    outcome = play(in_work(read_all))
    (record,) = [each for each in outcome.kernels if each.kernel == "sum_of"]
    waiting = [each for each in record.lines if set(each.stall_cclk) - {StallReason.INTERLOCK}]
    assert [record.text[each.line - record.first_line].strip() for each in waiting] == ["result += row[x]"]


def test_what_no_kernel_does_is_named() -> None:
    """Semaphores, rings, interrupts and the cameras own their cycles: work, stalls and idle."""

    def work(core: Core, frame: Frame) -> Play:
        ring = core.input_ring(frame.rows, "in_ring")
        row = yield from ring.line()
        yield core.run(copy, row, core.array("single_row"))
        yield from core.wait("go")

    def let_go(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 20_000)
        yield from core.post("go")

    outcome = play(in_work(work), every_frame(let_go))
    assert_owned(outcome)
    ring, semaphore = owner(outcome, "ring in_ring"), owner(outcome, "semaphore go")
    assert set(ring.stall_cclk) == {StallReason.DMA_SETUP, StallReason.RING_EMPTY}
    assert semaphore.stall_cclk[StallReason.SEMAPHORE] > 0.9 * cycles_of(spin, 20_000)
    assert semaphore.issue_cclk > 0
    cameras = owner(outcome, "cameras", stage="(the rest)")
    assert cameras.idle_cclk > 0
    assert set(cameras.stall_cclk) == {StallReason.INTERRUPT}
    assert owner(outcome, "spin", core="B", stage="(the rest)").calls == 1


def test_traffic_is_told_by_buffer() -> None:
    """A ring moves a line from the camera's buffer in SDRAM to its own in L1; a kernel reads words of SDRAM."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.input_ring(frame.rows[:2], "in_ring").line()
        yield core.run(sum_of, core.array("in_sdram"), WORDS)

    outcome = play(in_work(work))
    moved = {(each.buffer, each.master): each for each in outcome.traffic}
    fetched = moved["camera (A)", "MDMA1 stream 0"]
    stored = moved["in_ring (A)", "MDMA1 stream 0"]
    assert fetched.read_bytes == stored.written_bytes == 2 * 32
    assert (fetched.memory, stored.memory) == ("SDRAM", "COREA_L1_DATA_A")
    own = moved["in_sdram (A)", "core A"]
    assert own.read_bytes == 4 * WORDS
    assert own.page_hits + own.page_misses + own.page_conflicts == WORDS
    assert moved["camera (A)", "PPI0"].written_bytes > 0
