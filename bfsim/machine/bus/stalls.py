"""Why cores wait, in one table: the counters of the compiled code (`bus.state`), and their reasons in reports."""

from __future__ import annotations

from bfsim.machine.bus import state as w
from bfsim.trace import StallReason

REASON_OF = {
    w.L2_LATENCY: StallReason.L2_LATENCY,
    w.L2_PORT: StallReason.L2_PORT,
    w.PAGE_HIT: StallReason.SDRAM_PAGE_HIT,
    w.PAGE_MISS: StallReason.SDRAM_PAGE_MISS,
    w.PAGE_CONFLICT: StallReason.SDRAM_PAGE_CONFLICT,
    w.REFRESHING: StallReason.SDRAM_REFRESH,
    w.ARBITRATION: StallReason.EBIU_ARBITRATION,
    w.STORE_BUFFER: StallReason.STORE_BUFFER,
    w.CACHE_FILL: StallReason.CACHE_FILL,
    w.CODE_FETCH: StallReason.CODE_FETCH,
}
"""Reasons for which a kernel's accesses wait."""
BUS_STALLS = tuple(REASON_OF[counter] for counter in range(w.STALLS))
"""These reasons in the order of the counters."""

REASON_OF_ACCOUNT = {
    w.SETTING_UP: StallReason.DMA_SETUP,
    w.RING_EMPTY: StallReason.RING_EMPTY,
    w.RING_FULL: StallReason.RING_FULL,
}
"""Reasons for which the rings of a stretch wait."""
COUNTER_OF = {reason: counter for counter, reason in REASON_OF_ACCOUNT.items()}
