"""Words of SDRAM that the cores use densely: that these are played in a loop of their own is only a short cut, whoever comes between."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.chip.boards import board_named
from bfsim.chip.spec import BoardSpec
from bfsim.kernel.calls.access_log import FETCH_LINE, FILL, LOAD, STORE, WRITE_BACK
from bfsim.machine.bus import state as w
from bfsim.machine.bus import weave
from tests.machine.bench import Bench
from tests.machine.bus.dense_cores import Accesses, DenseCores
from tests.tiers import tried

SDRAM = (0x0000_1000, 0x0000_1F00, 0x0000_9000, 0x0080_1000)
"""Places in two banks, three pages of one of them."""
L2, L1, ROW_BYTES = 0xFEB0_1000, 0xFF80_1000, 2048
MDMA = (w.MDMA1_0, w.MDMA1_1, w.MDMA2_0, w.MDMA2_1, w.IMDMA_0)
chances = st.integers(0, 2**32 - 1)


def board(chance: Random) -> BoardSpec:
    """Return a board with an SDRAM and priorities by chance."""
    spec = board_named(chance.choice(["cm-bf561", "cm-bf561-ratings", "bf561-ezkit"]))
    sdram = replace(
        spec.sdram,
        nCL=chance.choice([2, 3]),
        nRP=chance.randint(1, 5),
        nRCD=chance.randint(1, 4),
        nWR=chance.randint(1, 3),
        turn_round_sclk=chance.choice([0, 1, 3]),
        rows_refreshed=chance.choice([4096, 120_000]),
    )
    return replace(
        spec,
        sdram=sdram,
        dma_over_core=chance.choice([True, False]),
        deb_period_transfers=chance.choice([0, 0, 0, 4]),
        mdma_period_transfers=chance.choice([0, 0, 0, 3]),
    )


def dense_accesses(chance: Random) -> Accesses:
    """Return loads and stores of SDRAM, and now and then of L2 or lines; of few words loads find their stores in the buffer."""
    pause, words, stores = chance.choice([1, 2, 10, 40]), chance.choice([2, 20, 500]), chance.random()
    in_l2, lines = chance.choice([0, 0.02, 0.2]), chance.choice([0, 0.02, 0.2])
    stamp, accesses = 0, []
    for _ in range(chance.randint(1, 60)):
        stamp += chance.randint(0, pause)
        kind = STORE if chance.random() < stores else LOAD
        if chance.random() < lines:
            kind = chance.choice([FILL, WRITE_BACK, FETCH_LINE])
        place = L2 if chance.random() < in_l2 else chance.choice(SDRAM)
        accesses.append((stamp, kind, place + 4 * chance.randint(0, words)))
    return accesses


def words(chance: Random, bound: weave.Weave = weave.compiled_weave) -> DenseCores:
    """Return both cores at SDRAM, one of which may spin on a lock, and up to three memory DMAs."""
    bench = Bench(board(chance), weave=bound)
    rows, cores = [bench.row(place, ROW_BYTES) for place in (*SDRAM, L2, L1)], DenseCores(bench)
    cores.begin(chance, dense_accesses, [L2 + ROW_BYTES, SDRAM[0] + ROW_BYTES])
    for master in chance.sample(MDMA, chance.randint(0, 3)):
        on_chip = rows[len(SDRAM) :] if master == w.IMDMA_0 else rows
        plan = bench.new_stream(master).plan(*chance.sample(on_chip, 2))
        cores.copy(plan, chance.randint(0, 9000))
    return cores


@given(seed=chances, stops=st.lists(st.integers(0, 30_000), max_size=40))
def test_it_does_not_matter_when_the_bus_is_played(seed: int, stops: list[int]) -> None:
    """In many steps or in one: the same ends, stalls, traffic and sites."""
    assert words(Random(seed)).play(sorted(stops)) == words(Random(seed)).play()


@tried(60, 1000)
def test_words_in_a_loop_of_their_own_are_a_short_cut_only(examples: int) -> None:
    """One after the other, in plain Python, is the same."""

    @settings(max_examples=examples)
    @given(seed=chances)
    def holds(seed: int) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(weave, "is_word", lambda *_: False)
            step_by_step = words(Random(seed), weave.plain_weave).play()
        assert words(Random(seed)).play() == step_by_step

    holds()
