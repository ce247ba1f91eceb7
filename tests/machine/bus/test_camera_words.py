"""Words of cameras that hit their open pages: that they are taken all at once is a short cut only, whatever their pace."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.machine.bus import state as w
from bfsim.machine.bus import weave
from bfsim.machine.bus.transfer_plans import Pace, TransferPlan, Walk
from tests.machine.bench import Bench
from tests.machine.bus.scenarios import digest_of
from tests.tiers import tried

LINES_NBYTES = 4 * 200 * 3
PLACES = (0x0000_1000, 0x0000_1F00, 0x0080_1000, 0x0100_0700)
"""In three banks of SDRAM, two of them in one."""
PPIS = (w.PPI0, w.PPI1)


class Cameras:
    """One or two cameras made by `chance`, most often of one pace and begun together, and perhaps a memory DMA."""

    def __init__(self, chance: Random, bound: weave.Weave = weave.compiled_weave) -> None:
        self.bench = Bench(weave=bound, outside_nbytes=2 * LINES_NBYTES)
        for place in PLACES:
            self.bench.row(place, LINES_NBYTES)
        words, begin = chance.randint(1, 200), chance.randint(0, 99)
        pace = self._pace(chance, begin, words)
        for number, place in enumerate(chance.sample(PLACES, chance.choice([1, 2, 2, 2]))):
            own = pace if chance.random() < 0.7 else self._pace(chance, begin, words)
            self.bench.bus.post(self._receive(PPIS[number], number, place, words, own))
        if chance.random() < 0.3:
            rows = [self.bench.row(place, 400) for place in (PLACES[3], 0xFF80_1000)]
            self.bench.bus.post(self.bench.new_stream().plan(*chance.sample(rows, 2)))

    def _pace(self, chance: Random, begin: int, words: int) -> Pace:
        word_ticks = Fraction(chance.randint(15, 300), chance.choice([1, 2, 3, 7]))
        return Pace(
            begin + chance.choice([0, 0, 3, 5, 17]),
            words,
            word_ticks,
            words * word_ticks + chance.randint(0, 99),
        )

    def _receive(self, master: int, number: int, place: int, words: int, pace: Pace) -> TransferPlan:
        outside = Walk(self.bench.memories.outside + number * LINES_NBYTES, words, 4, 4)
        target = Walk(self.bench.offset(place), words, 4, 4)
        return self.bench.bus.planner.receive(master, outside, target, 3 * words, element_bytes=4, pace=pace)

    def play(self) -> tuple[str, bytes]:
        """Play everything; return what is left behind, in the bus and in the memories."""
        self.bench.play()
        return digest_of(self.bench.bus.words), b"".join(
            self.bench.memories.bytes_from(self.bench.offset(place), LINES_NBYTES).tobytes()
            for place in PLACES
        )


@tried(150, 1500)
def test_taking_all_words_at_once_is_a_short_cut_only(examples: int) -> None:
    """One word after the other, in plain Python, is the same."""

    @settings(max_examples=examples)
    @given(seed=st.integers(0, 2**32 - 1))
    def holds(seed: int) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(weave, "take_hits", lambda *_: None)
            one_by_one = Cameras(Random(seed), weave.plain_weave).play()
        assert Cameras(Random(seed)).play() == one_by_one

    holds()
