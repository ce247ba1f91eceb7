"""The stalls of an access to each memory, from the board's numbers: the cost of placements that no run has measured.

They are rough where cores and DMA meet, since the rest matters there. The next run measures the stalls, and then these
count.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.chip.spec import BoardSpec
from bfsim.placing.stretches import Level

CONFLICTS = 0.5
"""Share of a core's SDRAM accesses that find another page open. [assumed] Built-in firmware, all in SDRAM: 0.25 to 0.8."""
FULL = 0.5
"""Share of a store's time on its bus that the core waits. [assumed] The same firmware: 0.2 to 1.0."""
CODE_BYTES_A_CCLK = 1.3
"""Bytes of code that an issue cycle fetches: measured for the built-in firmware with all of its code in L2."""
FETCH_BYTES = 8  # what the core fetches at a time
WORD_BYTES = 4  # what an access of a cached line uses


@dataclass(frozen=True, slots=True)
class Latencies:
    """The latencies of a board."""

    board: BoardSpec

    def data_cclk(self, level: Level, reads: float, writes: float, *, is_cached: bool = False) -> float:
        """Return how long reads and writes of a memory stall. `is_cached`: through a data cache, in sequence."""
        match level:
            case Level.L2:
                assert self.board.chip.l2, "it has a segment"
                return (
                    reads * (self.board.chip.l2.read_cclk - 1) + writes * FULL * self.board.chip.l2.next_cclk
                )
            case Level.SDRAM if is_cached:
                fills = (reads + writes) * WORD_BYTES / self.board.chip.cache.line_bytes
                return fills * self._sdram_read_cclk
            case Level.SDRAM:
                return reads * self._sdram_read_cclk + writes * FULL * self._sclk(1 + self._conflict_sclk)
        return 0.0

    def code_cclk(self, level: Level, issue_cclk: float, *, is_cached: bool) -> float:
        """Return how long fetching code from a memory stalls a kernel with this many issue cycles."""
        if is_cached:
            return 0.0
        return self.data_cclk(level, issue_cclk * CODE_BYTES_A_CCLK / FETCH_BYTES, 0)

    @property
    def _sdram_read_cclk(self) -> float:
        """A read that waits for its data, without its own cycle."""
        sclk = self.board.chip.external.core_sync_sclk + self.board.sdram.nCL + self._conflict_sclk
        return self._sclk(sclk) - 1

    @property
    def _conflict_sclk(self) -> float:
        return CONFLICTS * self.board.sdram.conflict_sclk

    def _sclk(self, sclk: float) -> float:
        clocks = self.board.clocks
        return sclk * float(clocks.cclk_hz / clocks.sclk_hz)
