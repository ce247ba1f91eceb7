"""Instruction fetch: code outside L1, with and without the code cache, closed forms beside the simulation."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from itertools import chain
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.api import Core, Frame
from bfsim.chip.boards import CM_BF561
from bfsim.errors import KernelError
from bfsim.kernel import VDSP_O2, Kernel
from bfsim.kernel.build import ESTIMATED
from bfsim.kernel.calls import access_log as log
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.linker import LinkerScript, link
from bfsim.machine.bus.state import FETCH_BYTES
from bfsim.machine.calls import code_fetches
from bfsim.machine.calls.fetch import CodeCache
from bfsim.machine.code import code_symbols
from bfsim.trace import StallReason
from tests.machine.bench import Bench
from tests.machine.kernels import copy, spin, total
from tests.machine.made_boards import CCLK_PER_SCLK, CHIP, assert_accounted, in_work, play
from tests.machine.placements import code_in, shipped
from tests.machine.rig import Play, cycles_of, stage_of

LINE = CHIP.cache.line_bytes
FETCH_L2_CCLK = CHIP.l2.read_cclk - 1
FETCH_HIT_CCLK = (CHIP.external.core_sync_sclk + CM_BF561.sdram.nCL) * CCLK_PER_SCLK - 1
OPEN_CCLK = CM_BF561.sdram.nRCD * CCLK_PER_SCLK
TURNS = [0, 1, 10, 300]


def executed_bytes(kernel: Kernel, *arguments: Any) -> int:
    """Bytes of code that a call executes: those of each block, as often as it runs."""
    code = kernel.compile(VDSP_O2)
    totals = code.new_totals()
    kernel.prepare(code, [], totals).run(*arguments)
    return sum(count * each.nbytes for count, each in zip(totals.tolist(), code.counters, strict=False))


def code_lines(kernel: Kernel, at: int) -> int:
    """Cache lines that a kernel's code at an address fills."""
    nbytes = sum(ESTIMATED.code_bytes(kernel).values())
    return (at + nbytes - 1) // LINE - at // LINE + 1


def spinning(*turns: int) -> Any:
    """Make a main loop that spins so often, call by call."""

    def work(core: Core, frame: Frame) -> Play:
        for each in turns:
            yield core.run(spin, each)

    return in_work(work)


def address_of_code(ldf: LinkerScript) -> int:
    """Where the LDF puts the only kernel of core A."""
    link_map = link(ldf, code_symbols(spinning(1), "p0", ESTIMATED), CHIP.regions)
    (placed,) = link_map.placements
    return placed.address


@pytest.mark.parametrize("turns", TURNS)
def test_code_in_l1_costs_nothing(turns: int) -> None:
    """A fetch is part of issue."""
    cost = stage_of(play(spinning(turns)).frames[0], "Work")
    assert (cost.issue_cclk, cost.stall_cclk) == (cycles_of(spin, turns), {})


@pytest.mark.parametrize("turns", TURNS)
def test_code_in_l2_is_fetched_as_often_as_it_runs(turns: int) -> None:
    """64 bits at a time, each as long as a read of L2; the issue cycles are those of L1."""
    outcome = play(spinning(turns), ldf=code_in("L2"))
    fetches = -(-executed_bytes(spin, turns) // FETCH_BYTES)
    cost = stage_of(outcome.frames[0], "Work")
    assert cost.issue_cclk == cycles_of(spin, turns)
    assert cost.stall_cclk == {StallReason.CODE_FETCH: fetches * FETCH_L2_CCLK}
    (l2,) = [each for each in outcome.traffic if each.memory == "L2"]
    assert (l2.master, l2.read_bytes) == ("core A", fetches * FETCH_BYTES)
    assert_accounted(outcome)


@pytest.mark.parametrize("turns", TURNS)
def test_code_in_sdram_pays_its_way_for_every_fetch(turns: int) -> None:
    """An open page each, but for the first access and those behind a refresh."""
    outcome = play(spinning(turns), ldf=code_in("SDRAM"))
    fetches = -(-executed_bytes(spin, turns) // FETCH_BYTES)
    (core_a,) = [each for each in outcome.traffic if (each.memory, each.master) == ("SDRAM", "core A")]
    assert core_a.read_bytes == fetches * FETCH_BYTES
    assert core_a.page_conflicts == 0
    stalls = dict(stage_of(outcome.frames[0], "Work").stall_cclk)
    refreshed = stalls.pop(StallReason.SDRAM_REFRESH, 0)
    assert stalls == {StallReason.CODE_FETCH: fetches * FETCH_HIT_CCLK + core_a.page_misses * OPEN_CCLK}
    elapsed = stage_of(outcome.frames[0], "Work").elapsed_cclk
    refreshes = elapsed // (CM_BF561.sdram.refresh_interval_sclk(CM_BF561.clocks.sclk_hz) * CCLK_PER_SCLK) + 1
    assert 1 <= core_a.page_misses <= 1 + refreshes
    assert refreshed <= refreshes * CM_BF561.sdram.refresh_sclk * CCLK_PER_SCLK


@pytest.mark.parametrize("memory", ["L2", "SDRAM"])
def test_the_code_cache_fills_its_lines_once(memory: str) -> None:
    """The first call brings every line of the code, later ones none, however long they are."""
    ldf = code_in(memory, "cache.ldf")
    outcome = play(spinning(10, 300, 0), ldf=ldf)
    lines = code_lines(spin, address_of_code(ldf))
    cost = stage_of(outcome.frames[0], "Work")
    assert cost.issue_cclk == sum(cycles_of(spin, each) for each in (10, 300, 0))
    line_cclk = FETCH_L2_CCLK if memory == "L2" else FETCH_HIT_CCLK
    assert CHIP.l2
    # the first word of each line, and what is left of all lines but the last
    rest_cclk = (
        (LINE // CHIP.l2.port_bytes - 1) * CHIP.l2.next_cclk
        if memory == "L2"
        else (LINE // CM_BF561.sdram.word_bytes - 1) * CCLK_PER_SCLK
    )
    opening_cclk = OPEN_CCLK if memory == "SDRAM" else 0
    (stalled,) = cost.stall_cclk.values()
    expected = lines * line_cclk + (lines - 1) * rest_cclk + opening_cclk
    assert expected <= stalled < expected + lines * CCLK_PER_SCLK  # an SCLK edge for each line
    (moved,) = [each for each in outcome.traffic if (each.memory, each.master) == (memory, "core A")]
    assert moved.read_bytes == lines * LINE


def test_each_core_has_a_code_cache_of_its_own() -> None:
    """Both fill their lines, though they run the same kernel."""
    outcome = play(spinning(10), spinning(10), ldf=code_in("L2", "cache.ldf"))
    read = {each.master: each.read_bytes for each in outcome.traffic if each.memory == "L2"}
    assert set(read) == {"core A", "core B"}
    assert all(each > 0 for each in read.values())


@pytest.mark.parametrize("memory", ["L2", "SDRAM"])
@pytest.mark.parametrize("name", ["thesis.ldf", "cache.ldf"])
def test_values_do_not_depend_on_where_the_code_is(memory: str, name: str) -> None:
    """Fetches cost time only, and issue stays what it was; data in SDRAM among them."""
    seen = []

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(copy, frame.rows[0], core.array("single_row"))
        seen.append((bytes(core.array("single_row").octets), (yield core.run(total, core.array("in_sdram")))))

    costs = [
        stage_of(play(in_work(work), ldf=ldf).frames[0], "Work")
        for ldf in (shipped(name), code_in(memory, name))
    ]
    assert seen[0] == seen[1]
    assert costs[0].issue_cclk == costs[1].issue_cclk
    assert costs[0].elapsed_cclk < costs[1].elapsed_cclk
    assert StallReason.CODE_FETCH not in costs[0].stall_cclk


class Fetched:
    """Calls whose code lies in certain lines, without a board: what they log, by the compiled part in plain Python."""

    def __init__(self) -> None:
        self.cache = CodeCache(CHIP.cache).words
        self.room = np.zeros(log.LOG + log.ENTRY_WORDS * 16, np.int64)
        self.access_trace = AccessTrace(np.zeros(64, np.uint8), 64, self.room)

    def log(self, *entries: int) -> None:
        """Log what a kernel has accessed, from site 0 on."""
        self.room[log.ENTRIES] = len(entries)
        self.access_trace.entries(len(entries))[:] = entries
        self.access_trace.sites(len(entries))[:] = range(len(entries))

    def lines(self, lines: Sequence[int], site: int = 0) -> int:
        """Fetch these lines; return how many were not there."""
        words = [len(lines), *chain(*((each, site) for each in lines)), *lines]
        before = int(self.room[log.ENTRIES])
        code_fetches.fetch_lines.python(self.room, self.cache, np.array(words))
        return int(self.room[log.ENTRIES]) - before

    def logged(self) -> list[tuple[int, int]]:
        """What has been logged, with the sites."""
        count = int(self.room[log.ENTRIES])
        columns = self.access_trace.entries(count), self.access_trace.sites(count)
        return [(int(each), int(site)) for each, site in zip(*columns, strict=True)]


@given(st.lists(st.lists(st.integers(0, 5).map(lambda tag: tag * 512), max_size=8), max_size=8))
def test_the_line_used_last_stays_longest(calls: list[list[int]]) -> None:
    """Four ways, LRU: beside a model in plain Python, in one set, call by call."""
    fetched, plain = Fetched(), OrderedDict[int, None]()
    for lines in calls:
        expected = []
        for line in lines:
            if line not in plain:
                expected.append(line)
                if len(plain) == CHIP.cache.code_ways:
                    plain.popitem(last=False)
            plain[line] = None
            plain.move_to_end(line)
        fetched.log()
        assert fetched.lines(lines) == len(expected)
        assert [each for each, _ in fetched.logged()] == [fill(line) for line in expected]


def test_lines_of_different_sets_do_not_push_each_other_out() -> None:
    """As many lines as the cache has: all of them stay."""
    lines = range(CHIP.cache.code_bytes // LINE)
    fetched = Fetched()
    assert fetched.lines(lines) == len(lines)
    assert fetched.lines(lines) == 0
    assert fetched.lines([len(lines)]) == 1
    assert fetched.lines([0]) == 1, "the one that was used first has left"


def entry(stamp: int, kind: int, offset: int) -> int:
    """An entry of a log."""
    return stamp << log.STAMP_BIT | kind << log.KIND_BIT | offset


def fill(line: int) -> int:
    """The entry of a line of code that is fetched at the beginning of its call."""
    return entry(0, log.FETCH_LINE, line * LINE)


def test_line_fills_come_behind_the_accesses_of_the_first_block() -> None:
    """The log is in order of time; accesses of one block, which have one stamp, stay as the block made them. Each keeps its site."""
    fetched = Fetched()
    first = [entry(0, log.WRITE_BACK, 32), entry(0, log.FILL, 0), entry(0, log.LOAD, 60)]
    later = [entry(5, log.LOAD, 8), entry(9, log.STORE, 4)]
    fetched.log(*first, *later)
    assert fetched.lines([7, 8], site=20) == 2
    assert fetched.logged() == [
        *zip(first, (0, 1, 2), strict=True),
        (fill(7), 20),
        (fill(8), 20),
        *zip(later, (3, 4), strict=True),
    ]
    fetched.log(*later)
    assert fetched.lines([8, 7]) == 0
    assert [each for each, _ in fetched.logged()] == later


def test_accesses_of_earlier_calls_stay_before_those_of_the_present_one() -> None:
    """A core that runs ahead keeps them in front."""
    fetched = Fetched()
    kept, present = entry(3, log.LOAD, 8), entry(4, log.LOAD, 12)
    fetched.log(kept, present)
    fetched.room[log.KEPT] = 1
    fetched.lines([7])
    fetched.room[log.KEPT] = 0
    assert [each for each, _ in fetched.logged()] == [kept, fill(7), present]


def test_a_log_without_room_counts_what_it_would_need() -> None:
    """So that the error can say how many accesses there were; nothing is written behind its end."""
    fetched = Fetched()
    loads = [entry(each, log.LOAD, 4 * each) for each in range(15)]
    fetched.log(*loads)
    sites = fetched.access_trace.sites(15).copy()
    assert fetched.lines([1, 2]) == 2
    assert fetched.room[log.ENTRIES] == 17
    assert fetched.access_trace.entries(15).tolist() == loads
    assert fetched.access_trace.sites(15).tolist() == sites.tolist()


def test_single_fetches_are_one_entry_behind_the_accesses() -> None:
    """For every 64 bits that were executed since the last time, with their site; as long as there is room."""
    fetched, totals, code = Fetched(), np.array([3, 1]), np.array([2, 0, 7, 10, 4])
    loads = [entry(each, log.LOAD, 4 * each) for each in range(14)]
    for turns, nbytes in (([3, 1], 34), ([4, 1], 10), ([4, 1], 0)):
        fetched.log(*loads)
        totals[:] = turns
        fetches = -(-nbytes // FETCH_BYTES)
        code_fetches.fetch_singly.python(fetched.room, totals, code)
        expected = [(entry(fetches, log.FETCHES, 0), 7)] if fetches else []
        assert fetched.logged()[14:] == expected
    totals[:] = 5, 1
    fetched.log(*loads, *loads[:2])
    code_fetches.fetch_singly.python(fetched.room, totals, code)
    assert fetched.room[log.ENTRIES] == 17
    with pytest.raises(KernelError, match="at most 16 times, not 17 times"):
        fetched.access_trace.check_room(17)


def test_code_is_fetched_in_turn_evenly_over_its_call() -> None:
    """Words of two routines, one behind the other and then from the first again; behind the accesses of their cycle."""
    bus = Bench().bus
    bus.logs.keep_routine(0, 5, offset=96, nbytes=20, following=6)
    bus.logs.keep_routine(0, 6, offset=4096, nbytes=8, following=5)
    logged = [(entry(0, log.LOAD, 8), 1), (entry(5, log.STORE, 12), 2), (entry(6, log.FETCHES, 0), 5)]
    for written, column in zip(bus.logs.first(0, len(logged)), zip(*logged, strict=True), strict=True):
        written[:] = column
    fetched = [(0, 96, 5), (2, 104, 5), (5, 112, 5), (7, 4096, 6), (10, 96, 5), (12, 104, 5)]
    fetches = [(entry(stamp, log.FETCH, place), site) for stamp, place, site in fetched]
    expected = [logged[0], *fetches[:2], logged[1], *fetches[2:]]
    assert bus.logs.accesses(0, 15, 3) == expected
    assert bus.logs.accesses(0, 15, 2) == logged[:2]


def test_the_record_says_where_the_code_is() -> None:
    """Code outside L1 is told apart."""
    for ldf, in_l1 in ((shipped("thesis.ldf"), True), (code_in("L2"), False), (code_in("SDRAM"), False)):
        outcome = play(spinning(1), ldf=ldf)
        assert {each.in_l1 for each in outcome.code if each.core == "A"} == {in_l1}
