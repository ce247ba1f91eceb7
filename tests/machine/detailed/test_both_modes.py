"""The fast mode beside the detailed one: alike where nobody or little contends, near it in traffic made by chance."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from bfsim.chip.boards import board_named
from bfsim.kernel.calls import access_log as log
from bfsim.machine.bus import state as w
from tests.machine.bench import keep_code
from tests.machine.detailed.bus_rig import CODE_BYTES, MODES, Bench, CoreAccess, each_board


def same(board: str, prepare: Any) -> tuple[Bench, Bench]:
    """Play the same on both buses."""
    benches = [Bench(mode, board) for mode in MODES]
    for bench in benches:
        prepare(bench)
        bench.play()
    return benches[0], benches[1]


@each_board
@pytest.mark.parametrize("kind", [log.LOAD, log.STORE, log.FILL, log.WRITE_BACK, log.FETCH, log.FETCH_LINE])
def test_accesses_of_one_core_are_the_same_in_both_modes(board: str, kind: int) -> None:
    """To SDRAM and to L2, further apart than the store buffer needs to be empty."""
    apart = 120
    offsets = [32 * number * 7 for number in range(20)]
    if board_named(board).chip.l2:
        offsets += [board_named(board).sdram.nbytes + 32 * number for number in range(20)]
    accesses = [(apart * number + number % 7, kind, offset) for number, offset in enumerate(offsets)]
    fast, detailed = same(board, lambda bench: bench.call(0, accesses, apart * 41))
    assert fast.calls == detailed.calls
    assert fast.traffic() == detailed.traffic()


@each_board
@pytest.mark.parametrize("fetches", [1, 10, 77])
@pytest.mark.parametrize("gap_cclk", [2, 5, 150])
def test_fetches_are_the_same_in_both_modes(board: str, fetches: int, gap_cclk: int) -> None:
    """Of code in SDRAM and in L2, faster than it can come and slowly, among the loads of a call."""

    def prepare(bench: Bench) -> None:
        places = [64, bench.bank + 8192, *([bench.l2 + 64] if bench.spec.chip.l2 else [])]
        keep_code(bench.bus.logs, 0, CODE_BYTES, *places)
        loads = [(3 * gap_cclk * each, log.LOAD, 4 * each) for each in range(8)]
        bench.call(0, loads, max(fetches, 3 * len(loads)) * gap_cclk, fetches)

    fast, detailed = same(board, prepare)
    assert fast.calls == detailed.calls
    assert fast.traffic() == detailed.traffic()
    assert fast.stalls()[w.CODE_FETCH] > 0
    first, count = w.SITES_AT, 4 * w.SITE_WORDS
    assert list(fast.bus.words[first : first + count]) == list(detailed.bus.words[first : first + count])


@each_board
@pytest.mark.parametrize(
    ("source", "target"), [("l1", "sdram"), ("sdram", "l1"), ("sdram", "bank"), ("l1", "l1")]
)
@pytest.mark.parametrize("count", [1, 8, 41])
def test_copies_are_the_same_in_both_modes(board: str, source: str, target: str, count: int) -> None:
    """The end to the tick, every byte, every counter."""

    def copy(bench: Bench) -> None:
        places = {"l1": bench.l1, "sdram": 0, "bank": bench.bank}
        bench.transfer = bench.copy(places[source], places[target] + 4096, count, setup_sclk=15)

    fast, detailed = same(board, copy)
    assert fast.transfer.end == detailed.transfer.end
    assert fast.traffic() == detailed.traffic()
    assert fast.content() == detailed.content()


STORES_AND_LOADS = (log.STORE, log.LOAD, log.WRITE_BACK, log.FILL, log.FETCH_LINE, log.TEST_AND_SET)


@pytest.mark.parametrize("gap_cclk", [1, 2, 3, 4, 7, 48])
@pytest.mark.parametrize("kinds", [(each, each) for each in STORES_AND_LOADS] + [(log.STORE, log.LOAD)])
def test_two_cores_take_turns_at_l2_in_both_modes(kinds: tuple[int, int], gap_cclk: int) -> None:
    """512 words each, to memory of their own, with arithmetic between: neither keeps the other away, to a cycle in a call."""

    def prepare(bench: Bench) -> None:
        for core, kind in enumerate(kinds):
            first = bench.l2 + core * 32_768
            accesses = [(gap_cclk * number, kind, first + 32 * number) for number in range(512)]
            bench.call(core, accesses, gap_cclk * 512)

    fast, detailed = same("cm-bf561", prepare)
    ours, theirs = ([end // bench.cclk for end, _ in bench.calls] for bench in (fast, detailed))
    assert ours == pytest.approx(theirs, abs=2)
    if (
        kinds[0] == kinds[1]
    ):  # who begins is ahead by one access at most, and a line takes eight cycles of the port
        assert max(ours) - min(ours) <= max(13, 0.01 * max(ours))
    for (_, split), (_, other) in zip(fast.calls, detailed.calls, strict=True):
        assert split == pytest.approx(other, abs=3)
    assert fast.traffic() == detailed.traffic()


@pytest.mark.parametrize("gap_cclk", [1, 3, 10, 40])
@pytest.mark.parametrize("kind", [log.LOAD, log.STORE])
@pytest.mark.parametrize(("source", "target"), [("l2", "l1"), ("l1", "l2"), ("l2", "l2")])
def test_imdma_and_a_core_share_the_port_of_l2(source: str, target: str, kind: int, gap_cclk: int) -> None:
    """1000 words of the internal DMA beside the accesses of a core: both are later than alone, as much in both modes."""
    spec = board_named("cm-bf561")
    alone_cclk = 1000 * spec.chip.dma.imdma_word_cclk * (2 if source == target else 1)

    def prepare(bench: Bench) -> None:
        places = {"l1": bench.l1, "l2": bench.l2}
        bench.transfer = bench.copy(places[source], places[target] + 8192, 1000, w.IMDMA_0)
        bench.call(
            0, [(gap_cclk * each, kind, bench.l2 + 32_768 + 4 * each) for each in range(400)], 400 * gap_cclk
        )

    fast, detailed = same("cm-bf561", prepare)
    assert fast.transfer.end == pytest.approx(detailed.transfer.end, abs=2 * fast.cclk)
    assert fast.transfer.end > alone_cclk * fast.cclk
    ((ours, our_stalls),), ((theirs, their_stalls),) = fast.calls, detailed.calls
    assert ours == pytest.approx(theirs, abs=2 * fast.cclk)
    assert our_stalls == pytest.approx(their_stalls, abs=2)
    assert our_stalls[w.L2_PORT] + our_stalls[w.STORE_BUFFER] > 0 or kind == log.STORE
    assert fast.traffic() == detailed.traffic()
    assert fast.content() == detailed.content()


@pytest.mark.parametrize("count", [1, 7, 1000])
@pytest.mark.parametrize(("source", "target"), [("l2", "l1"), ("l1", "l2"), ("l1", "l1")])
def test_imdma_alone_keeps_its_pace(source: str, target: str, count: int) -> None:
    """Two cycles a word, as without the port."""

    def copy(bench: Bench) -> None:
        places = {"l1": bench.l1, "l2": bench.l2}
        bench.transfer = bench.copy(places[source], places[target] + 8192, count, w.IMDMA_1)

    fast, detailed = same("cm-bf561", copy)
    word_cclk = fast.spec.chip.dma.imdma_word_cclk
    assert fast.transfer.end == detailed.transfer.end == count * word_cclk * fast.cclk
    assert fast.traffic() == detailed.traffic()


@pytest.mark.parametrize("kind", [log.LOAD, log.STORE])
def test_a_core_that_spins_takes_time_at_the_port_of_l2(kind: int) -> None:
    """Its tries lock the port for 11 of 19 cycles: loads of the other core wait for it, as long in both modes."""
    accesses = 300

    def prepare(bench: Bench) -> None:
        bench.call(
            0, [(10 * each, kind, bench.l2 + 8192 + 4 * each) for each in range(accesses)], 10 * accesses
        )
        bench.bus.cores.spin(1, 0)

    benches = [Bench(mode) for mode in MODES]
    for bench in benches:
        prepare(bench)
        bench.env.run(until=bench.env.timeout(40 * accesses * bench.cclk))
        bench.bus.settle()
    fast, detailed = benches
    ((ours, our_stalls),), ((theirs, their_stalls),) = fast.calls, detailed.calls
    assert ours == pytest.approx(theirs, abs=12 * fast.cclk)
    assert our_stalls == pytest.approx(their_stalls, abs=12)
    if kind == log.LOAD:
        assert accesses // 2 < our_stalls[w.L2_PORT] < 11 * accesses
    done = [bench.bus.cores.stop_spinning(1) for bench in benches]
    for bench, event in zip(benches, done, strict=True):
        bench.env.run(until=event)
    tries = [
        traffic[(w.NO_BUFFER_IN_L2 * w.MASTERS + w.CORE_B) * w.TRAFFIC_WORDS] // 4
        for traffic in (fast.traffic(), detailed.traffic())
    ]
    assert tries[0] == pytest.approx(40 * accesses / 19, rel=0.05)
    assert tries[0] == pytest.approx(tries[1], abs=2)


def accesses_by_chance(seed: int, core: int, bench: Bench) -> list[CoreAccess]:
    """Return 1500 reads and writes of all banks and of L2: some of what a frame has, so that chance evens out.

    The code of the call that makes them is in L2 and in SDRAM.
    """
    keep_code(bench.bus.logs, core, CODE_BYTES, bench.l2 + 4096, 3 * bench.bank)
    chance, stamp, found = Random(f"{seed} {core}"), 0, []
    memories = (*(number * bench.bank for number in range(4)), bench.l2)
    kinds = (log.LOAD, log.LOAD, log.FILL, log.FETCH, log.STORE, log.WRITE_BACK)
    for _ in range(1500):
        stamp += chance.choice((1, 5, 20, 60))
        found.append((stamp, chance.choice(kinds), chance.choice(memories) + 32 * chance.randrange(200)))
    return found


@pytest.mark.parametrize("gap_cclk", [1, 30])
def test_a_core_alone_waits_for_nobody(gap_cclk: int) -> None:
    """Two pages of a bank in turn, as fast as can be: its own tRAS is part of the page conflict, not arbitration."""

    def prepare(bench: Bench) -> None:
        bench.call(0, [(gap_cclk * each, log.LOAD, each % 2 * 8192 + 4 * each) for each in range(100)], 3000)

    fast, detailed = same("cm-bf561", prepare)
    assert fast.calls == detailed.calls
    assert fast.stalls()[w.PAGE_CONFLICT] > 0
    assert w.ARBITRATION not in fast.stalls()


@pytest.mark.exhaustive
def test_stalls_are_split_alike_in_both_modes() -> None:
    """Random traffic of both cores beside a stream and a camera: each reason to 5 % of it and 0.5 % of all stalls."""
    sums = []
    for mode in MODES:
        total = np.zeros(w.STALLS, np.int64)
        for seed in range(5):
            bench = Bench(mode)
            for core in (0, 1):
                accesses = accesses_by_chance(seed, core, bench)
                bench.call(core, accesses, accesses[-1][0] + 1, fetches=300)
            bench.copy(bench.l1, bench.bank, 500)
            bench.camera(2 * bench.bank, 8, 16, Fraction(20))
            bench.play()
            total += np.sum([stalls for _, stalls in bench.calls], axis=0)
        sums.append(total)
    ours, theirs = sums
    assert (theirs > 0).all()
    assert ours.tolist() == pytest.approx(theirs.tolist(), rel=0.05, abs=0.005 * int(theirs.sum()))


@pytest.mark.exhaustive
@given(seed=st.integers(0, 1000), words=st.sampled_from((160, 500, 2000)), word_sclk=st.integers(2, 120))
@settings(max_examples=12, derandomize=True, phases=[Phase.generate])
def test_random_traffic_is_within_the_aims(seed: int, words: int, word_sclk: int) -> None:
    """Two cores in all memories, a stream to SDRAM and a camera: 5 % of each core's call, 2 % of the whole.

    20 cycles a word are VGA at 24 MHz, SCLK 120 MHz.
    """

    def prepare(bench: Bench) -> None:
        for core in (0, 1):
            accesses = accesses_by_chance(seed, core, bench)
            bench.call(core, accesses, accesses[-1][0] + 1, fetches=300)
        bench.transfers = [
            bench.copy(bench.l1, bench.bank, words),
            bench.camera(2 * bench.bank, 8, 16, Fraction(word_sclk)),
        ]

    fast, detailed = same("cm-bf561", prepare)
    ours, theirs = (sorted(end for end, _ in bench.calls) for bench in (fast, detailed))
    assert theirs == pytest.approx(ours, rel=0.05)
    ends = [[*(end for end, _ in each.calls), *(t.end for t in each.transfers)] for each in (fast, detailed)]
    assert max(ends[1]) == pytest.approx(max(ends[0]), rel=0.02)
    assert (fast.memories.arena == detailed.memories.arena).all()
