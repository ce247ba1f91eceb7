"""The timeline of a core that runs ahead: what each operation took, as kept by the bus, becomes spans."""

from __future__ import annotations

from collections.abc import Sequence

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
from bfsim.spans import Place, SpanKind
from bfsim.spans.columns import NUMBER_OF
from bfsim.trace import StallReason

Rows = NDArray[np.int64]


class ToldAhead:
    """Tells a `timeline` what the core of a `tape` did. `calls` are its prepared calls by number."""

    def __init__(self, timeline: CoreTimeline, bus: WovenBus, tape: Tape, calls: Sequence[KnownCall]) -> None:
        assert bus.records.told, "a timeline is told of the bus, too"
        self.plans: dict[int, TransferPlan] = {}
        """Plans of the core's copies, by number."""
        self._rings = ToldRings(timeline, bus)
        _, self._outward = RING_STREAMS[tape.core]
        self._timeline = timeline
        self._told = bus.records.told
        self._tape = tape
        self._calls = calls
        self._places: list[Place | None] = []
        self._first, self._clock_cclk, self._account = 0, 0, 0
        self._owners: Sequence[str] = ()
        self._known: dict[str, Rows] = {}  # by stage, the spans' numbers for calls
        tape.tell()
        timeline.when_said = self._note_place
        self._told.before.append(self.tell)

    def _note_place(self, place: Place | None) -> bool:
        """Note that what follows is about a place. Return whether the place is told later."""
        if not self._tape.noted:
            return False
        self._tape.note(w.ABOUT, len(self._places), 0, 0, 0)
        self._places.append(place)
        return True

    def begin(self, first: int, clock_cclk: int, owners: Sequence[str]) -> None:
        """Note that the bus plays operations from `first` on, with the core's clock at `clock_cclk`. `owners` own its accounts."""
        self._first, self._clock_cclk, self._owners = first, clock_cclk, owners

    def clear(self) -> None:
        """Begin anew: everything has been told."""
        self._places.clear()

    def tell(self) -> None:
        """Tell what the bus has played since the last call."""
        first, end = self._first, self._tape.played
        if end <= first:
            return
        operations, took = self._tape.operations(first, end), self._tape.took(first, end)
        ends = took[:, w.UNTIL]
        begins = np.concatenate([[self._clock_cclk], ends[:-1]])
        self._first, self._clock_cclk = end, int(ends[-1])
        self._tell_copies(operations, took, begins, ends)
        self._tell_work(operations, took, begins, ends)

    def _tell_work(self, operations: Rows, took: Rows, begins: Rows, ends: Rows) -> None:
        """Tell calls and waits, and what they were about."""
        kinds, timeline = operations[:, 0], self._timeline
        is_call = (kinds == w.RUN) | (kinds == w.ACCESS)
        is_wait = ((kinds == w.SET_UP) | (kinds == w.AWAIT)) & (begins < ends)
        reasons = np.where(kinds == w.SET_UP, w.SETTING_UP, operations[:, 2])[is_wait]
        whats = np.zeros(len(kinds), np.int64)
        whats[is_call] = self._whats_of_calls(operations[is_call, w.OF_CALL])
        whats[is_wait] = self._whats_of_waits()[reasons]
        flows = np.zeros(len(kinds), np.int64)
        for at in (is_wait & (kinds == w.AWAIT)).nonzero()[0].tolist():
            flows[at] = self._told.flow_of(int(took[at, w.COPIED]))
        places = np.maximum.accumulate(np.where(kinds == w.ABOUT, operations[:, 1] + 1, 0))
        known = (timeline.place, *self._places)
        timeline.place = known[places[-1]]
        issued = np.where(is_call, operations[:, 1], 0)
        spans = np.column_stack([whats, begins, ends, issued, np.zeros_like(issued), flows, places])
        is_told = is_call | is_wait
        stalls = _stalls(operations, took, is_call, is_wait, reasons, (ends - begins)[is_wait])
        stalls[:, 0] = (is_told.cumsum() - 1)[stalls[:, 0]]
        timeline.tell(spans[is_told], stalls, known)

    def _whats_of_calls(self, calls: Rows) -> Rows:
        """Return the timeline's numbers for calls in the current stage."""
        known = self._known.setdefault(self._timeline.stage, np.zeros(0, np.int64))
        if len(known) < len(self._calls):
            known = np.pad(known, (0, 2 * len(self._calls) - len(known)), constant_values=w.NONE)
            self._known[self._timeline.stage] = known
        for call in np.unique(calls[known[calls] == w.NONE]).tolist():
            known[call] = self._timeline.number(SpanKind.CALL, self._calls[call].name)
        return known[calls]

    def _whats_of_waits(self) -> Rows:
        """Return the timeline's numbers for waits in the current stage, by their counters in `bus.state`."""
        numbers = np.zeros(max(REASON_OF_ACCOUNT) + 1, np.int64)
        for counter, reason in REASON_OF_ACCOUNT.items():
            numbers[counter] = self._timeline.number(SpanKind.STALL, reason.value)
        return numbers

    def _tell_copies(self, operations: Rows, took: Rows, begins: Rows, ends: Rows) -> None:
        """Tell the bus which transfers the core has posted, and how full rings were."""
        at = np.isin(operations[:, 0], (w.COPY, w.SET_UP, w.AWAIT))
        numbers = np.column_stack(
            [operations[at, :4], took[at][:, [w.COPIED, w.POSTED_AT]], begins[at], ends[at]]
        )
        for kind, one, two, three, copied, posted_at, begin_cclk, end_cclk in numbers.tolist():
            if kind == w.COPY:
                plan = self.plans[one]
                self._told.note(plan.master, copied, plan.name, posted_at, plan.nbytes)
                if plan.master == self._outward:
                    self._rings.send(self._owners[self._account], copied, begin_cclk)
            elif kind == w.SET_UP:
                self._account = two
            elif two == w.RING_EMPTY:
                self._rings.ask(self._owners[three], is_there=begin_cclk == end_cclk, cclk=begin_cclk)
        self._rings.tell()


def _stalls(
    operations: Rows, took: Rows, is_call: NDArray[np.bool_], is_wait: NDArray[np.bool_], reasons: Rows, waits_cclk: Rows
) -> Rows:  # fmt: skip
    """Return operation, reason and cycles of all stalls, in order. A call's stalls on the bus come before its others."""
    kinds, interlocks = operations[:, 0], operations[:, 2]
    (accesses,) = (kinds == w.ACCESS).nonzero()
    calls, counters = took[accesses, w.CALL_STALLS :].nonzero()
    on_bus = accesses[calls]
    (locked,) = (is_call & (interlocks > 0)).nonzero()
    interlock = np.full(len(locked), NUMBER_OF[StallReason.INTERLOCK])
    parts = [
        (on_bus, _ON_BUS[counters], took[on_bus, w.CALL_STALLS + counters]),
        (locked, interlock, interlocks[locked]),
        (is_wait.nonzero()[0], _OF_ACCOUNT[reasons], waits_cclk),
    ]
    rows = np.column_stack([np.concatenate(column) for column in zip(*parts, strict=True)])
    found: Rows = rows[rows[:, 0].argsort(kind="stable")]
    return found


_ON_BUS = np.array([NUMBER_OF[each] for each in BUS_STALLS])
_OF_ACCOUNT = np.array(
    [0, *(NUMBER_OF[REASON_OF_ACCOUNT[each]] for each in (w.SETTING_UP, w.RING_EMPTY, w.RING_FULL))]
)
"""Numbers of reasons in columns of spans, by the counters of `bus.state`."""
