"""The port of L2 where the cores use it densely: that they go ahead there is only a short cut, whoever comes between."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.kernel.calls.access_log import FETCH_LINE, LOAD, STORE
from bfsim.machine.bus import state as w
from bfsim.machine.bus import weave
from bfsim.machine.bus.transfer_plans import TransferPlan
from tests.machine.bench import Bench, Call, keep_code
from tests.machine.bus.scenarios import digest_of
from tests.machine.rig import Play
from tests.tiers import tried

L2, SDRAM, L1 = 0xFEB0_1000, 0x0000_1000, 0xFF80_1000
ROW_BYTES, SITES = 4096, 2
Accesses = list[tuple[int, int, int]]
"""Of a call: the cycle of each, its kind and address."""
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


class Port:
    """Both cores at the port, one of which may spin on a lock, and perhaps a memory DMA."""

    def __init__(self, chance: Random, bound: weave.Weave = weave.compiled_weave) -> None:
        self.bench = Bench(dma_over_core=chance.choice([True, False]), weave=bound)
        rows = [self.bench.row(place, ROW_BYTES) for place in (L2, SDRAM, L1)]
        self.calls: list[Call] = []
        spins = chance.choice([None, 0, 1])
        for core in range(w.CORES):
            keep_code(self.bench.bus.logs, core, 40, self.bench.offset(L2 + ROW_BYTES))
            begin = chance.randint(0, 500)
            if core == spins:
                self.bench.env.process(self._spin(core, begin, chance.randint(0, 20_000)))
            else:
                works = [
                    (dense_accesses(chance), chance.choice([0, 0, 5, 40]))
                    for _ in range(chance.randint(1, 3))
                ]
                self.bench.env.process(self._work(core, begin, works))
        if chance.random() < 0.5:
            stream = self.bench.new_stream(chance.choice([w.MDMA1_0, w.MDMA2_0, w.IMDMA_0]))
            source, target = chance.sample(rows if stream.master != w.IMDMA_0 else [rows[0], rows[2]], 2)
            self.bench.env.process(self._copy(stream.plan(source, target), chance.randint(0, 9000)))

    def _work(self, core: int, begin: int, works: list[tuple[Accesses, int]]) -> Play:
        yield self.bench.env.timeout(begin)
        for accesses, fetches in works:
            cclk = accesses[-1][0] + len(accesses) + fetches * (fetches + len(accesses))
            call = self.bench.call(core, accesses, begin=self.bench.env.tick, cclk=cclk, fetches=fetches)
            self.calls.append(call)
            yield call.event

    def _spin(self, core: int, begin: int, ticks: int) -> Play:
        yield self.bench.env.timeout(begin)
        self.bench.bus.cores.spin(core, self.bench.env.tick)
        yield self.bench.env.timeout(ticks)
        yield self.bench.bus.cores.stop_spinning(core)

    def _copy(self, plan: TransferPlan, begin: int) -> Play:
        yield self.bench.env.timeout(begin)
        self.bench.bus.post(plan)

    def play(self, stops: Iterable[int] = ()) -> dict[str, object]:
        """Play everything, settling the bus at these ticks on the way; return what is left behind."""
        self.bench.env.process(self.bench.settling(stops))
        self.bench.play()
        logs = self.bench.bus.logs
        return {
            "calls": [(each.end, each.stalls) for each in self.calls],
            "words": digest_of(self.bench.bus.words),
            "sites": [logs.stalls_at_sites(core)[:SITES].tolist() for core in range(w.CORES)],
        }


@given(seed=chances, stops=st.lists(st.integers(0, 30_000), max_size=40))
def test_it_does_not_matter_when_the_bus_is_played(seed: int, stops: list[int]) -> None:
    """In many steps or in one: the same ends, stalls, traffic and sites."""
    assert Port(Random(seed)).play(sorted(stops)) == Port(Random(seed)).play()


@tried(300, 2000)
def test_going_ahead_is_a_short_cut_only(examples: int) -> None:
    """One access after the other, in plain Python, is the same."""

    @settings(max_examples=examples)
    @given(seed=chances)
    def holds(seed: int) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(weave, "go_ahead", lambda *_: False)
            step_by_step = Port(Random(seed), weave.plain_weave).play()
        assert Port(Random(seed)).play() == step_by_step

    holds()
