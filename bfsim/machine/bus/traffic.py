"""Who moved how much to and from which memory, from the counters of the bus."""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.machine.bus import state as w
from bfsim.trace import TrafficRecord

MASTERS = {
    "PPI0": (w.PPI0,),
    "PPI1": (w.PPI1,),
    "SPI": (w.SPI,),
    "MDMA1 stream 0": (w.MDMA1_0,),
    "MDMA1 stream 1": (w.MDMA1_1,),
    "MDMA2 stream 0": (w.MDMA2_0,),
    "MDMA2 stream 1": (w.MDMA2_1,),
    "IMDMA stream 0": (w.IMDMA_0,),
    "IMDMA stream 1": (w.IMDMA_1,),
    "core A": (w.CORE_A, w.STORES_A),
    "core B": (w.CORE_B, w.STORES_B),
}
MEMORIES = {"L2": w.IN_L2, "SDRAM": w.IN_SDRAM}


def traffic_records(words: Sequence[int], cclk_ticks: int) -> tuple[TrafficRecord, ...]:
    """Return what was counted in the state `words` of the bus, by memory and master; who moved nothing is left out."""
    records = []
    for memory, number in MEMORIES.items():
        for name, masters in MASTERS.items():
            total = [0] * w.TRAFFIC_WORDS
            for master in masters:
                first = w.TRAFFIC_AT + (master * w.MEMORIES + number) * w.TRAFFIC_WORDS
                for word in range(w.TRAFFIC_WORDS):
                    total[word] += words[first + word]
            read, written, hits, misses, conflicts, busy = total
            if read or written:
                records.append(
                    TrafficRecord(
                        memory=memory,
                        master=name,
                        read_bytes=read,
                        written_bytes=written,
                        page_hits=hits,
                        page_misses=misses,
                        page_conflicts=conflicts,
                        busy_cclk=busy // cclk_ticks,
                    )
                )
    return tuple(records)
