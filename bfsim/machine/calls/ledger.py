"""The counts of one core's kernels: events and, by site, stalls. They give each cycle of a call its owner.

Nothing is added up call by call. At a frame's end, all counts are compared with those at the previous frame's end, and kept for the
next one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError
from bfsim.kernel.native.entries import NativeEntry, native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.stalls import BUS_STALLS
from bfsim.machine.calls.groups import CallGroup
from bfsim.machine.pages import zeros
from bfsim.machine_code.built_in import built_in
from bfsim.trace import StallReason
from bfsim.trace.owner_costs import CALLS, COLUMN_OF, COLUMNS, ISSUE, Owner

SITE_STALLS = (*BUS_STALLS, StallReason.L1_CONFLICT)
"""The stalls that are counted for a site, in the order of `Counted`. The number of lines that its accesses filled comes after them."""
FILLS = len(SITE_STALLS)
CONFLICTS = SITE_STALLS.index(StallReason.L1_CONFLICT)
SITE_COLUMNS = np.array([COLUMN_OF[each] for each in SITE_STALLS])
INTERLOCKS = COLUMN_OF[StallReason.INTERLOCK]

MAX_EVENTS = 1 << 20
SITE_COUNTS = w.MAX_SITES * (FILLS + 1)
NO_ROOM = "firmware must call its kernels in fewer stages, or with fewer different buffers: there are too many to keep apart"

Rows = NDArray[np.int64]


class Counted(NamedTuple):
    """The counts of a whole run: the events of each counter, and the stalls and line fills of each site."""

    events: Rows
    sites: Rows


class FrameCounts(NamedTuple):
    """The counts of a single frame: the events of each counter, and for the sites, places in their table and amounts."""

    events: Rows
    places: Rows
    amounts: Rows


EVENT, OWNER, OF_CALLS, OF_ISSUE, OF_INTERLOCKS = range(5)
"""A charge: what an event of a counter costs an owner, in calls, issue cycles and interlocks."""


@native_entry("int64", "int64*", "int64*", "int64*", "int64", "int64*")
def charge_events(now_at: Any, before_at: Any, charges_at: Any, count: int, costs_at: Any) -> int:
    """Add `count` charges for the events between two moments to a table of costs, a row of COLUMNS for each owner. Return `count`.

    The arrays: the counts at both moments, the columns of charges one after the other, and the table.
    """
    charges, now, before, costs = (
        words_at(charges_at),
        words_at(now_at),
        words_at(before_at),
        words_at(costs_at),
    )
    for number in range(count):
        event = charges[EVENT * count + number]
        events, row = now[event] - before[event], charges[OWNER * count + number] * COLUMNS
        costs[row + CALLS] += events * charges[OF_CALLS * count + number]
        costs[row + ISSUE] += events * charges[OF_ISSUE * count + number]
        costs[row + INTERLOCKS] += events * charges[OF_INTERLOCKS * count + number]
    return count


@native
def has_counted(on_bus: Any, row: int, conflicts: int, before: Any, first: int) -> bool:
    """Whether a site has stalled or filled lines since the last time, from its row of the bus, its conflicts and the counts of `before`."""
    differs = conflicts ^ before[first + CONFLICTS]
    for reason in range(w.FILLS):
        differs |= on_bus[row + reason] ^ before[first + reason]
    differs |= on_bus[row + w.FILLS] ^ before[first + FILLS]
    return bool(differs)


@native_entry(
    "int64", "int64*", "int64*", "int64*", "int64*", "int64*", "int64*", "int64*", "int64", "int64*"
)
def charge_sites(
    columns_at: Any, on_bus_at: Any, conflicts_at: Any, before_at: Any, places_at: Any, amounts_at: Any,
    owners_at: Any, count: int, costs_at: Any,
) -> int:  # fmt: skip
    """Add the stalls of `count` sites since the last time to such a table, by the owner of each and the column of each reason.

    Rows of the bus, and cycles of conflicts, are compared with the counts of `before`, which are brought up to date. The differing
    places are written to `places`, the differences to `amounts`. Returns their number.
    """
    owners, columns, costs = words_at(owners_at), words_at(columns_at), words_at(costs_at)
    on_bus, conflicts, before = words_at(on_bus_at), words_at(conflicts_at), words_at(before_at)
    places, amounts, found = words_at(places_at), words_at(amounts_at), 0
    for site in range(w.NO_SITE + 1, count):  # semaphores and locks belong to no kernel
        row, first = site * w.SITE_WORDS, site * (FILLS + 1)
        if not has_counted(on_bus, row, conflicts[site], before, first):
            continue  # most sites stall nothing in a frame
        for column in range(FILLS + 1):
            now = conflicts[site] if column == CONFLICTS else on_bus[row + min(column, w.FILLS)]
            amount = now - before[first + column]
            if amount:
                before[first + column] = now
                places[found], amounts[found] = first + column, amount
                found += 1
                if column < FILLS:
                    costs[owners[site] * COLUMNS + columns[column]] += amount
    return found


class Ledger:
    """The counts of one core. `bus_stalls` are the stalls of its sites, as the bus keeps them."""

    def __init__(self, bus_stalls: Rows) -> None:
        self._events = zeros(MAX_EVENTS)
        self._conflicts = zeros(w.MAX_SITES)
        self.events_at, self.conflicts_at = self._events.ctypes.data, self._conflicts.ctypes.data
        """Addresses of each counter's events, and of the costs of conflicts in L1 by site. Both are added to there."""
        self.event_count, self._site_count = 0, w.NO_SITE + 1
        self._owners: dict[Owner, int] = {}
        self._new_charges: list[Rows] = []
        self._site_owners: list[int] = [0] * self._site_count
        self._know(np.zeros((5, 0), np.int64))
        self._events_before, self._sites_before = zeros(MAX_EVENTS), zeros(SITE_COUNTS)
        self._places, self._amounts = zeros(SITE_COUNTS), zeros(SITE_COUNTS)  # room for differences
        self._charge_events = _charging(charge_events, self._events, self._events_before)
        self._charge_sites = _charging(
            charge_sites, SITE_COLUMNS, bus_stalls, self._conflicts, self._sites_before, self._places, self._amounts
        )  # fmt: skip
        self._reported_events, self._reported_sites = zeros(MAX_EVENTS), zeros(SITE_COUNTS)
        self._reported_count = 0

    def room(self, events: int, sites: int) -> tuple[Rows, int, int]:
        """Make room for another group. Return where it counts its events, and the numbers of its first event and first site."""
        first_event, first_site = self.event_count, self._site_count
        self.event_count += events
        self._site_count += sites
        if self.event_count > MAX_EVENTS or self._site_count > w.MAX_SITES:
            raise FirmwareError(NO_ROOM)
        return self._events[first_event : self.event_count], first_event, first_site

    def add(self, group: CallGroup) -> None:
        """Note the owners of a new group's counts."""
        names = {each.symbol: each.name for each in group.code.functions}

        @cache
        def owner(symbol: str) -> int:
            return self._owners.setdefault(Owner(group.stage, names[symbol], symbol), len(self._owners))

        symbols, counter, routine, costs = group.code.tables.costs
        owners = np.array([owner(each) for each in symbols], np.int64)
        self._new_charges.append(np.vstack([group.first_event + counter, owners[routine], costs.T]))
        self._site_owners.extend(owner(each) for each in group.code.tables.site_routines)
        self._site_owners.extend(owner(each) for each in group.fetched)

    @property
    def events(self) -> Rows:
        """The events of each counter."""
        return self._events[: self.event_count]

    def close(self) -> tuple[tuple[Owner, ...], Rows, FrameCounts]:
        """Return the kernels in each stage, their costs since the last time as rows of an `OwnerCosts` table, and the counts since then."""
        if self._new_charges:
            self._know(np.concatenate([self._charges, *self._new_charges], axis=1))
            self._new_charges = []
        costs = np.zeros((len(self._kernels), COLUMNS), np.int64)
        costs_at = costs.ctypes.data
        events, before = self.events, self._events_before[: self.event_count]
        self._charge_events(*self._charges_at, costs_at)
        found = self._charge_sites(*self._owners_at, costs_at)
        counts = FrameCounts(events - before, self._places[:found].copy(), self._amounts[:found].copy())
        before[:] = events
        return self._kernels, costs, counts

    def _know(self, charges: Rows) -> None:
        """Keep the charges and their addresses for compiled code: all sites are known by now."""
        self._charges = np.ascontiguousarray(charges)  # after a single column, numpy lays out others by rows
        self._kernels = tuple(self._owners)
        self._owners_of_sites = np.array(self._site_owners, np.int64)
        self._charges_at = self._charges.ctypes.data, self._charges.shape[1]
        self._owners_at = self._owners_of_sites.ctypes.data, len(self._owners_of_sites)

    def report(self, counts: FrameCounts) -> None:
        """Add the counts of the next frame to the reported ones."""
        self._reported_count = len(counts.events)
        self._reported_events[: self._reported_count] += counts.events
        self._reported_sites[counts.places] += counts.amounts

    @property
    def reported(self) -> Counted:
        """The counts of all frames on record."""
        return Counted(
            self._reported_events[: self._reported_count], self._reported_sites.reshape(-1, FILLS + 1)
        )


def _charging(entry: NativeEntry, *arrays: Rows) -> Callable[[int, int, int], int]:
    """Return compiled code bound to these arrays, which must outlive it. An address, a count and the address of the costs remain."""
    return built_in(entry.address(), 3, *(each.ctypes.data for each in arrays))


def stalls_by_reason(interlocks_cclk: int, at_sites: Sequence[int]) -> dict[StallReason, int]:
    """Return stalls by reason: interlocks, and those in the order of SITE_STALLS. Zeros are left out."""
    if not interlocks_cclk and not any(at_sites):
        return {}  # most lines wait for nothing
    pairs = zip((StallReason.INTERLOCK, *SITE_STALLS), (interlocks_cclk, *at_sites), strict=True)
    return dict(sorted(pair for pair in pairs if pair[1]))
