"""Conflicts in L1: a sub-bank takes one access a cycle, and a DMA word that moves there makes the core wait.

Which cycles a DMA word meets is not followed; what is charged is the expected number: the words of DMA that moved in or out
of a sub-bank while a stage ran, times the share of the stage's cycles in which the core accessed that sub-bank.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import ChipSpec
from bfsim.machine.bus import state as w
from bfsim.machine.calls.groups import CallGroup
from bfsim.machine.calls.records import arrays_of_callees
from bfsim.machine.memories import Memories, Row


class SubBanks:
    """The sub-banks of L1 as one core meets them."""

    def __init__(self, chip: ChipSpec, memories: Memories, words: Sequence[int]) -> None:
        """`words`: the state of the bus."""
        self._bytes = chip.l1.subbank_bytes
        self._conflict_cclk = chip.l1.conflict_cclk
        self._first = memories.l1
        self._words = words
        self._moved = self._dma_words()
        self._counted: dict[int, NDArray[np.int64]] = {}
        self._spread: dict[int, NDArray[np.int64]] = {}

    def _dma_words(self) -> NDArray[np.int64]:
        return np.array(self._words[w.SUBBANKS_AT : w.SUBBANKS_AT + w.MAX_SUBBANKS], np.int64)

    def of(self, row: Row) -> range:
        """Return the sub-banks that a row lies in, none outside L1."""
        if row.offset < self._first:
            return range(0)
        first, last = row.offset - self._first, row.offset + row.nbytes - 1 - self._first
        return range(first // self._bytes, last // self._bytes + 1)

    def since(self, groups: Iterable[CallGroup], elapsed_cclk: int) -> int:
        """Return the cycles that conflicts cost in the last `elapsed_cclk`, in which the calls of `groups` ran."""
        moved = self._dma_words()
        dma = moved - self._moved
        self._moved = moved
        accesses = np.zeros(w.MAX_SUBBANKS, np.float64)
        for group in groups:
            before = self._counted.get(id(group), np.zeros_like(group.totals))
            self._counted[id(group)] = group.totals.copy()
            self._add(group, group.totals - before, accesses)
        if elapsed_cclk <= 0:
            return 0
        # added up in order: a product of vectors may round otherwise on another machine
        return int(sum((dma * accesses).tolist()) / elapsed_cclk) * self._conflict_cclk

    def _add(self, group: CallGroup, events: NDArray[np.int64], accesses: NDArray[np.float64]) -> None:
        """Spread the accesses of a group's calls evenly over the sub-banks that its rows lie in."""
        if id(group) not in self._spread:
            self._spread[id(group)] = _spread(group)
        counters, banks, each, parts = self._spread[id(group)]
        np.add.at(accesses, banks, events[counters] * each / parts)


def _spread(group: CallGroup) -> NDArray[np.int64]:
    """Return what an event of each counter accesses, as four rows: counter, sub-bank, accesses, sub-banks to share them."""
    banks = arrays_of_callees(group.kernel, tuple(map(tuple, group.subbanks)))
    found = [
        (number, bank, reads + writes, len(banks[counter.routine, array]))
        for number, counter in enumerate(group.code.counters)
        for array, reads, writes in counter.array_accesses
        for bank in banks[counter.routine, array]
    ]
    return np.array(found, np.int64).reshape(-1, 4).T
