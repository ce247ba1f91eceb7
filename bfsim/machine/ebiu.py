"""EBIU: the one bus to SDRAM. It is granted a burst at a time, in the order of the requests.

State is the tick from which the bus is free; the time is an argument and SimPy is not needed. Callers must ask
in the order of time. Not modelled yet: priorities between masters, bursts that interleave.
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil

from bfsim.clocks import Clocks
from bfsim.machine.memories import Row
from bfsim.machine.sdram import Sdram
from bfsim.machine.traffic import Traffic


class BurstRate:
    """Cycles of a stream of 32-bit words on an open page, `word_sclk` each; kept per length, rows being few."""

    def __init__(self, word_sclk: Fraction) -> None:
        self._word_sclk = word_sclk
        self._known: dict[int, int] = {}

    def sclk(self, words: int) -> int:
        """Return the SCLK cycles of `words` words."""
        known = self._known.get(words)
        if known is None:
            known = self._known[words] = ceil(words * self._word_sclk)
        return known


class Ebiu:
    """The external bus of one board."""

    def __init__(self, clocks: Clocks, sdram: Sdram, traffic: Traffic) -> None:
        self._sclk_ticks = clocks.sclk_ticks
        self._sdram = sdram
        self._traffic = traffic
        self._free_at = 0

    def burst(self, master: str, now: int, row: Row, rate: BurstRate, *, write: bool) -> int:
        """Move a row to or from SDRAM at `rate`; return the tick at which it is done."""
        hits, misses, conflicts = self._sdram.access(row.pages)
        sclk = rate.sclk(row.words) + self._sdram.extra_sclk(misses, conflicts)
        if not write:
            sclk += self._sdram.spec.nCL
        done = self._occupy(now, sclk) + sclk * self._sclk_ticks
        self._traffic.add("SDRAM", master, row.nbytes, write, (hits, misses, conflicts), sclk * self._sclk_ticks)
        return done

    def hold(self, now: int, sclk: int) -> int:
        """Take the bus for `sclk` cycles; return the tick at which they begin."""
        return self._occupy(now, sclk)

    def _occupy(self, now: int, sclk: int) -> int:
        ticks = self._sclk_ticks
        start = -(-max(now, self._free_at) // ticks) * ticks  # the next SCLK edge
        self._free_at = start + sclk * self._sclk_ticks
        return start
