"""Direct accesses of a core to L2 and SDRAM, those that no DMA hides: what they stall, and their share of the bus.

A read waits for its data; a write is posted and only holds the bus. A call's accesses take the bus together at
the end of the call: their order against other masters is kept from call to call, not within one.
"""

from __future__ import annotations

from bfsim.chip.spec import BoardSpec
from bfsim.kernel.followers import Access
from bfsim.machine.ebiu import Ebiu
from bfsim.machine.memories import WORD_BYTES
from bfsim.machine.traffic import Traffic
from bfsim.trace import StallReason


class DirectAccess:
    """Costs of one core's accesses outside L1. Each occupies a 32-bit bus cycle, whatever its width."""

    def __init__(self, core: str, board: BoardSpec, ebiu: Ebiu, traffic: Traffic) -> None:
        self._ebiu = ebiu
        self._l2 = traffic.account("L2", f"core {core}")
        self._sdram = traffic.account("SDRAM", f"core {core}")
        self._ticks = board.clocks.cclk_ticks, board.clocks.sclk_ticks
        chip, sdram = board.chip, board.sdram
        self._l2_stall_cclk = chip.l2_read_cclk - 1  # the access's own issue cycle is counted already
        ratio = board.clocks.cclk_hz / board.clocks.sclk_hz

        def stall_cclk(extra_sclk: int) -> int:
            return -int(-((chip.core_sdram_read_sclk + extra_sclk) * ratio) // 1) - 1

        self._read_cclk = (stall_cclk(0), stall_cclk(sdram.miss_sclk), stall_cclk(sdram.conflict_sclk))
        opening = (0, sdram.miss_sclk, sdram.conflict_sclk)
        self._read_bus_sclk = tuple(sdram.nCL + 1 + each for each in opening)
        self._write_bus_sclk = tuple(chip.core_sdram_write_sclk + each for each in opening)

    def stalls(self, accesses: list[int]) -> list[tuple[StallReason, int]]:
        """Return the unloaded stalls of `accesses` (counts in the order of `Access`)."""
        found = []
        if accesses[Access.L2_READ]:
            found.append((StallReason.L2_LATENCY, accesses[Access.L2_READ] * self._l2_stall_cclk))
        reasons = (StallReason.SDRAM_PAGE_HIT, StallReason.SDRAM_PAGE_MISS, StallReason.SDRAM_PAGE_CONFLICT)
        reads = accesses[Access.PAGE_HIT_READ : Access.PAGE_HIT_WRITE]
        found += [
            (reason, n * each) for reason, n, each in zip(reasons, reads, self._read_cclk, strict=True) if n
        ]
        for access, write in ((Access.L2_READ, False), (Access.L2_WRITE, True)):
            count = accesses[access]
            self._l2.add(count * WORD_BYTES, write, 0, 0, 0, count * self._ticks[0])
        return found

    def uses_bus(self, accesses: list[int]) -> bool:
        """Whether any of `accesses` went to SDRAM."""
        return any(accesses[Access.PAGE_HIT_READ :])

    def arbitrate(self, accesses: list[int], now: int) -> int:
        """Take the bus for the SDRAM accesses of a call that ends at tick `now`; return the cycles it had to wait."""
        cclk_ticks, sclk_ticks = self._ticks
        total_sclk = 0
        for first, bus_sclk, write in (
            (Access.PAGE_HIT_READ, self._read_bus_sclk, False),
            (Access.PAGE_HIT_WRITE, self._write_bus_sclk, True),
        ):
            hits, misses, conflicts = accesses[first : first + 3]
            sclk = sum(n * each for n, each in zip((hits, misses, conflicts), bus_sclk, strict=True))
            nbytes = (hits + misses + conflicts) * WORD_BYTES
            self._sdram.add(nbytes, write, hits, misses, conflicts, sclk * sclk_ticks)
            total_sclk += sclk
        # the call held the bus while it ran, so only what other masters still had to do then delays it
        begin = (now // sclk_ticks - total_sclk) * sclk_ticks
        start = self._ebiu.hold(begin, total_sclk)
        waited = max(0, start + total_sclk * sclk_ticks - now)
        return -(-waited // cclk_ticks)
