"""Conflicts in L1: a sub-bank takes one access a cycle, and a DMA word that moves there makes the core wait.

Which cycles a DMA word meets is not followed; what is charged is the expected number: the words of DMA that moved in or out
of a sub-bank while a stage ran, times the share of the stage's cycles in which the core accessed that sub-bank. Lines of kernels
have them by their part in those accesses.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import ChipSpec
from bfsim.machine.bus import state as w
from bfsim.machine.calls.groups import CallGroup
from bfsim.machine.memories import Memories, Row


class Accesses(NamedTuple):
    """Accesses of L1 by calls: so many of each site, to each sub-bank."""

    banks: NDArray[np.int64]
    made: NDArray[np.float64]
    sites: NDArray[np.int64]


class Conflicts(NamedTuple):
    """Cycles that were lost, and the sites that lost how many of them."""

    cclk: int
    sites: NDArray[np.int64]
    at_sites_cclk: NDArray[np.int64]


NO_CONFLICTS = Conflicts(0, np.zeros(0, np.int64), np.zeros(0, np.int64))


class StageGroups:
    """The groups of calls of one stage, and what each of their events accesses: the `spread` of all of them, and its counts before."""

    def __init__(self) -> None:
        self._new: list[CallGroup] = []
        self._spread = np.zeros((5, 0), np.int64)
        self._before = np.zeros(0, np.int64)

    def add(self, group: CallGroup) -> None:
        """Add a group. Where its rows lie is looked up when it has run."""
        self._new.append(group)

    @property
    def spread(self) -> NDArray[np.int64]:
        """What an event of each counter accesses: see `_spread`."""
        if self._new:
            self._spread = np.concatenate([self._spread, *map(_spread, self._new)], axis=1)
            self._new = []
        return self._spread

    def counted(self, events: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return how often each event of `spread` was counted since the last time."""
        counted: NDArray[np.int64] = events[self.spread[0]]
        since = counted.copy()
        since[: len(self._before)] -= self._before
        self._before = counted
        return since


class SubBanks:
    """The sub-banks of L1 as one core meets them."""

    def __init__(self, chip: ChipSpec, memories: Memories, words: Sequence[int]) -> None:
        """`words`: the state of the bus."""
        self._bytes = chip.l1.subbank_bytes
        self._conflict_cclk = chip.l1.conflict_cclk
        self._first = memories.l1
        self._words = words
        self._moved = self._dma_words()

    def _dma_words(self) -> NDArray[np.int64]:
        return np.array(self._words[w.SUBBANKS_AT : w.SUBBANKS_AT + w.MAX_SUBBANKS], np.int64)

    def of(self, row: Row) -> range:
        """Return the sub-banks that a row lies in, none outside L1."""
        if row.offset < self._first:
            return range(0)
        first, last = row.offset - self._first, row.offset + row.nbytes - 1 - self._first
        return range(first // self._bytes, last // self._bytes + 1)

    @staticmethod
    def accessed(groups: StageGroups, events: NDArray[np.int64]) -> Accesses:
        """Return what the calls of `groups` have accessed since the last time, by the core's `events`."""
        _, banks, each, parts, sites = groups.spread
        return Accesses(banks, groups.counted(events) * each / parts, sites)

    def conflicts(self, accessed: Accesses, elapsed_cclk: int) -> Conflicts:
        """Return what conflicts cost since the last time, `elapsed_cclk` ago: all was `accessed` in these."""
        moved = self._dma_words()
        dma = moved - self._moved
        self._moved = moved
        banks, made, sites = accessed
        if elapsed_cclk <= 0:
            return NO_CONFLICTS
        accesses = np.zeros(w.MAX_SUBBANKS, np.float64)
        np.add.at(accesses, banks, made)
        # added up in order: a product of vectors may round otherwise on another machine
        cclk = int(sum((dma * accesses).tolist()) / elapsed_cclk) * self._conflict_cclk
        if not cclk:
            return NO_CONFLICTS
        return Conflicts(cclk, sites, _shared_out(cclk, made * dma[banks]))


def _shared_out(cclk: int, shares: NDArray[np.float64]) -> NDArray[np.int64]:
    """Share whole cycles out by `shares`, which are not all 0: each gets its part of them, rounded so that none is lost."""
    up_to = np.cumsum(shares)
    ends = np.floor(up_to / up_to[-1] * cclk).astype(np.int64)
    ends[-1] = cclk
    whole: NDArray[np.int64] = np.diff(ends, prepend=0)
    return whole


def _spread(group: CallGroup) -> NDArray[np.int64]:
    """Return what an event of each counter accesses, spread evenly over the sub-banks that the rows lie in.

    Five rows: the core's number of the counter, sub-bank, accesses, sub-banks to share them, and the core's site that makes them.
    """
    banks = group.by_array(group.subbanks)
    rows = [
        (
            group.first_event + each.counter,
            bank,
            each.accesses,
            len(banks[each.array]) * each.among,
            group.first_site + each.site,
        )
        for each in group.code.program.accesses
        for bank in banks[each.array]
    ]
    return np.array(rows, np.int64).reshape(-1, 5).T
