"""The cost of each buffer: who accessed it, how often, over which bus, and who waited for it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from bfsim.report.profile.costs import cores_of, stages_in
from bfsim.trace import RunRecord, StallReason, TrafficRecord

BUSES = "L2", "SDRAM"
"""Memories that all masters share."""
IN_NO_BUFFER = "(in no buffer)"
"""Code, descriptors, semaphores."""


@dataclass(slots=True, kw_only=True)
class BufferProfile:
    """One buffer. `reads` and `writes` are elements that kernels accessed, `fills` lines that data caches fetched for them.

    Bytes and pages are those on the bus of its memory, by cores and DMA; `stall_cclk` is how long kernels waited for
    it.
    """

    buffer: str
    memory: str
    nbytes: int
    reads: int = 0
    writes: int = 0
    fills: int = 0
    core_bytes: int = 0
    dma_bytes: int = 0
    page_hits: int = 0
    page_misses: int = 0
    page_conflicts: int = 0
    stall_cclk: Counter[StallReason] = field(default_factory=Counter)

    @property
    def stalled_cclk(self) -> int:
        """Stalls for any reason."""
        return sum(self.stall_cclk.values())

    @property
    def cache_hits(self) -> float | None:
        """The part of the reads that hit a data cache, 0..1; None if no cache held lines of it."""
        return max(0.0, 1 - self.fills / self.reads) if self.fills and self.reads else None


def buffers_of(
    run: RunRecord, core: str | None = None, stage: str | None = None
) -> tuple[BufferProfile, ...]:
    """Return every buffer that was used, that with the longest waits first.

    Accesses and stalls are those of one core or of all, in one stage or in all; the traffic of a bus is always that of
    all masters in the whole run.
    """
    found = {
        each.buffer: BufferProfile(buffer=each.buffer, memory=each.memory, nbytes=each.nbytes)
        for each in run.buffers
    }
    cores, stages = cores_of(run, core), stages_in(run, stage)
    for access in run.accesses:
        if access.core in cores and access.stage in stages:
            mine = found.setdefault(
                access.buffer, BufferProfile(buffer=access.buffer or IN_NO_BUFFER, memory="", nbytes=0)
            )
            mine.reads += access.reads
            mine.writes += access.writes
            mine.fills += access.fills
            mine.stall_cclk.update(access.stall_cclk)
    for traffic in run.traffic:
        _add_traffic(found, traffic)
    used = (each for each in found.values() if _is_used(each))
    return tuple(sorted(used, key=lambda each: (-each.stalled_cclk, -each.core_bytes - each.dma_bytes)))


def _is_used(buffer: BufferProfile) -> bool:
    return any((buffer.reads, buffer.writes, buffer.core_bytes, buffer.dma_bytes, buffer.stalled_cclk))


def _add_traffic(found: dict[str, BufferProfile], traffic: TrafficRecord) -> None:
    key = traffic.buffer or ""
    mine = found.setdefault(key, BufferProfile(buffer=key or IN_NO_BUFFER, memory="", nbytes=0))
    nbytes = traffic.read_bytes + traffic.written_bytes
    if traffic.master.startswith("core"):
        mine.core_bytes += nbytes
    else:
        mine.dma_bytes += nbytes
    mine.page_hits += traffic.page_hits
    mine.page_misses += traffic.page_misses
    mine.page_conflicts += traffic.page_conflicts


@dataclass(frozen=True, slots=True, kw_only=True)
class TrafficProfile:
    """What a master moved to and from all buffers of a memory, and the share of the run in which it held the bus, 0..1."""

    traffic: TrafficRecord
    busy_share: float


def traffic_of(run: RunRecord) -> tuple[TrafficProfile, ...]:
    """Return what every master moved over each bus. Memories are shared, so it counts all cores and stages."""
    begin_cclk = run.frames[0].begin_cclk
    end_cclk = run.frames[-1].end_cclk
    sums: dict[tuple[str, str], list[TrafficRecord]] = {}
    for each in run.traffic:
        if each.memory in BUSES:
            sums.setdefault((each.memory, each.master), []).append(each)
    return tuple(
        TrafficProfile(traffic=each, busy_share=each.busy_cclk / (end_cclk - begin_cclk))
        for each in map(_together, sums.values())
    )


def _together(records: Sequence[TrafficRecord]) -> TrafficRecord:
    """Add up what one master moved to and from all buffers of one memory."""
    names = "read_bytes", "written_bytes", "page_hits", "page_misses", "page_conflicts", "busy_cclk"
    sums = {name: sum(getattr(each, name) for each in records) for name in names}
    return replace(records[0], buffer="", **sums)
