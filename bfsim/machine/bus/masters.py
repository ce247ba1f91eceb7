"""The masters of the buses in one table: their names, ranks and streams. Everything else about them is derived from it."""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.machine.bus import state as w


@dataclass(frozen=True, slots=True)
class DmaMaster:
    """A DMA: its row in `bus.state`, its name in reports, and its rank. The lowest rank is served first.

    `stream` names the registers of a memory DMA. `partner` is the other stream of its controller, with which it takes
    turns if the board says so, or NONE.
    """

    number: int
    name: str
    rank: int
    stream: str = ""
    partner: int = w.NONE


# Ranks: HRM of the BF537, 5-50 to 5-54 (lower channel first, memory DMA last); DMA1 before DMA2 [assumed].
DMA_MASTERS = (
    DmaMaster(w.PPI0, "PPI0", 0),
    DmaMaster(w.PPI1, "PPI1", 1),
    DmaMaster(w.SPI, "SPI", 40),
    DmaMaster(w.UART_RX, "UART RX", 41),
    DmaMaster(w.UART_TX, "UART TX", 42),
    DmaMaster(w.MDMA1_0, "MDMA1 stream 0", 20, "MDMA1_0", w.MDMA1_1),
    DmaMaster(w.MDMA1_1, "MDMA1 stream 1", 21, "MDMA1_1", w.MDMA1_0),
    DmaMaster(w.MDMA2_0, "MDMA2 stream 0", 44, "MDMA2_0", w.MDMA2_1),
    DmaMaster(w.MDMA2_1, "MDMA2 stream 1", 45, "MDMA2_1", w.MDMA2_0),
    DmaMaster(w.IMDMA_0, "IMDMA stream 0", 48, "IMDMA_0"),
    DmaMaster(w.IMDMA_1, "IMDMA stream 1", 49, "IMDMA_1"),
)
RANKS = {each.number: each.rank for each in DMA_MASTERS}
PARTNERS = {each.number: each.partner for each in DMA_MASTERS if each.partner != w.NONE}
STREAMS = {each.stream: each.number for each in DMA_MASTERS if each.stream}
"""Memory DMA streams by the names of their registers."""
INTERNAL = (w.IMDMA_0, w.IMDMA_1)
"""The streams of the internal DMA."""
RING_STREAMS = ((w.MDMA1_0, w.MDMA1_1), (w.MDMA2_0, w.MDMA2_1))
"""The streams of each core: for its input rings and its output rings."""

CORE_ROWS = {"core A": (w.CORE_A, w.STORES_A), "core B": (w.CORE_B, w.STORES_B)}
"""A core has two rows: one for accesses that it waits for, one for its store buffer."""
NAMED = {each.name: (each.number,) for each in DMA_MASTERS} | CORE_ROWS
"""The rows of each master, by its name in reports."""

CORE_FIRST, CORE_LAST = -100, 200  # ranks of core A; core B has its own turn after A had the bus
STORES_AFTER = 10  # loads overtake stores (Programming Reference p.294)


def ranks_of(*, dma_over_core: bool) -> dict[int, int]:
    """Return the rank of every row, with the DMAs before or after the cores."""
    cores = CORE_LAST if dma_over_core else CORE_FIRST
    loads = {w.CORE_A + core: cores + core for core in range(w.CORES)}
    stores = {w.STORES_A + core: cores + STORES_AFTER + core for core in range(w.CORES)}
    return RANKS | loads | stores
