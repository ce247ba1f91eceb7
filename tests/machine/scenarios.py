"""Chance scenes on the bus: every master at work at a time, and all that is left behind when they are through.

Run as a program it plays one with its number, and prints what is left: for a process in which nothing is compiled.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from random import Random

from bfsim.chip.boards import board_named
from bfsim.kernel.followers import FETCH, FETCH_LINE, FILL, LOAD, STORE, WRITE_BACK
from bfsim.machine import bus_state as w
from bfsim.machine import core_requests, dma_requests
from bfsim.machine.bus import Pace, Transfer, Walk
from tests.machine.rig import Bench, Call

SDRAM_PLACES = (0x0000_1000, 0x0000_1F00, 0x0000_8000, 0x0080_1000, 0x0100_0700)
PLACES = (*SDRAM_PLACES, 0xFEB0_1000, 0xFF80_1000, 0xFF40_1000)
CORE_PLACES = (*SDRAM_PLACES, 0xFEB0_1000)
KINDS = (LOAD, LOAD, STORE, STORE, FILL, WRITE_BACK, FETCH, FETCH_LINE)
MDMA = (w.MDMA1_0, w.MDMA1_1, w.MDMA2_0, w.MDMA2_1)
OUTSIDE = 8192
NOISE = 4096  # bytes from each place on; no walk goes twice as far

# What the state tells of the last access alone: of a run of words it is the first, of single words the last.
OF_THE_LAST_ACCESS = {w.BEGAN, w.PAGE_CLASS, w.REFRESH_WAIT}


class Scene:
    """One scene, made by `chance`, ready to be played."""

    def __init__(self, chance: Random) -> None:
        spec = board_named(chance.choice(["cm-bf561", "cm-bf561-ratings", "bf561-ezkit"]))
        self.bench = Bench(
            replace(spec, sdram=replace(spec.sdram, rows_refreshed=chance.choice([4096, 120_000]))),
            outside_nbytes=OUTSIDE,
            dma_over_core=chance.choice([True, False]),
            deb_period=chance.choice([0, 0, 0, 4, 15]),
            mdma_period=chance.choice([0, 0, 0, 1, 8]),
        )
        for place in PLACES:
            self.bench.row(place, NOISE)
        self.copies = [self._copy(chance) for _ in range(chance.randint(0, 6))]
        self.pictures = [
            self._receive(chance, master) for master in (w.PPI0, w.PPI1) if chance.random() < 0.5
        ]
        self.sent = [self._send(chance) for _ in range(chance.randint(0, 1))]
        self.calls = [self._call(chance, core) for core in (0, 1) if chance.random() < 0.7]

    @property
    def transfers(self) -> list[Transfer]:
        """What any DMA does."""
        return [*self.copies, *self.pictures, *self.sent]

    def _walk(self, chance: Random, size: int, x_count: int) -> Walk:
        first = self.bench.offset(chance.choice(PLACES)) + size * chance.randint(0, 9)
        steps = [size * step for step in (1, 1, 1, 2, 5)]
        return Walk(first, x_count, chance.choice(steps), chance.choice(steps))

    def _copy(self, chance: Random) -> Transfer:
        size, x_count, lines = chance.choice([4, 4, 2, 1]), chance.randint(1, 30), chance.randint(1, 6)
        plan = self.bench.bus.plan_copy(
            chance.choice(MDMA),
            self._walk(chance, size, x_count),
            self._walk(chance, size, x_count),
            x_count * lines,
            element_bytes=size,
            setup=self.bench.sclk(15),
        )
        return self.bench.bus.post(plan, chance.randint(0, 3000))

    def _pace(self, chance: Random, words: int) -> Pace:
        word_ticks = Fraction(chance.randint(15, 300), chance.randint(1, 3))
        return Pace(chance.randint(0, 500), words, word_ticks, words * word_ticks + chance.randint(0, 200))

    def _receive(self, chance: Random, master: int) -> Transfer:
        words, lines = chance.randint(1, 25), chance.randint(1, 5)
        outside = Walk(self.bench.memories.outside + master * OUTSIDE // 2, words, 4, 4)
        target = self._walk(chance, 4, words)
        plan = self.bench.bus.plan_receive(
            master, outside, target, words * lines, element_bytes=4, pace=self._pace(chance, words)
        )
        return self.bench.bus.post(plan)

    def _send(self, chance: Random) -> Transfer:
        words = chance.randint(1, 40)
        outside = Walk(self.bench.memories.outside, words, 2, 2)
        source = self._walk(chance, 2, words)
        plan = self.bench.bus.plan_send(
            w.SPI, source, outside, words, element_bytes=2, pace=self._pace(chance, words)
        )
        return self.bench.bus.post(plan)

    def _call(self, chance: Random, core: int) -> Call:
        stamp, accesses = 0, []
        for _ in range(chance.randint(1, 25)):
            stamp += chance.randint(0, 40)
            place = chance.choice(CORE_PLACES) + 4 * chance.randint(0, 50)
            accesses.append((stamp, chance.choice(KINDS), place))
        begin = self.bench.cclk(chance.randint(0, 500))
        return self.bench.call(core, accesses, begin=begin, cclk=stamp + len(accesses))

    def play(self, stops: Iterable[int] = ()) -> dict[str, object]:
        """Play to the end, stopping at these ticks on the way; return what is left behind."""
        bus = self.bench.bus
        for stop in stops:
            while bus.play_until(stop):
                pass
        while bus.play_until(w.NEVER):
            pass
        self.bench.env.run()
        words = [
            0 if at in OF_THE_LAST_ACCESS else word for at, word in enumerate(bus.words[: w.ENDS_AT].tolist())
        ]
        return {
            "ends": [each.end for each in self.transfers],
            "calls": [
                [each.end, {str(reason): cclk for reason, cclk in each.stalls.items()}] for each in self.calls
            ],
            "words": hashlib.sha256(repr(words).encode()).hexdigest(),
            "memory": hashlib.sha256(b"".join(self._touched())).hexdigest(),
        }

    def _touched(self) -> Iterator[bytes]:
        """What lies in each place now, and what was sent to the outside."""
        for place in PLACES:
            yield self.bench.memories.bytes_from(self.bench.offset(place), 2 * NOISE).tobytes()
        yield self.bench.memories.bytes_from(self.bench.memories.outside, OUTSIDE).tobytes()


def record_grants() -> list[tuple[int, int]]:
    """Note from now on when each access held the bus; nothing must be compiled."""
    grants = []

    def watched(state, now, offset, write, access=dma_requests.access):
        through = access(state, now, offset, write)
        grants.append((int(state[w.BEGAN] + state[w.REFRESH_WAIT]), int(state[w.COMMAND_FREE])))
        return through

    def watched_stream(state, count, write, offset, stream=dma_requests.stream):
        before = int(state[w.COMMAND_FREE])
        through = stream(state, count, write, offset)
        grants.append((before, int(state[w.COMMAND_FREE])))
        return through

    for module in (dma_requests, core_requests):
        module.access, module.stream = watched, watched_stream
    return grants


if __name__ == "__main__":
    noted = record_grants()
    left = Scene(Random(int(sys.argv[1]))).play()
    print(json.dumps({"left": left, "grants": noted}))  # noqa: T201
