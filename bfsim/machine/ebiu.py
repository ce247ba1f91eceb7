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
from bfsim.machine.traffic import Account


class BurstRate(dict[int, int]):
    """SCLK cycles of a burst of so many 32-bit words on open pages: `latency_sclk`, then `word_sclk` a word."""

    def __init__(self, word_sclk: Fraction, latency_sclk: int = 0) -> None:
        super().__init__()
        self._word_sclk = word_sclk
        self._latency_sclk = latency_sclk

    def __missing__(self, words: int) -> int:
        # kept, since rows have few lengths
        sclk = self[words] = self._latency_sclk + ceil(words * self._word_sclk)
        return sclk


class Ebiu:
    """The external bus of one board."""

    def __init__(self, clocks: Clocks, sdram: Sdram) -> None:
        self._sclk_ticks = clocks.sclk_ticks
        self._sdram = sdram
        self._free_at = 0

    def burst(self, account: Account, now: int, row: Row, rate: BurstRate, *, write: bool) -> int:
        """Move a row to or from SDRAM at `rate`, for the master of `account`; return the tick at which it is done."""
        misses, conflicts = self._sdram.open(row.pages)
        sclk = rate[row.words]
        if misses or conflicts:
            sclk += self._sdram.extra_sclk(misses, conflicts)
        busy_ticks = sclk * self._sclk_ticks
        account.add(row.nbytes, write, row.words - misses - conflicts, misses, conflicts, busy_ticks)
        return self.hold(now, sclk) + busy_ticks

    def hold(self, now: int, sclk: int) -> int:
        """Take the bus for `sclk` cycles; return the tick at which they begin."""
        ticks = self._sclk_ticks
        start = -(-max(now, self._free_at) // ticks) * ticks  # the next SCLK edge
        self._free_at = start + sclk * ticks
        return start
