"""Instruction fetch from outside L1: the accesses of a kernel call for its code, besides its data.

Cached code is fetched line by line, at the beginning of the call. A line stays in the cache until enough other lines of its set
have been used later. Uncached code is fetched 64 bits at a time, as often as it is executed, spread evenly over the call
(an approximation: nothing is fetched ahead, and the exact moments in the call are unknown).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from itertools import chain, repeat

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.block_spec import CacheSpec
from bfsim.kernel import Work
from bfsim.kernel.calls.access_log import FUNCTION
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.kernel.calls.python_calls import log_of
from bfsim.kernel.native.entries import NativeEntry
from bfsim.machine.calls import code_fetches as c
from bfsim.machine.calls.groups import CallGroup, Fetches
from bfsim.machine_code.calling import followed_call

KeepRoutine = Callable[[int, int, int, int], None]
"""Called with a routine: its site, its offset, its bytes, and the site of the routine fetched after it."""


class CodeCache:
    """The tags of a core's code cache, in `words` as compiled code expects them."""

    def __init__(self, spec: CacheSpec) -> None:
        self.line_bytes = spec.line_bytes
        sets = spec.code_bytes // (spec.line_bytes * spec.code_ways)
        self.words = np.full(c.TAGS + sets * spec.code_ways, c.NO_LINE, np.int64)
        self.words[: c.TAGS] = spec.line_bytes, spec.code_ways, sets


class CodeOutside:
    """The routines of one core outside L1, and the cache that holds them, if the LDF enables it."""

    def __init__(
        self, places: Mapping[str, tuple[int, int]], cache: CodeCache | None, keep_routine: KeepRoutine
    ) -> None:
        """`places` has (offset in the arena, bytes) of each routine outside L1. `keep_routine` tells the bus about an uncached one."""
        self.places = places
        self._cache = cache
        self._keep_routine = keep_routine

    def of(self, routines: Iterable[str]) -> Iterable[str]:
        """Return those of a kernel's and its callees' routines that lie outside L1."""
        return [each for each in routines if each in self.places]

    def fetches_of(self, group: CallGroup, access_trace: AccessTrace) -> Fetches:
        """Return the fetches that calls of a group add to an access trace."""
        places = [self.places[each] for each in group.fetched]
        sites = range(
            group.first_site + len(group.code.tables.site_routines), group.first_site + group.site_count
        )
        if self._cache:
            return LineFills(self._cache, dict(zip(sites, places, strict=True)), access_trace)
        for site, following, (offset, nbytes) in zip(sites, (*sites[1:], sites[0]), places, strict=True):
            self._keep_routine(site, offset, nbytes, following)
        return SingleFetches(group, sites[0], access_trace)


class LineFills:
    """Fetches of cached code: a fill of each missing line, at the beginning of a call.

    `places` has the offset in the arena and the bytes of each routine, by its site.
    """

    def __init__(
        self, cache: CodeCache, places: Mapping[int, tuple[int, int]], access_trace: AccessTrace
    ) -> None:
        self._cache = cache
        self._access_trace = access_trace
        lines = [
            (line, site)
            for site, (offset, nbytes) in places.items()
            for line in range(offset // cache.line_bytes, (offset + nbytes - 1) // cache.line_bytes + 1)
        ]
        self._words = np.array([len(lines), *chain(*lines), *repeat(0, len(lines))], np.int64)

    def behind(self, run: Callable[..., Work]) -> Callable[..., Work]:
        """Return a call that adds the fetches."""
        return _followed(run, c.fetch_lines, self._access_trace, self._cache.words, self._words)


class SingleFetches:
    """Fetches of uncached code: one for every 64 bits executed, from the code of the routines in turn.

    The bus makes them (`bus.core_jobs.find_present`); the trace has only their number.
    """

    def __init__(self, group: CallGroup, first_site: int, access_trace: AccessTrace) -> None:
        self._access_trace = access_trace
        self._group = group
        self._first_site = first_site

    @cached_property
    def _words(self) -> NDArray[np.int64]:
        group = self._group
        outside = [each.nbytes if each.routine in group.fetched else 0 for each in group.code.counters]
        return np.array([len(outside), 0, self._first_site, *outside], np.int64)

    def behind(self, run: Callable[..., Work]) -> Callable[..., Work]:
        """Return a call that adds the fetches of the code executed since the last time."""
        return _followed(run, c.fetch_singly, self._access_trace, self._group.totals, self._words)


def _followed(
    run: Callable[..., Work], then: NativeEntry, access_trace: AccessTrace, *own: NDArray[np.int64]
) -> Callable[..., Work]:
    """Return a call followed by compiled code that adds fetches to the access trace."""
    one, two = (each.ctypes.data for each in own)
    given = access_trace.address_of(FUNCTION), one, two
    return followed_call(run, then.address(), given, log_of(access_trace), (access_trace, own))
