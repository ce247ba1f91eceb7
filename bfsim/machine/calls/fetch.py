"""Instruction fetch from outside L1: what the code of a kernel call asks of the memories, beside its data.

Cached code is fetched a line at a time, when the call first comes to it; a line is in the cache until others of its set were
used later. Code that is not cached is fetched 64 bits at a time, as often as it is executed, spread evenly over the call
(an approximation: nothing is fetched ahead, and where in the call is not known).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import CacheSpec
from bfsim.kernel import Work
from bfsim.kernel import access_trace as log
from bfsim.kernel.access_trace import AccessTrace
from bfsim.kernel.counters import Counter
from bfsim.machine.bus.state import FETCH_BYTES
from bfsim.machine.calls.groups import CallGroup
from bfsim.machine.memories import Row

SUBBANK_BYTES = 4096
Words = NDArray[np.int64]


class Runnable(Protocol):
    """A kernel bound to its rows."""

    def run(self, arguments: tuple[Row | int, ...]) -> Work:
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

    def __init__(self, places: Mapping[str, tuple[int, int]], cache: CodeCache | None) -> None:
        """`places`: (offset in the arena, bytes) of each routine outside L1."""
        self.cache = cache
        self.places = places

    def of(self, counters: Iterable[Counter]) -> Iterable[str]:
        """Return the routines of a kernel and its callees that lie outside L1."""
        routines = dict.fromkeys(each.routine for each in counters)
        return [each for each in routines if each in self.places]


class FetchedCall:
    """A call whose code lies outside L1: its fetches are added to what its access trace has."""

    def __init__(
        self, call: Runnable, group: CallGroup, code: CodeOutside, access_trace: AccessTrace
    ) -> None:
        self._call = call
        self._totals = group.totals
        self._access_trace = access_trace
        self._cache = code.cache
        places = [code.places[each] for each in group.fetched]
        sites = range(group.first_site + len(group.code.program.sites), group.first_site + group.site_count)
        self._pieces = list(zip(sites, places, strict=True))
        words = [np.arange(at, at + nbytes, FETCH_BYTES) for at, nbytes in places]
        self._turn = (
            np.concatenate(words) | log.FETCH << log.KIND_BIT,
            np.repeat(sites, [len(each) for each in words]),
        )
        self._numbers = np.arange(0)  # of words, as many as a call may have fetched,
        self._words, self._word_sites = self._turn  # and these, the code in turn
        self._lines = self._cached_lines(code.cache.line_bytes) if code.cache else []
        self._site_of = dict(reversed(self._lines))
        outside = [each.nbytes if each.routine in group.fetched else 0 for each in group.code.counters]
        self._nbytes = np.array(outside or [0], np.int64)

    def _cached_lines(self, line_bytes: int) -> list[tuple[int, int]]:
        """Return the cache lines that the code fills, each with the site that fetches it."""
        return [
            (line, site)
            for site, (offset, nbytes) in self._pieces
            for line in range(offset // line_bytes, (offset + nbytes - 1) // line_bytes + 1)
        ]

    def run(self, arguments: tuple[Row | int, ...]) -> Work:
        """Run the kernel now and say what it cost."""
        before = self._totals.copy()
        work = self._call.run(arguments)
        if self._cache:
            fetches, sites = self._line_fills(self._cache)
        else:
            fetches, sites = self._single_fetches(work, self._totals - before)
        if len(fetches):
            work.accesses = self._access_trace.insert(work.accesses, fetches, sites)
        return work

    def _line_fills(self, cache: CodeCache) -> tuple[Words, Words]:
        missed = np.array(cache.miss(line for line, _ in self._lines), np.int64)
        sites = [self._site_of[line] for line in missed.tolist()]
        return missed * cache.line_bytes | log.FETCH_LINE << log.KIND_BIT, np.array(sites, np.int64)

    def _single_fetches(self, work: Work, events: Words) -> tuple[Words, Words]:
        """One fetch for every 64 bits that were executed, from the routines' code in turn."""
        count = -(-int(events @ self._nbytes) // FETCH_BYTES)
        if count > len(self._numbers):
            self._numbers = np.arange(2 * count)
            self._words, self._word_sites = (np.resize(each, 2 * count) for each in self._turn)
        stamps = self._numbers[:count] * (work.issue_cclk + work.stall_cclk) // max(1, count)
        fetches: Words = stamps << log.STAMP_BIT | self._words[:count]
        return fetches, self._word_sites[:count]
