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
from typing import Any

import numpy as np

from bfsim.chip.boards import board_named
from bfsim.kernel.calls.access_log import FETCH, FETCH_LINE, FILL, LOAD, STORE, WRITE_BACK
from bfsim.machine.bus import core_requests, dma_requests, runs, store_buffer
from bfsim.machine.bus import state as w
from bfsim.machine.bus.transfer_plans import Pace, Transfer, TransferPlan, Walk
from bfsim.machine.bus.weave import Weave, compiled_weave, plain_weave
from tests.machine.bench import Bench, Call, keep_code
from tests.machine.rig import Play

SDRAM_PLACES = (0x0000_1000, 0x0000_1F00, 0x0000_8000, 0x0080_1000, 0x0100_0700)
PLACES = (*SDRAM_PLACES, 0xFEB0_1000, 0xFF80_1000, 0xFF40_1000)
CORE_PLACES = (*SDRAM_PLACES, 0xFEB0_1000)
KINDS = (LOAD, LOAD, STORE, STORE, FILL, WRITE_BACK, FETCH, FETCH_LINE)
MDMA = (w.MDMA1_0, w.MDMA1_1, w.MDMA2_0, w.MDMA2_1)
OUTSIDE = 8192
NOISE = 4096  # bytes from each place on; no walk goes twice as far

# What the state tells of the last access alone: of a run of words it is the first, of single words the last.
OF_THE_LAST_ACCESS = (w.BEGAN, w.PAGE_CLASS, w.REFRESH_WAIT)


def digest_of(words: Any) -> str:
    """Return a digest of what the words of a bus say when everything is over."""
    counted = np.asarray(words[: w.SUBBANKS_AT])  # which place a transfer had means nothing
    told = np.setdiff1d(np.flatnonzero(counted), OF_THE_LAST_ACCESS, assume_unique=True)
    return hashlib.sha256(told.tobytes() + counted[told].tobytes()).hexdigest()


class Scene:
    """One scene, made by `chance`, ready to be played: who asks for what, and at which tick."""

    def __init__(self, chance: Random, weave: Weave = compiled_weave) -> None:
        spec = board_named(chance.choice(["cm-bf561", "cm-bf561-ratings", "bf561-ezkit"]))
        self.bench = Bench(
            replace(spec, sdram=replace(spec.sdram, rows_refreshed=chance.choice([4096, 120_000]))),
            outside_nbytes=OUTSIDE,
            weave=weave,
            dma_over_core=chance.choice([True, False]),
            deb_period_transfers=chance.choice([0, 0, 0, 4, 15]),
            mdma_period_transfers=chance.choice([0, 0, 0, 1, 8]),
        )
        for place in PLACES:
            self.bench.row(place, NOISE)
        ticks = [chance.choice([0, 0, chance.randint(0, 3000)]) for _ in range(9)]
        plans = [self._copy(chance) for _ in range(chance.randint(0, 6))]
        for master in (w.PPI0, w.PPI1):
            if chance.random() < 0.4:
                plans.append(self._receive(chance, master, ticks[len(plans)]))
        if chance.random() < 0.4:
            plans.append(self._send(chance, ticks[len(plans)]))
        self.transfers: list[Transfer] = []
        self.calls: list[Call] = []
        for plan, tick in zip(plans, ticks, strict=False):
            self.bench.env.process(self._post(plan, tick))
        for core in (0, 1):
            logs = [self._log(chance) for _ in range(chance.randint(0, 2))]
            nbytes, places = chance.randint(1, 99), chance.sample(CORE_PLACES, chance.randint(1, 3))
            keep_code(self.bench.bus.logs, core, nbytes, *map(self.bench.offset, places))
            self.bench.env.process(
                self._run(core, logs, chance.randint(0, 500), chance.choice([0, 0, 1, 12]))
            )

    def _walk(self, chance: Random, size: int, x_count: int) -> Walk:
        first = self.bench.offset(chance.choice(PLACES)) + size * chance.randint(0, 9)
        steps = [size * step for step in (1, 1, 1, 2, 5)]
        return Walk(first, x_count, chance.choice(steps), chance.choice(steps))

    def _copy(self, chance: Random) -> TransferPlan:
        size, lines = chance.choice([4, 4, 4, 2, 1]), chance.randint(1, 3)
        x_count = chance.choice([chance.randint(1, 8), chance.randint(20, 120)])
        return self.bench.bus.planner.copy(
            chance.choice(MDMA),
            self._walk(chance, size, x_count),
            self._walk(chance, size, x_count),
            x_count * lines,
            element_bytes=size,
            setup=self.bench.sclk(15),
        )

    def _pace(self, chance: Random, words: int, begin: int) -> Pace:
        word_ticks = Fraction(chance.randint(15, 300), chance.randint(1, 3))
        return Pace(
            begin + chance.randint(0, 500), words, word_ticks, words * word_ticks + chance.randint(0, 200)
        )

    def _receive(self, chance: Random, master: int, begin: int) -> TransferPlan:
        words, lines = chance.randint(1, 25), chance.randint(1, 5)
        outside = Walk(self.bench.memories.outside + master * OUTSIDE // 2, words, 4, 4)
        return self.bench.bus.planner.receive(
            master,
            outside,
            self._walk(chance, 4, words),
            words * lines,
            element_bytes=4,
            pace=self._pace(chance, words, begin),
        )

    def _send(self, chance: Random, begin: int) -> TransferPlan:
        words = chance.randint(1, 40)
        outside = Walk(self.bench.memories.outside, words, 2, 2)
        return self.bench.bus.planner.send(
            w.SPI,
            self._walk(chance, 2, words),
            outside,
            words,
            element_bytes=2,
            pace=self._pace(chance, words, begin),
        )

    def _log(self, chance: Random) -> list[tuple[int, int, int]]:
        stamp, accesses = 0, []
        for _ in range(chance.randint(1, 25)):
            stamp += chance.choice([0, 1, chance.randint(0, 40)])
            place = chance.choice(CORE_PLACES) + 4 * chance.randint(0, 50)
            accesses.append((stamp, chance.choice(KINDS), place))
        return accesses

    def _post(self, plan: TransferPlan, tick: int) -> Play:
        yield self.bench.env.timeout(tick)
        self.transfers.append(self.bench.bus.post(plan))

    def _run(self, core: int, logs: list[list[tuple[int, int, int]]], begin_cclk: int, fetches: int) -> Play:
        yield self.bench.env.timeout(self.bench.cclk(begin_cclk))
        for log in logs:
            cclk = max(
                log[-1][0] + len(log), fetches * (fetches + len(log))
            )  # each access has a cycle of its own
            call = self.bench.call(core, log, begin=self.bench.env.tick, cclk=cclk, fetches=fetches)
            self.calls.append(call)
            yield self.calls[-1].event

    def play(self, stops: Iterable[int] = ()) -> dict[str, object]:
        """Play to the end, settling the bus at these ticks on the way too; return what is left behind."""
        bus = self.bench.bus
        self.bench.env.process(self.bench.settling(stops))
        self.bench.play()
        return {
            "ends": [each.end for each in self.transfers],
            "calls": [
                [each.end, {str(reason): cclk for reason, cclk in each.stalls.items()}] for each in self.calls
            ],
            "words": digest_of(bus.words),
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

    for module in (runs, dma_requests, core_requests, store_buffer):
        module.access, module.stream = watched, watched_stream
    return grants


if __name__ == "__main__":
    noted = record_grants()
    for seed in map(int, sys.argv[1:]):
        left = Scene(Random(seed), plain_weave).play()
        print(json.dumps({"seed": seed, "left": left, "grants": noted}))  # noqa: T201
        noted.clear()
