"""Cores that use a memory densely, by chance: what they do is played on a bench, in many steps or in one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from random import Random

from bfsim.machine.bus import state as w
from bfsim.machine.bus.transfer_plans import TransferPlan
from tests.machine.bench import Bench, Call, keep_code
from tests.machine.bus.scenarios import digest_of
from tests.machine.rig import Play

SITES = 2
Accesses = list[tuple[int, int, int]]
"""Of a call: the cycle of each, its kind and address."""


class DenseCores:
    """Both cores, one of which may spin on a lock, and copies."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.calls: list[Call] = []

    def begin(self, chance: Random, accesses: Callable[[Random], Accesses], code_at: Sequence[int]) -> None:
        """Have each core make calls, with code at one of some addresses; or one of them spins."""
        spins = chance.choice([None, None, 0, 1])
        for core in range(w.CORES):
            keep_code(self.bench.bus.logs, core, 40, self.bench.offset(chance.choice(code_at)))
            begin = chance.randint(0, 500)
            if core == spins:
                self.bench.env.process(self._spin(core, begin, chance.randint(0, 20_000)))
            else:
                works = [
                    (accesses(chance), chance.choice([0, 0, 5, 40])) for _ in range(chance.randint(1, 3))
                ]
                self.bench.env.process(self._work(core, begin, works))

    def copy(self, plan: TransferPlan, begin: int) -> None:
        """Have a memory DMA copy something from a tick on."""
        self.bench.env.process(self._copy(plan, begin))

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
