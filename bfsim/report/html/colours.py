"""Meaningful colours of a page, clear on both white and black. We chose all of them."""

from __future__ import annotations

from collections.abc import Iterable

from bfsim.trace import REST, StallReason

STAGES = ("#4e8fd0", "#e08a3c", "#4fa885", "#c767a8", "#b59a2f", "#7b78d6", "#d0605e", "#5aa7b8", "#8f8f4a")
REST_COLOUR = "#8d96a5"

ISSUE = "#4e8fd0"
IDLE = "#aab2bf"
STALLS = {
    StallReason.L1_CONFLICT: "#7b78d6",
    StallReason.L2_LATENCY: "#9b6fd0",
    StallReason.L2_PORT: "#b58be0",
    StallReason.SDRAM_PAGE_HIT: "#f0a35c",
    StallReason.SDRAM_PAGE_MISS: "#e5793b",
    StallReason.SDRAM_PAGE_CONFLICT: "#d0503a",
    StallReason.SDRAM_REFRESH: "#a8402f",
    StallReason.EBIU_ARBITRATION: "#b3453f",
    StallReason.STORE_BUFFER: "#c98a5a",
    StallReason.CACHE_FILL: "#c767a8",
    StallReason.CODE_FETCH: "#a4528a",
    StallReason.DMA_SETUP: "#c9b13a",
    StallReason.INTERRUPT: "#a89a4a",
    StallReason.RING_EMPTY: "#d9c55a",
    StallReason.RING_FULL: "#8f8f3a",
    StallReason.SEMAPHORE: "#4fa885",
    StallReason.INTERLOCK: "#8fbce6",
}
"""SDRAM is red, L1 and L2 violet, waits for caches and code pink, DMA yellow, the other core green."""

MEANINGS = {"work": ISSUE, "stall": "#d0503a", "idle": IDLE, "busy": "#c9a227"}
"""The meanings of a bar of a core, or of a device."""


def stage_colours(names: Iterable[str]) -> dict[str, str]:
    """Return a colour for each stage; colours repeat only after all have been used."""
    stages = [name for name in names if name != REST]
    return {
        **{name: STAGES[number % len(STAGES)] for number, name in enumerate(stages)},
        REST: REST_COLOUR,
    }
