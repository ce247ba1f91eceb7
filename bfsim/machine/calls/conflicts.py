"""Conflicts in L1: a sub-bank takes one access per cycle, and a DMA word that moves there makes the core wait.

The exact cycles of DMA words are not followed. The expected number is charged: the DMA words that moved into or out of a sub-bank
while a stage ran, times the share of the stage's cycles in which the core accessed that sub-bank. Lines of kernels are charged
by their share of those accesses.
"""

from __future__ import annotations

import ctypes
from collections.abc import MutableSequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import ChipSpec
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.calls.groups import CallGroup
from bfsim.machine.memories import Memories, Row
from bfsim.machine_code.built_in import built_in

COUNTER, BANK, EACH, AMONG, SITE = range(5)
"""The accesses of an event: its counter in the core, a sub-bank, the accesses, the sub-banks that share them, and the core's site."""

Numbers = MutableSequence[int]


class Accesses(NamedTuple):
    """Accesses of L1 by calls: what each of their events accesses, as the columns above one after the other, and the counts of events.

    `spread_at` is the address of `spread`: numpy takes longer to find it than compiled code needs for everything.
    """

    spread: NDArray[np.int64]
    events: ctypes.Array[ctypes.c_int64]
    spread_at: int


@native
def made(spread: Numbers, events: Numbers, count: int, number: int) -> float:
    """Return the number of accesses to a sub-bank."""
    return events[number] * spread[EACH * count + number] / spread[AMONG * count + number]


@native
def count_since(spread: Numbers, count: int, counters: Numbers, before: Numbers, events: Numbers) -> int:
    """Write how much the `counters` of a core have grown since `before` to `events`, for each of `count` columns. Return `count`."""
    for number in range(count):
        now = counters[spread[COUNTER * count + number]]
        events[number] = now - before[number]
        before[number] = now
    return count


@native_entry("int64", "int64*", "int64", "int64*", "int64*", "int64*")
def count_events(spread_at: Any, count: int, counters_at: Any, before_at: Any, events_at: Any) -> int:
    """Count events as above."""
    spread, counters, before, events = (
        words_at(spread_at), words_at(counters_at), words_at(before_at), words_at(events_at)
    )  # fmt: skip
    return count_since(spread, count, counters, before, events)


@native_entry(
    "int64", "int64*", "int64*", "int64*", "float64*", "int64*", "int64*", "int64", "int64", "int64", "int64*"
)
def charge_conflicts(
    state_at: Any, before_at: Any, words_moved_at: Any, accesses_at: Any, spread_at: Any, events_at: Any, count: int,
    elapsed: int, conflict: int, at_sites_at: Any,
) -> int:  # fmt: skip
    """Charge conflicts as below."""
    banks = words_at(before_at), words_at(words_moved_at), words_at(accesses_at)
    spread, events, at_sites = words_at(spread_at), words_at(events_at), words_at(at_sites_at)
    return charged(words_at(state_at), banks, spread, events, count, elapsed, conflict, at_sites)


@native
def charged(
    state: Numbers, banks: tuple[Numbers, Numbers, MutableSequence[float]], spread: Numbers, events: Numbers, count: int,
    elapsed: int, conflict: int, at_sites: Numbers,
) -> int:  # fmt: skip
    """Return the cost of conflicts in `elapsed` cycles, each costing `conflict`, and add it to the costs by site.

    The sites share it in proportion to their accesses, rounded so that nothing is lost. `banks`, by sub-bank: the words that DMA
    had moved before, room for those moved since, and room for accesses.
    """
    before, words_moved, accesses = banks
    for bank in range(w.MAX_SUBBANKS):
        words_moved[bank] = state[w.SUBBANKS_AT + bank] - before[bank]
        before[bank] += words_moved[bank]
        accesses[bank] = 0.0
    if elapsed <= 0:
        return 0
    whole, expected = 0.0, 0.0
    for number in range(count):
        bank = spread[BANK * count + number]
        accesses[bank] += made(spread, events, count, number)
        whole += made(spread, events, count, number) * words_moved[bank]
    for bank in range(w.MAX_SUBBANKS):
        expected += words_moved[bank] * accesses[bank]
    cclk = int(expected / elapsed) * conflict
    up_to, given = 0.0, 0
    for number in range(count if cclk else 0):
        up_to += made(spread, events, count, number) * words_moved[spread[BANK * count + number]]
        end = cclk if number == count - 1 else int(up_to / whole * cclk)
        at_sites[spread[SITE * count + number]] += end - given
        given = end
    return cclk


class StageGroups:
    """The groups of calls of one stage, with the `spread` of all their events' accesses, and the earlier counts."""

    def __init__(self) -> None:
        self._new: list[CallGroup] = []
        self._spread = np.zeros((5, 0), np.int64)
        self._before = np.zeros(0, np.int64)
        self._addresses = 0, 0  # of the spread and the earlier counts
        self._events: type[ctypes.Array[ctypes.c_int64]] = ctypes.c_int64 * 0
        self._count = built_in(count_events.address(), 5)

    def add(self, group: CallGroup) -> None:
        """Add a group. Its rows are looked up once it has run."""
        self._new.append(group)

    @property
    def has_new(self) -> bool:
        """Whether some groups have not been looked at yet."""
        return bool(self._new)

    def look(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Look up where the rows of new groups lie. Return the spread of all groups, and the earlier counts."""
        if self._new:
            joined = np.concatenate([self._spread, *map(_spread, self._new)], axis=1)
            self._spread = np.ascontiguousarray(joined)  # after a single column, numpy joins by rows
            self._before = np.pad(self._before, (0, self._spread.shape[1] - len(self._before)))
            self._addresses = self._spread.ctypes.data, self._before.ctypes.data
            self._events = ctypes.c_int64 * len(self._before)
            self._new = []
        return self._spread, self._before

    def accessed(self, counters_at: int) -> Accesses:
        """Return what the calls have accessed since the last time, from the core's counters at an address."""
        self.look()
        events = self._events()
        spread_at, before_at = self._addresses
        self._count(spread_at, len(events), counters_at, before_at, ctypes.addressof(events))
        return Accesses(self._spread, events, spread_at)


class SubBanks:
    """The sub-banks of L1 as seen by one core."""

    def __init__(self, chip: ChipSpec, memories: Memories, words: Any) -> None:
        """`words` is the state of the bus."""
        state: NDArray[np.int64] = np.asarray(words)
        self._bytes = chip.l1.subbank_bytes
        self._first = memories.l1
        self._arrays = (
            state,
            state[w.SUBBANKS_AT : w.SUBBANKS_AT + w.MAX_SUBBANKS].copy(),  # words that DMA had moved before,
            np.zeros(w.MAX_SUBBANKS, np.int64),  # and room for
            np.zeros(w.MAX_SUBBANKS, np.float64),
        )
        self.at = [each.ctypes.data for each in self._arrays]
        """The addresses of these arrays."""
        self.conflict_cclk = chip.l1.conflict_cclk
        self._charge = built_in(charge_conflicts.address(), 6, *self.at)

    def of(self, row: Row) -> range:
        """Return the sub-banks that a row lies in: none if it is outside L1."""
        if row.offset < self._first:
            return range(0)
        first, last = row.offset - self._first, row.offset + row.nbytes - 1 - self._first
        return range(first // self._bytes, last // self._bytes + 1)

    def charge(self, accessed: Accesses, elapsed_cclk: int, at_sites_at: int) -> int:
        """Return the cycles of conflicts since the last time, `elapsed_cclk` ago. All of `accessed` was in that time.

        The cycles are added to the costs of conflicts by site at an address.
        """
        _, events, spread_at = accessed
        return self._charge(
            spread_at, ctypes.addressof(events), len(events), elapsed_cclk, self.conflict_cclk, at_sites_at
        )


def _spread(group: CallGroup) -> NDArray[np.int64]:
    """Return what an event of each counter accesses, in the columns above, spread evenly over the sub-banks of the rows."""
    banks = group.by_array(group.subbanks)
    rows = [
        (
            group.first_event + each.counter,
            bank,
            each.accesses,
            len(banks[each.array]) * each.among,
            group.first_site + each.site,
        )
        for each in group.code.tables.accesses
        for bank in banks[each.array]
    ]
    return np.array(rows, np.int64).reshape(-1, 5).T
