"""What a core that runs ahead tells of itself: the bus keeps what each operation took, and here that becomes spans."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import RING_STREAMS
from bfsim.machine.bus.stalls import BUS_STALLS, REASON_OF_ACCOUNT
from bfsim.machine.bus.tape import Tape
from bfsim.machine.bus.transfer_plans import TransferPlan
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.calls.call_cache import KnownCall
from bfsim.machine.core.progress.told_rings import ToldRings
from bfsim.machine.timeline import CoreTimeline
from bfsim.spans import NO_STALLS, Place, SpanKind
from bfsim.trace import StallReason

Rows = NDArray[np.int64]


class ToldAhead:
    """Tells a `timeline` what the core of a `tape` did; `calls`: those that it has prepared, by their numbers."""

    def __init__(self, timeline: CoreTimeline, bus: WovenBus, tape: Tape, calls: Sequence[KnownCall]) -> None:
        assert bus.records.told, "a timeline is told of the bus, too"
        self.plans: dict[int, TransferPlan] = {}
        """Of its copies, by their numbers."""
        self._rings = ToldRings(timeline, bus)
        _, self._outward = RING_STREAMS[tape.core]
        self._timeline = timeline
        self._told = bus.records.told
        self._tape = tape
        self._calls = calls
        self._places: list[Place | None] = []
        self._first, self._clock_cclk, self._account = 0, 0, 0
        self._owners: Sequence[str] = ()
        tape.tell()
        timeline.when_said = self._note_place
        self._told.before.append(self.tell)

    def _note_place(self, place: Place | None) -> bool:
        """Note that what follows is about a place; return whether it is told later."""
        if not self._tape.noted:
            return False
        self._tape.note(w.ABOUT, len(self._places), 0, 0, 0)
        self._places.append(place)
        return True

    def begin(self, first: int, clock_cclk: int, owners: Sequence[str]) -> None:
        """Take note that the bus plays operations from the `first` on, the core's clock being at a cycle; `owners`: of its accounts."""
        self._first, self._clock_cclk, self._owners = first, clock_cclk, owners

    def clear(self) -> None:
        """Begin anew: all was told."""
        self._places.clear()

    def tell(self) -> None:
        """Tell what the bus has played since the last time."""
        first, end = self._first, self._tape.played
        if end <= first:
            return
        operations, took = self._tape.operations(first, end), self._tape.took(first, end)
        ends = took[:, w.UNTIL].tolist()
        begins = [self._clock_cclk, *ends[:-1]]
        self._first, self._clock_cclk = end, ends[-1]
        self._tell_copies(operations, took, begins, ends)
        self._tell_work(operations, took, begins, ends)

    def _tell_work(self, operations: Rows, took: Rows, begins: list[int], ends: list[int]) -> None:
        """Tell calls and waits, and what they were about."""
        kinds, timeline = operations[:, 0], self._timeline
        stalls = _stalls_of_calls(operations, took)
        told: list[tuple[SpanKind, str, int, Mapping[StallReason, int], int] | None] = [None] * len(kinds)
        for at, call, issue_cclk in _numbers(operations, _of_kind(kinds, w.RUN, w.ACCESS), w.OF_CALL, 1):
            told[at] = SpanKind.CALL, self._calls[call].name, issue_cclk, stalls.get(at, NO_STALLS), 0
        for at in _of_kind(kinds, w.SET_UP).tolist():
            told[at] = _wait(StallReason.DMA_SETUP, ends[at] - begins[at])
        for at, counter in _numbers(operations, _of_kind(kinds, w.AWAIT), 2):
            if cclk := ends[at] - begins[at]:
                told[at] = _wait(
                    REASON_OF_ACCOUNT[counter], cclk, self._told.flow_of(int(took[at, w.COPIED]))
                )
        places = self._placed(operations)
        timeline.tell_all(
            (*each, begin, end, place)
            for each, begin, end, place in zip(told, begins, ends, places, strict=True)
            if each
        )
        timeline.place = places[-1]

    def _placed(self, operations: Rows) -> list[Place | None]:
        """Return what each operation is about."""
        places, place = [], self._timeline.place
        for number in np.where(operations[:, 0] == w.ABOUT, operations[:, 1], w.NONE).tolist():
            if number != w.NONE:
                place = self._places[number]
            places.append(place)
        return places

    def _tell_copies(self, operations: Rows, took: Rows, begins: list[int], ends: list[int]) -> None:
        """Tell the bus which transfers the core has posted, and how full rings were."""
        at = _of_kind(operations[:, 0], w.COPY, w.SET_UP, w.AWAIT)
        numbers = np.column_stack([operations[at, :4], took[at][:, [w.COPIED, w.POSTED_AT]]])
        for place, (kind, one, two, three, copied, posted_at) in zip(
            at.tolist(), numbers.tolist(), strict=True
        ):
            if kind == w.COPY:
                plan = self.plans[one]
                self._told.note(plan.master, copied, plan.name, posted_at, plan.nbytes)
                if plan.master == self._outward:
                    self._rings.send(self._owners[self._account], copied, begins[place])
            elif kind == w.SET_UP:
                self._account = two
            elif two == w.RING_EMPTY:
                is_there = begins[place] == ends[place]
                self._rings.ask(self._owners[three], is_there=is_there, cclk=begins[place])
        self._rings.tell()


def _of_kind(kinds: Rows, *wanted: int) -> Rows:
    return np.flatnonzero(np.isin(kinds, wanted))


def _numbers(rows: Rows, at: Rows, *columns: int) -> zip[tuple[int, ...]]:
    """Return the places of some rows, each with the numbers in some columns."""
    return zip(at.tolist(), *(rows[at, each].tolist() for each in columns), strict=True)


def _wait(
    reason: StallReason, cclk: int, flow: int = 0
) -> tuple[SpanKind, str, int, Mapping[StallReason, int], int]:
    return SpanKind.STALL, reason.value, 0, {reason: cclk}, flow


def _stalls_of_calls(operations: Rows, took: Rows) -> dict[int, dict[StallReason, int]]:
    """Return what calls stalled, on the bus and else, by their places."""
    found: dict[int, dict[StallReason, int]] = {}
    kinds = operations[:, 0]
    calls = _of_kind(kinds, w.ACCESS)
    places, counters = took[calls, w.CALL_STALLS :].nonzero()
    amounts = took[calls[places], w.CALL_STALLS + counters]
    for at, counter, cclk in zip(calls[places].tolist(), counters.tolist(), amounts.tolist(), strict=True):
        found.setdefault(at, {})[BUS_STALLS[counter]] = cclk
    for at, cclk in _numbers(
        operations, np.flatnonzero((operations[:, 2] > 0) & np.isin(kinds, (w.RUN, w.ACCESS))), 2
    ):
        found.setdefault(at, {})[StallReason.INTERLOCK] = cclk
    return found
