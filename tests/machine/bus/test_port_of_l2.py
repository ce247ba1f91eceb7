"""The port of L2 where the cores use it densely: that they go ahead there is only a short cut, whoever comes between."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.kernel.calls.access_log import FETCH_LINE, LOAD, STORE
from bfsim.machine.bus import state as w
from bfsim.machine.bus import weave
from tests.machine.bench import Bench
from tests.machine.bus.dense_cores import Accesses, DenseCores
from tests.tiers import tried

L2, SDRAM, L1 = 0xFEB0_1000, 0x0000_1000, 0xFF80_1000
ROW_BYTES = 4096
chances = st.integers(0, 2**32 - 1)


def dense_accesses(chance: Random) -> Accesses:
    """Return loads and stores of L2, and now and then something else; of few words loads find their stores in the buffer."""
    pause, words, stores = chance.choice([1, 2, 10, 40]), chance.choice([2, 20, 500]), chance.random()
    stamp, accesses = 0, []
    for _ in range(chance.randint(1, 60)):
        stamp += chance.randint(0, pause)
        kind = STORE if chance.random() < stores else LOAD
        if chance.random() < 0.02:
            kind = FETCH_LINE
        place = SDRAM if chance.random() < 0.03 else L2
        accesses.append((stamp, kind, place + 4 * chance.randint(0, words)))
    return accesses


def port(chance: Random, bound: weave.Weave = weave.compiled_weave) -> DenseCores:
    """Return both cores at the port, one of which may spin on a lock, and perhaps a memory DMA."""
    bench = Bench(dma_over_core=chance.choice([True, False]), weave=bound)
    rows, cores = [bench.row(place, ROW_BYTES) for place in (L2, SDRAM, L1)], DenseCores(bench)
    cores.begin(chance, dense_accesses, [L2 + ROW_BYTES])
    if chance.random() < 0.5:
        stream = bench.new_stream(chance.choice([w.MDMA1_0, w.MDMA2_0, w.IMDMA_0]))
        source, target = chance.sample(rows if stream.master != w.IMDMA_0 else [rows[0], rows[2]], 2)
        cores.copy(stream.plan(source, target), chance.randint(0, 9000))
    return cores


@given(seed=chances, stops=st.lists(st.integers(0, 30_000), max_size=40))
def test_it_does_not_matter_when_the_bus_is_played(seed: int, stops: list[int]) -> None:
    """In many steps or in one: the same ends, stalls, traffic and sites."""
    assert port(Random(seed)).play(sorted(stops)) == port(Random(seed)).play()


@tried(300, 2000)
def test_going_ahead_is_a_short_cut_only(examples: int) -> None:
    """One access after the other, in plain Python, is the same."""

    @settings(max_examples=examples)
    @given(seed=chances)
    def holds(seed: int) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(weave, "go_ahead", lambda *_: False)
            step_by_step = port(Random(seed), weave.plain_weave).play()
        assert port(Random(seed)).play() == step_by_step

    holds()
