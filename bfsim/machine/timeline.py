"""What happens when, for anyone who wants to know. Cores and devices tell it, and nothing that they do depends on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from bfsim.spans import NO_STALLS, Place, Span, SpanKind
from bfsim.spans.columns import Ints, SpanColumns, Spans, Whats
from bfsim.trace import REST, StallReason

_span = Span._make  # half the time of calling Span, and there are many
_CALL = SpanKind.CALL
_WAITS: dict[StallReason | None, tuple[SpanKind, str]] = {None: (SpanKind.IDLE, "idle")} | {
    reason: (SpanKind.STALL, reason.value) for reason in StallReason
}


class Timeline:
    """The spans that were told since the last `take`."""

    def __init__(self, cclk_ticks: int) -> None:
        self.spans: list[Span] = []
        """The latest ones, told one by one."""
        self.whats = Whats()
        self._before: list[SpanColumns | Sequence[Span]] = []
        self._cclk_ticks = cclk_ticks
        self._levels: dict[tuple[str, str], tuple[int, int]] = {}  # since which cycle, and the value

    @property
    def count(self) -> int:
        """Number of spans."""
        return len(self.spans) + sum(map(len, self._before))

    def take(self) -> Spans:
        """Return the spans that were told since the last call."""
        parts, self._before, self.spans = [*self._before, self.spans], [], []
        return Spans(parts, self.whats)

    def tell(self, columns: SpanColumns) -> None:
        """Tell many spans at once."""
        self._before += self.spans, columns
        self.spans = []

    def span(
        self,
        kind: SpanKind,
        where: str,
        name: str,
        begin_cclk: int,
        end_cclk: int,
        value: int = 0,
        flow: int = 0,
    ) -> None:
        """Tell what a device did. `value` and `flow` are as in `Span`."""
        self.spans.append(
            _span((kind, where, name, begin_cclk, end_cclk, "", 0, NO_STALLS, value, flow, None))
        )

    def level(self, where: str, name: str, value: int, at_cclk: int) -> None:
        """Note the value of a level from a cycle on, and tell its value until then. All levels begin at 0."""
        since_cclk, before = self._levels.get((where, name), (0, 0))
        if value != before:
            if at_cclk > since_cclk:
                self.span(SpanKind.LEVEL, where, name, since_cclk, at_cclk, before)
            self._levels[where, name] = at_cclk, value

    def end(self, tick: int) -> None:
        """Tell the final levels: the run is over."""
        at_cclk = self.cclk(tick)
        for (where, name), (since_cclk, value) in self._levels.items():
            if at_cclk > since_cclk:
                self.span(SpanKind.LEVEL, where, name, since_cclk, at_cclk, value)

    def cclk(self, tick: int) -> int:
        """Return the first CCLK edge at or after a tick."""
        return -(-tick // self._cclk_ticks)


class CoreTimeline:
    """What one core does. Calls, other work and waits fill its time without a gap, and so do its stages."""

    def __init__(self, timeline: Timeline, core: str) -> None:
        self._timeline = timeline
        self._where = f"core {core}"
        self._stage = REST
        self._entered_cclk = 0
        self._frame_cclk = 0
        self.said: Place | None = None
        """What the core's work is about from now on, as its firmware said last."""
        self.place: Place | None = None
        """The place that goes into the spans being told."""
        self.when_said: Callable[[Place | None], bool] | None = None
        """For a core that runs ahead: notes a place for later, and returns whether anything will be told later."""

    def say(self, place: Place | None) -> None:
        """Say what the core's work is about from now on."""
        if place != self.said:
            self.said = place
            if not (self.when_said and self.when_said(place)):
                self.place = place

    def call(
        self, kernel: str, begin_cclk: int, issue_cclk: int, stall_cclk: Mapping[StallReason, int]
    ) -> None:
        """Tell a call of a kernel, or an instruction, that began at a cycle."""
        end_cclk = begin_cclk + issue_cclk + sum(stall_cclk.values())
        self._tell(_CALL, kernel, begin_cclk, end_cclk, issue_cclk, stall_cclk)

    def work(self, begin_cclk: int, cclk: int) -> None:
        """Tell work outside kernels."""
        if cclk:
            self._tell(SpanKind.WORK, "other work", begin_cclk, begin_cclk + cclk, cclk, NO_STALLS)

    def wait(self, reason: StallReason | None, begin_cclk: int, cclk: int, flow: int = 0) -> None:
        """Tell a stall, or without a `reason` an idle wait. `flow` is that of the transfer that ended it."""
        if cclk:
            kind, name = _WAITS[reason]
            stalls = {reason: cclk} if reason else NO_STALLS
            self._tell(kind, name, begin_cclk, begin_cclk + cclk, 0, stalls, flow)

    def _tell(
        self, kind: SpanKind, name: str, begin_cclk: int, end_cclk: int,
        issue_cclk: int, stall_cclk: Mapping[StallReason, int], flow: int = 0,
    ) -> None:  # fmt: skip
        stage, place = self._stage, self.place
        self._timeline.spans.append(
            _span(
                (kind, self._where, name, begin_cclk, end_cclk, stage, issue_cclk, stall_cclk, 0, flow, place)
            )
        )

    def number(self, kind: SpanKind, name: str) -> int:
        """Return the number of something that the core does in its current stage, for `tell`."""
        return self._timeline.whats.number(kind, self._where, name, self._stage)

    def tell(self, spans: Ints, stalls: Ints, places: Sequence[Place | None]) -> None:
        """Tell many spans at once, as `SpanColumns.of` takes them."""
        self._timeline.tell(SpanColumns.of(self._timeline.whats, spans, stalls, places))

    @property
    def stage(self) -> str:
        """The core's current stage."""
        return self._stage

    def level(self, name: str, value: int, at_cclk: int) -> None:
        """Note the value of one of the core's own levels from a cycle on."""
        self._timeline.level(self._where, name, value, at_cclk)

    def interrupt(self, source: str, begin_cclk: int, end_cclk: int) -> None:
        """Tell an interrupt from its entry to its exit."""
        self._timeline.spans.append(
            Span(SpanKind.INTERRUPT, self._where, source, begin_cclk, end_cclk, self._stage)
        )

    def enter(self, stage: str, at_cclk: int) -> None:
        """Tell the stage that ends at a cycle, and begin `stage`."""
        if at_cclk > self._entered_cclk:
            self._timeline.spans.append(
                Span(SpanKind.STAGE, self._where, self._stage, self._entered_cclk, at_cclk, self._stage)
            )
        self._stage, self._entered_cclk = stage, at_cclk

    def end_frame(self, index: int, at_cclk: int) -> None:
        """Tell the frame that ends at a cycle, and its part of the last stage."""
        self.enter(self._stage, at_cclk)
        self._timeline.spans.append(
            Span(SpanKind.FRAME, self._where, f"frame {index}", self._frame_cclk, at_cclk, value=index)
        )
        self._frame_cclk = at_cclk
