"""What the kernels of one core have counted: events and, site by site, stalls. So each cycle of a call has an owner.

Nothing is added up call by call. At a frame's end all counts are compared with those at the end of the frame before.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from mmap import MAP_ANONYMOUS, MAP_PRIVATE, mmap

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError
from bfsim.machine.bus import state as w
from bfsim.machine.bus.stalls import BUS_STALLS
from bfsim.machine.calls.groups import CallGroup
from bfsim.machine.owner_costs import CALLS, COLUMN_OF, COLUMNS, ISSUE, Owner
from bfsim.trace import StallReason

SITE_STALLS = (*BUS_STALLS, StallReason.L1_CONFLICT)
"""What is counted of a site, in the order of a snapshot; the lines that its accesses filled are behind them."""
FILLS = len(SITE_STALLS)
SITE_COLUMNS = np.array([COLUMN_OF[each] for each in SITE_STALLS])
CHARGED = np.array([CALLS, ISSUE, COLUMN_OF[StallReason.INTERLOCK]])
"""The columns of what an event of a counter costs."""

MAX_EVENTS = 1 << 20
NO_ROOM = "firmware must call its kernels in fewer stages, or with fewer different buffers: there are too many to keep apart"

Rows = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The counts at one moment: events of each counter, and of each site its stalls and line fills."""

    events: Rows
    sites: Rows

    def since(self, before: Snapshot) -> Snapshot:
        """Return what was counted since `before`."""
        events, sites = self.events.copy(), self.sites.copy()
        events[: len(before.events)] -= before.events
        sites[: len(before.sites)] -= before.sites
        return Snapshot(events, sites)


def _zeros(count: int) -> Rows:
    """Return `count` zeros straight from the kernel, which clears what is touched of them.

    np.zeros clears all 10 MB of a ledger itself where the process has freed as much before: 10 ms for each further board.
    """
    return np.frombuffer(mmap(-1, 8 * count, MAP_PRIVATE | MAP_ANONYMOUS), np.int64)


class Ledger:
    """The counts of one core. `bus_stalls` returns those of its first so many sites, as the bus has them."""

    def __init__(self, bus_stalls: Callable[[int], Rows]) -> None:
        self._bus_stalls = bus_stalls
        self._events = _zeros(MAX_EVENTS)
        self.conflicts = _zeros(w.MAX_SITES)
        """Cycles that conflicts in L1 have cost at each site, to be added to."""
        self._event_count, self._site_count = 0, w.NO_SITE + 1
        self._owners: dict[Owner, int] = {}
        self._charges: list[tuple[Rows, Rows, Rows]] = []
        """Of each group, or by owners of all that were there at the end of a frame: events, their owners, and what each costs that owner in CHARGED."""
        self._site_owners: list[int] = [0] * self._site_count
        self._before = self.snapshot()
        self.reported = self._before
        """The counts at the end of the last frame that is on record."""

    def room(self, events: int, sites: int) -> tuple[Rows, int, int]:
        """Make room for another group: return where it counts its events, the number of the first, and of the first site."""
        first_event, first_site = self._event_count, self._site_count
        self._event_count += events
        self._site_count += sites
        if self._event_count > MAX_EVENTS or self._site_count > w.MAX_SITES:
            raise FirmwareError(NO_ROOM)
        return self._events[first_event : self._event_count], first_event, first_site

    def add(self, group: CallGroup) -> None:
        """Note who owns what a new group counts."""
        names = {each.symbol: each.name for each in group.code.functions}

        @cache
        def owner(symbol: str) -> int:
            return self._owners.setdefault(Owner(group.stage, names[symbol], symbol), len(self._owners))

        symbols, counter, routine, costs = group.code.program.routine_costs
        owners = np.array([owner(each) for each in symbols], np.int64)
        self._charges.append((group.first_event + counter, owners[routine], costs))
        self._site_owners.extend(owner(each.line.routine) for each in group.code.program.sites)
        self._site_owners.extend(owner(each) for each in group.fetched)

    @property
    def events(self) -> Rows:
        """The events that each counter has counted, to be read and added to."""
        return self._events[: self._event_count]

    def snapshot(self) -> Snapshot:
        """Return the counts of now."""
        count = self._site_count
        on_bus = self._bus_stalls(count)
        sites = np.column_stack([on_bus[:, : w.STALLS], self.conflicts[:count], on_bus[:, w.FILLS]])
        sites[w.NO_SITE] = 0  # semaphores and locks are no kernel's
        return Snapshot(self._events[: self._event_count].copy(), sites)

    def close(self, now: Snapshot) -> tuple[Sequence[Owner], Rows]:
        """Return the kernels in each stage, and what they cost since the last time: rows of an `OwnerCosts` table."""
        counted, self._before = now.since(self._before), now
        costs = np.zeros((len(self._owners), COLUMNS), np.int64)
        if self._charges:
            events, owners, each = self._charges_by_owner()
            begins = np.flatnonzero(np.diff(owners, prepend=-1))  # add.at is slow: few rows are left for it
            charged = np.add.reduceat(counted.events[events, np.newaxis] * each, begins)
            np.add.at(costs, (owners[begins, np.newaxis], CHARGED), charged)
        stalled = np.flatnonzero(counted.sites[:, :FILLS].any(axis=1))
        owners = np.array([self._site_owners[site] for site in stalled.tolist()], np.int64)
        np.add.at(costs, (owners[:, np.newaxis], SITE_COLUMNS), counted.sites[stalled, :FILLS])
        return tuple(self._owners), costs

    def _charges_by_owner(self) -> tuple[Rows, Rows, Rows]:
        """Return what events cost in the order of their owners."""
        if len(self._charges) > 1:
            events, owners, each = map(np.concatenate, zip(*self._charges, strict=True))
            order = np.argsort(owners, kind="stable")
            self._charges = [(events[order], owners[order], each[order])]
        return self._charges[0]


def stalls_by_reason(interlocks_cclk: int, at_sites: Sequence[int]) -> dict[StallReason, int]:
    """Return stalls by reason: interlocks, and those in the order of SITE_STALLS; what is 0 is left out."""
    if not interlocks_cclk and not any(at_sites):
        return {}  # most lines wait for nothing
    pairs = zip((StallReason.INTERLOCK, *SITE_STALLS), (interlocks_cclk, *at_sites), strict=True)
    return dict(sorted(pair for pair in pairs if pair[1]))
