"""Who moved how much to and from which memory: counted as it happens, reported as records."""

from __future__ import annotations

from bfsim.trace import TrafficRecord


class Traffic:
    """Counts per memory and master."""

    def __init__(self) -> None:
        # read bytes, written bytes, page hits, misses, conflicts, busy ticks
        self._counts: dict[tuple[str, str], list[int]] = {}

    def add(
        self, memory: str, master: str, nbytes: int, write: bool, pages: tuple[int, int, int], busy_ticks: int
    ) -> None:
        """Count one burst."""
        counts = self._counts.get((memory, master))
        if counts is None:
            counts = self._counts[memory, master] = [0] * 6
        counts[1 if write else 0] += nbytes
        counts[2] += pages[0]
        counts[3] += pages[1]
        counts[4] += pages[2]
        counts[5] += busy_ticks

    def records(self, cclk_ticks: int) -> tuple[TrafficRecord, ...]:
        """Return what was counted, sorted by memory and master."""
        return tuple(
            TrafficRecord(
                memory=memory,
                master=master,
                read_bytes=counts[0],
                written_bytes=counts[1],
                page_hits=counts[2],
                page_misses=counts[3],
                page_conflicts=counts[4],
                busy_cclk=counts[5] // cclk_ticks,
            )
            for (memory, master), counts in sorted(self._counts.items())
        )
