"""Who moved how much to and from which memory: counted as it happens, reported as records."""

from __future__ import annotations

from bfsim.trace import TrafficRecord


class Account:
    """What one master moved to and from one memory."""

    __slots__ = ("busy_ticks", "page_conflicts", "page_hits", "page_misses", "read_bytes", "written_bytes")

    def __init__(self) -> None:
        self.read_bytes = 0
        self.written_bytes = 0
        self.page_hits = 0
        self.page_misses = 0
        self.page_conflicts = 0
        self.busy_ticks = 0

    def add(self, nbytes: int, write: bool, hits: int, misses: int, conflicts: int, busy_ticks: int) -> None:
        """Count one burst."""
        if write:
            self.written_bytes += nbytes
        else:
            self.read_bytes += nbytes
        self.page_hits += hits
        self.page_misses += misses
        self.page_conflicts += conflicts
        self.busy_ticks += busy_ticks


class Traffic:
    """The accounts of a board, by memory and master."""

    def __init__(self) -> None:
        self._accounts: dict[tuple[str, str], Account] = {}

    def account(self, memory: str, master: str) -> Account:
        """Return the account of `master` at `memory`, opening it at the first time."""
        return self._accounts.setdefault((memory, master), Account())

    def records(self, cclk_ticks: int) -> tuple[TrafficRecord, ...]:
        """Return what was counted, sorted by memory and master; who moved nothing is left out."""
        return tuple(
            TrafficRecord(
                memory=memory,
                master=master,
                read_bytes=each.read_bytes,
                written_bytes=each.written_bytes,
                page_hits=each.page_hits,
                page_misses=each.page_misses,
                page_conflicts=each.page_conflicts,
                busy_cclk=each.busy_ticks // cclk_ticks,
            )
            for (memory, master), each in sorted(self._accounts.items())
            if each.read_bytes or each.written_bytes
        )
