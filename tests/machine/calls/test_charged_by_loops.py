"""The compiled loops that charge conflicts, events and sites, beside the same in plain numpy, on numbers by chance."""

from __future__ import annotations

import numpy as np
import pytest

from bfsim.machine.bus import state as w
from bfsim.machine.calls.conflicts import AMONG, BANK, COUNTER, EACH, SITE, charge_conflicts, count_events
from bfsim.machine.calls.ledger import (
    CONFLICTS,
    EVENT,
    FILLS,
    OF_CALLS,
    OWNER,
    SITE_COLUMNS,
    charge_events,
    charge_sites,
)
from bfsim.machine_code.built_in import built_in
from bfsim.trace import StallReason
from bfsim.trace.owner_costs import CALLS, COLUMN_OF, COLUMNS, ISSUE

SITES, COUNTERS, OWNERS, COUNT = 40, 30, 6, 200
CHARGED = [CALLS, ISSUE, COLUMN_OF[StallReason.INTERLOCK]]


@pytest.mark.parametrize("seed", range(20))
def test_conflicts_are_shared_out(seed: int) -> None:
    """Words of DMA in a sub-bank times the share of its cycles in which it is accessed; of what is shared out none is lost."""
    random = np.random.default_rng(seed)
    spread = random.integers(0, 9, (5, COUNT))
    spread[SITE], spread[COUNTER] = random.integers(0, SITES, COUNT), random.integers(0, COUNTERS, COUNT)
    spread[AMONG] += 1
    events, moved = random.integers(0, 50, COUNT), random.integers(0, 200, w.MAX_SUBBANKS)
    state = np.zeros(w.SUBBANKS_AT + w.MAX_SUBBANKS, np.int64)
    before = random.integers(0, 1000, w.MAX_SUBBANKS)
    state[w.SUBBANKS_AT :] = before + moved
    rooms = np.zeros(w.MAX_SUBBANKS, np.int64), np.zeros(w.MAX_SUBBANKS)
    elapsed, at_sites = int(random.integers(1, 50_000)), np.zeros(SITES, np.int64)

    made = events * spread[EACH] / spread[AMONG]
    accesses = np.zeros(w.MAX_SUBBANKS)
    np.add.at(accesses, spread[BANK], made)
    cclk = int(sum((moved * accesses).tolist()) / elapsed) * 2
    up_to = np.cumsum(made * moved[spread[BANK]])
    ends = np.floor(up_to / up_to[-1] * cclk).astype(np.int64)
    ends[-1] = cclk
    shares = np.zeros(SITES, np.int64)
    np.add.at(shares, spread[SITE], np.diff(ends, prepend=0))

    arrays = (each.ctypes.data for each in (state, before, *rooms, spread, events))
    charge = built_in(charge_conflicts.address(), 10)
    assert charge(*arrays, COUNT, elapsed, 2, at_sites.ctypes.data) == cclk == at_sites.sum()
    assert (at_sites == shares).all()
    assert (before == state[w.SUBBANKS_AT :]).all()


def test_nothing_is_charged_where_no_time_has_passed() -> None:
    """What DMA has moved belongs to the stage that ends there all the same."""
    state = np.zeros(w.SUBBANKS_AT + w.MAX_SUBBANKS, np.int64)
    state[w.SUBBANKS_AT] = 5
    before, moved = np.zeros((2, w.MAX_SUBBANKS), np.int64)
    rest = np.zeros(w.MAX_SUBBANKS), np.ones((5, 1), np.int64), np.ones(1, np.int64)
    sites = np.zeros(2, np.int64)
    addresses = (each.ctypes.data for each in (state, before, moved, *rest))
    assert built_in(charge_conflicts.address(), 10)(*addresses, 1, 0, 2, sites.ctypes.data) == 0
    assert before[0] == 5
    assert not sites.any()


def test_events_are_counted_since_the_last_time() -> None:
    """By the counter of each column; the next time nothing is left."""
    spread = np.zeros((5, 3), np.int64)
    spread[COUNTER] = 2, 0, 2
    counters, before, events = np.array([4, 5, 9]), np.array([1, 4, 9]), np.zeros(3, np.int64)
    arrays = [each.ctypes.data for each in (spread, counters, before, events)]
    for expected in ([8, 0, 0], [0, 0, 0]):
        built_in(count_events.address(), 5)(arrays[0], 3, *arrays[1:])
        assert events.tolist() == expected


@pytest.mark.parametrize("seed", range(5))
def test_costs_have_their_owners(seed: int) -> None:
    """What events cost in calls, issue cycles and interlocks, and what sites have stalled by reason; line fills are no stall.

    Where a site has counted anything is told, and the counts are kept for the next time.
    """
    random = np.random.default_rng(seed)
    charges = random.integers(0, 100, (5, COUNT))
    charges[EVENT], charges[OWNER] = random.integers(0, COUNTERS, COUNT), random.integers(0, OWNERS, COUNT)
    before = random.integers(0, 1000, COUNTERS), random.integers(0, 1000, (SITES, FILLS + 1))
    since = random.integers(0, 1000, COUNTERS), random.integers(0, 3, (SITES, FILLS + 1))
    since[1][w.NO_SITE] = 0  # what no kernel stalls is nobody's, whatever the bus counts
    now = tuple(one + other for one, other in zip(before, since, strict=True))
    on_bus, conflicts = random.integers(0, 9, (SITES, w.SITE_WORDS)), now[1][:, CONFLICTS].copy()
    on_bus[1:, : w.STALLS], on_bus[1:, w.FILLS] = now[1][1:, : w.STALLS], now[1][1:, FILLS]
    owners, costs = random.integers(0, OWNERS, SITES), np.zeros((OWNERS, COLUMNS), np.int64)
    places, amounts = np.zeros((2, since[1].size), np.int64)

    expected = np.zeros_like(costs)
    charged = since[0][charges[EVENT]] * charges[OF_CALLS:]
    np.add.at(expected, (charges[OWNER], np.array(CHARGED)[:, np.newaxis]), charged)
    np.add.at(expected, (owners[:, np.newaxis], SITE_COLUMNS), since[1][:, :FILLS])

    events = (each.ctypes.data for each in (now[0], before[0]))
    built_in(charge_events.address(), 5)(*events, charges.ctypes.data, COUNT, costs.ctypes.data)
    arrays = (each.ctypes.data for each in (SITE_COLUMNS, on_bus, conflicts, before[1], places, amounts))
    found = built_in(charge_sites.address(), 9)(*arrays, owners.ctypes.data, SITES, costs.ctypes.data)
    assert (costs == expected).all()
    assert places[:found].tolist() == np.flatnonzero(since[1]).tolist()
    assert amounts[:found].tolist() == since[1][since[1] != 0].tolist()
    assert (before[1] == now[1]).all()
