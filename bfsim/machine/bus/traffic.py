"""Who moved how much to and from which memory: counted in compiled code, read at the end of a run."""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.kernel.native import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.state import State
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


@native
def count_traffic(state: State, master: int, memory: int, write: bool, nbytes: int) -> None:
    """Count bytes that a master moved to or from a memory."""
    at = w.TRAFFIC_AT + (master * w.MEMORIES + memory) * w.TRAFFIC_WORDS
    state[at + (w.WRITTEN_BYTES if write else w.READ_BYTES)] += nbytes


@native
def count_access(state: State, master: int, elements: int) -> None:
    """Count `elements` accesses of SDRAM, the first of which was the controller's last one, and the time they took."""
    at = w.TRAFFIC_AT + (master * w.MEMORIES + w.IN_SDRAM) * w.TRAFFIC_WORDS
    state[at + w.HITS + state[w.PAGE_CLASS]] += 1
    state[at + w.HITS] += elements - 1
    state[at + w.BUSY] += state[w.COMMAND_FREE] - state[w.BEGAN] - state[w.REFRESH_WAIT]


@native
def count_subbanks(state: State, side: int, count: int) -> None:
    """Count what the next `count` elements of a side move to or from each sub-bank of L1."""
    first, bits = state[w.L1_FIRST], state[w.SUBBANK_BITS]
    at = state[side + w.POSITION] - first
    if at < 0:
        return
    if (at + (count - 1) * state[side + w.X_MODIFY]) >> bits == at >> bits:
        state[w.SUBBANKS_AT + (at >> bits)] += count
        return
    for _ in range(count):
        state[w.SUBBANKS_AT + (at >> bits)] += 1
        at += state[side + w.X_MODIFY]
