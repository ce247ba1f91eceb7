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


class Ebiu:
    """The external bus of one board."""

    def __init__(self, clocks: Clocks, sdram: Sdram, traffic: Traffic) -> None:
        self._clocks = clocks
        self._sclk_ticks = clocks.sclk_ticks
        self._sdram = sdram
        self._traffic = traffic
        self._free_at = 0
        self._streams: dict[tuple[Row, Fraction], int] = {}

    def burst(self, master: str, now: int, row: Row, word_sclk: Fraction, *, write: bool) -> int:
        """Move a row to or from SDRAM at `word_sclk` cycles a word; return the tick at which it is done."""
        hits, misses, conflicts = self._sdram.access(row.pages)
        sclk = self._stream_sclk(row, word_sclk) + self._sdram.extra_sclk(misses, conflicts)
        if not write:
            sclk += self._sdram.spec.nCL
        done = self._occupy(now, sclk) + sclk * self._sclk_ticks
        self._traffic.add("SDRAM", master, row.nbytes, write, (hits, misses, conflicts), sclk * self._sclk_ticks)
        return done

    def hold(self, now: int, sclk: int) -> int:
        """Take the bus for `sclk` cycles; return the tick at which they begin."""
        return self._occupy(now, sclk)

    def _occupy(self, now: int, sclk: int) -> int:
        start = self._clocks.next_sclk(max(now, self._free_at))
        self._free_at = start + sclk * self._sclk_ticks
        return start

    def _stream_sclk(self, row: Row, word_sclk: Fraction) -> int:
        """Cycles of the words alone; kept per row, since rows move again every frame."""
        key = (row, word_sclk)
        known = self._streams.get(key)
        if known is None:
            known = self._streams[key] = ceil(sum(words for _, _, words in row.pages) * word_sclk)
        return known
