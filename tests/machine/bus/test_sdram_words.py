"""Words of SDRAM that the cores use densely: that these are played in a loop of their own is only a short cut, whoever comes between."""

from __future__ import annotations

from collections.abc import Iterable
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
from bfsim.machine.bus.transfer_plans import TransferPlan
from tests.machine.bench import Bench, Call, keep_code
from tests.machine.bus.scenarios import digest_of
from tests.machine.rig import Play
from tests.tiers import tried

SDRAM = (0x0000_1000, 0x0000_1F00, 0x0000_9000, 0x0080_1000)
"""Places in two banks, three pages of one of them."""
L2, L1, ROW_BYTES, SITES = 0xFEB0_1000, 0xFF80_1000, 2048, 2
MDMA = (w.MDMA1_0, w.MDMA1_1, w.MDMA2_0, w.MDMA2_1, w.IMDMA_0)
Accesses = list[tuple[int, int, int]]
"""Of a call: the cycle of each, its kind and address."""
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


class Words:
    """Both cores at SDRAM, one of which may spin on a lock, and up to three memory DMAs."""

    def __init__(self, chance: Random, bound: weave.Weave = weave.compiled_weave) -> None:
        self.bench = Bench(board(chance), weave=bound)
        rows = [self.bench.row(place, ROW_BYTES) for place in (*SDRAM, L2, L1)]
        self.calls: list[Call] = []
        spins = chance.choice([None, None, 0, 1])
        for core in range(w.CORES):
            code = self.bench.offset(chance.choice([L2 + ROW_BYTES, SDRAM[0] + ROW_BYTES]))
            keep_code(self.bench.bus.logs, core, 40, code)
            begin = chance.randint(0, 500)
            if core == spins:
                self.bench.env.process(self._spin(core, begin, chance.randint(0, 20_000)))
            else:
                works = [
                    (dense_accesses(chance), chance.choice([0, 0, 5, 40]))
                    for _ in range(chance.randint(1, 3))
                ]
                self.bench.env.process(self._work(core, begin, works))
        for master in chance.sample(MDMA, chance.randint(0, 3)):
            on_chip = rows[len(SDRAM) :] if master == w.IMDMA_0 else rows
            plan = self.bench.new_stream(master).plan(*chance.sample(on_chip, 2))
            self.bench.env.process(self._copy(plan, chance.randint(0, 9000)))

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
    assert Words(Random(seed)).play(sorted(stops)) == Words(Random(seed)).play()


@tried(60, 1000)
def test_words_in_a_loop_of_their_own_are_a_short_cut_only(examples: int) -> None:
    """One after the other, in plain Python, is the same."""

    @settings(max_examples=examples)
    @given(seed=chances)
    def holds(seed: int) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(weave, "is_word", lambda *_: False)
            step_by_step = Words(Random(seed), weave.plain_weave).play()
        assert Words(Random(seed)).play() == step_by_step

    holds()
