"""Instruction fetch from outside L1: what the code of a kernel call asks of the memories, beside its data.

Cached code is fetched a line at a time, when the call first comes to it; a line is in the cache until others of its set were
used later. Code that is not cached is fetched 64 bits at a time, as often as it is executed, spread evenly over the call
(an approximation: nothing is fetched ahead, and where in the call is not known).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bfsim.chip.spec import CacheSpec
from bfsim.kernel import Work
from bfsim.kernel import access_trace as log
from bfsim.kernel.access_trace import AccessTrace
from bfsim.kernel.counters import Counter
from bfsim.machine.bus.state import FETCH_BYTES
from bfsim.machine.calls.groups import CallGroup, Fetches
from bfsim.machine.memories import Row

SUBBANK_BYTES = 4096
KeepRoutine = Callable[[int, int, int, int], None]
"""Is told of a routine: its site, where it lies, its bytes, and the site of the one that is fetched behind it."""


class Runnable(Protocol):
    """A kernel bound to its rows."""

    def run(self, *arguments: Row | int) -> Work:
        """Run it."""


class CodeCache:
    """Tags of the code cache: `ways` lines a set, the one used last at the end of its list."""

    def __init__(self, spec: CacheSpec) -> None:
        self.line_bytes = spec.line_bytes
        self._ways = spec.code_ways
        sets = spec.code_bytes // (spec.line_bytes * spec.code_ways)
        self._sets: list[list[int]] = [[] for _ in range(sets)]

    def _set_of(self, line: int) -> int:
        """Return the set of a line: addr[9:5] in the sub-bank of 4 KB that addr[13:12] names (Programming Reference p.243)."""
        at = line * self.line_bytes
        per_bank = SUBBANK_BYTES // (self.line_bytes * self._ways)
        return at // SUBBANK_BYTES * per_bank % len(self._sets) + line % per_bank

    def miss(self, lines: Iterable[int]) -> list[int]:
        """Use `lines` one after the other; return those that were not there."""
        missed = []
        for line in lines:
            kept = self._sets[self._set_of(line)]
            if line in kept:
                kept.remove(line)
            else:
                missed.append(line)
                if len(kept) == self._ways:
                    del kept[0]
            kept.append(line)
        return missed


class CodeOutside:
    """The kernels of one core whose code lies outside L1, and the cache that holds it, if the LDF has one."""

    def __init__(
        self, places: Mapping[str, tuple[int, int]], cache: CodeCache | None, keep_routine: KeepRoutine
    ) -> None:
        """`places`: (offset in the arena, bytes) of each routine outside L1. `keep_routine` tells the bus of one that no cache holds."""
        self.places = places
        self._cache = cache
        self._keep_routine = keep_routine

    def of(self, counters: Iterable[Counter]) -> Iterable[str]:
        """Return the routines of a kernel and its callees that lie outside L1."""
        routines = dict.fromkeys(each.routine for each in counters)
        return [each for each in routines if each in self.places]

    def fetches_of(self, group: CallGroup, access_trace: AccessTrace) -> Fetches:
        """Return what calls of a group that have fetched routines tell an access trace of."""
        places = [self.places[each] for each in group.fetched]
        sites = range(group.first_site + len(group.code.program.sites), group.first_site + group.site_count)
        if self._cache:
            return LineFills(self._cache, dict(zip(sites, places, strict=True)), access_trace)
        for site, following, (offset, nbytes) in zip(sites, (*sites[1:], sites[0]), places, strict=True):
            self._keep_routine(site, offset, nbytes, following)
        return SingleFetches(group, sites[0], access_trace)


class LineFills:
    """Fetches of code that a cache holds. `places`: offset in the arena and bytes of each routine, by its site."""

    def __init__(
        self, cache: CodeCache, places: Mapping[int, tuple[int, int]], access_trace: AccessTrace
    ) -> None:
        self._cache = cache
        self._access_trace = access_trace
        self._lines = [
            (line, site)
            for site, (offset, nbytes) in places.items()
            for line in range(offset // cache.line_bytes, (offset + nbytes - 1) // cache.line_bytes + 1)
        ]
        self._site_of = dict(reversed(self._lines))

    def add(self, work: Work) -> int:
        """Add a fill of each line that was not there, at the beginning of the call."""
        missed = self._cache.miss(line for line, _ in self._lines)
        if not missed:
            return work.accesses
        places = np.array(missed, np.int64) * self._cache.line_bytes
        sites = np.array([self._site_of[line] for line in missed], np.int64)
        return self._access_trace.insert(work.accesses, places | log.FETCH_LINE << log.KIND_BIT, sites)


class SingleFetches:
    """Fetches of code that no cache holds: one for every 64 bits that were executed, from the routines' code in turn.

    The bus makes them (`bus.core_jobs.find_present`); the trace has their number only.
    """

    def __init__(self, group: CallGroup, first_site: int, access_trace: AccessTrace) -> None:
        self._access_trace = access_trace
        self._site = first_site
        self._totals = group.totals
        outside = [each.nbytes if each.routine in group.fetched else 0 for each in group.code.counters]
        self._nbytes = np.array(outside or [0], np.int64)
        self._executed = 0

    def add(self, work: Work) -> int:
        """Add as many as code has been executed since the last time."""
        before, self._executed = self._executed, int(self._totals.dot(self._nbytes))
        count = -(-(self._executed - before) // FETCH_BYTES)
        if not count:
            return work.accesses
        entry = count << log.STAMP_BIT | log.FETCHES << log.KIND_BIT
        return self._access_trace.add(work.accesses, entry, self._site)


@dataclass(frozen=True, slots=True)
class FetchedCall:
    """A call whose code lies outside L1: its fetches are added to what its access trace has."""

    call: Runnable
    fetches: Fetches

    def run(self, *arguments: Row | int) -> Work:
        """Run the kernel now and say what it cost."""
        work = self.call.run(*arguments)
        work.accesses = self.fetches.add(work)
        return work
