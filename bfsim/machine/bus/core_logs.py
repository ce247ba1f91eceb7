"""What the cores hand to the bus and read back: the log of each core's accesses, and the stalls at its sites."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w


@native
def site_at(core: int, site: int) -> int:
    """Return where the stalls of a core's site are counted, and its data are kept."""
    return w.SITES_AT + (core * w.MAX_SITES + site) * w.SITE_WORDS


@native
def kind_of(entry: int) -> int:
    """Return the kind of an entry of a log."""
    return entry >> log.KIND_BIT & log.KIND_MASK


class CoreLogs:
    """The part of the bus's `state` that belongs to the cores' kernels."""

    def __init__(self, state: NDArray[np.int64]) -> None:
        self._state = state
        self._words: Any = state.data

    def room_of(self, core: int) -> NDArray[np.int64]:
        """Return where a core's access trace keeps its state and its log."""
        first = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS
        room: NDArray[np.int64] = self._state[first : first + w.ACCESS_TRACE_WORDS]
        return room

    def log_in_l2(self, core: int, stamp_cclk: int, kind: int) -> int:
        """Make one access to a shared variable in L2 the whole log of a core. Return the number of entries."""
        entry = stamp_cclk << log.STAMP_BIT | kind << log.KIND_BIT | self._words[w.L2_FIRST]
        room = self.room_of(core)
        room[log.LOG], room[log.LOG + w.LOG_ENTRIES] = entry, w.NO_SITE
        return 1

    def keep_routine(self, core: int, site: int, offset: int, nbytes: int, following: int) -> None:
        """Keep where the uncached code of a site lies, and the site of the routine fetched after it."""
        row = site_at(core, site)
        self._words[row + w.CODE], self._words[row + w.CODE_WORDS] = offset, -(-nbytes // w.FETCH_BYTES)
        self._words[row + w.NEXT_ROUTINE] = following

    def first(self, core: int, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the first `count` entries of a core's log, and their sites."""
        room = self.room_of(core)[log.LOG :]
        return room[:count], room[w.LOG_ENTRIES :][:count]

    def accesses(self, core: int, cclk: int, count: int) -> list[tuple[int, int]]:
        """Return the accesses of a call of `cclk` cycles whose log has `count` entries: entry and site of each, in order."""
        logged = list(zip(*(each.tolist() for each in self.first(core, count)), strict=True))
        if not logged or kind_of(logged[-1][0]) != log.FETCHES:
            return logged
        fetches, site = logged.pop()
        number = fetches >> log.STAMP_BIT
        words = islice(self._code_in_turn(core, site), number)
        logged += [
            (each * cclk // number << log.STAMP_BIT | log.FETCH << log.KIND_BIT | place, routine)
            for each, (place, routine) in enumerate(words)
        ]
        return sorted(logged, key=lambda each: each[0] >> log.STAMP_BIT)

    def _code_in_turn(self, core: int, site: int) -> Iterator[tuple[int, int]]:
        """Yield the words of a routine and of those after it, over and over: the place of each word, and its routine's site."""
        while True:
            row = site_at(core, site)
            first, words = self._words[row + w.CODE], self._words[row + w.CODE_WORDS]
            yield from ((first + number * w.FETCH_BYTES, site) for number in range(words))
            site = self._words[row + w.NEXT_ROUTINE]

    def stalls_at_sites(self, core: int) -> NDArray[np.int64]:
        """Return the stalls of a core's sites so far, as a table by site and by reason in the order of `bus.state`.

        The column after the reasons counts filled lines.
        """
        first = site_at(core, 0)
        found: NDArray[np.int64] = self._state[first : site_at(core, w.MAX_SITES)]
        return found.reshape(w.MAX_SITES, w.SITE_WORDS)
