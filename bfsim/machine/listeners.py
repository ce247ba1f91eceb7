"""The listeners of a run in progress: to frames, to what was seen in them, to time, and to the timeline."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from bfsim.clocks import Clocks
from bfsim.machine.bus.bus import Bus
from bfsim.machine.finished_frames import FinishedFrames
from bfsim.machine.simulation import Simulation
from bfsim.machine.timeline import Timeline
from bfsim.process.signals import uninterrupted
from bfsim.seen import Seen
from bfsim.spans import Span
from bfsim.trace import FrameRecord

OnFrame = Callable[[FrameRecord], None]
OnSeen = Callable[[int, tuple[Seen, ...]], None]
"""Called with the index of each frame and what its cores saw, if the firmware has a view."""
OnTime = Callable[[float], None]
"""Called now and then with the simulated time, in seconds."""
OnSpans = Callable[[Sequence[Span]], None]
"""Called repeatedly with what the cores and devices did since the last call."""

STEPS_TOLD = 2048  # events between two calls of OnTime
SPANS_TOLD = 256
"""Spans are told in batches of at least this size: small enough to be gone before Python's garbage collector looks at them."""


class Announcer:
    """Tells the listeners of one run, between its events and outside the firmware, so that their failures are not blamed on it."""

    def __init__(
        self,
        env: Simulation,
        bus: Bus,
        clocks: Clocks,
        frames: FinishedFrames,
        on_seen: OnSeen | None,
        on_time: OnTime | None,
        on_spans: OnSpans | None,
    ) -> None:
        self._env = env
        self._bus = bus
        self._clocks = clocks
        self._frames = frames
        self._on_seen = on_seen
        self._on_time = on_time
        self._on_spans = on_spans
        self._steps = 0
        if on_spans:
            env.timeline = Timeline(clocks.cclk_ticks)
            bus.records.use(env.timeline)

    def tell_step(self) -> None:
        """Tell what an event brought, if it is time to."""
        self._steps += 1
        if self._on_time and self._steps % STEPS_TOLD == 0:
            self._on_time(float(self._env.tick / self._clocks.tick_hz))
        self.tell_seen()
        timeline = self._env.timeline
        if timeline and timeline.count >= SPANS_TOLD:
            self._tell_spans(timeline)

    def tell_seen(self) -> None:
        """Tell what was seen in each finished frame, uninterrupted, so that every recorded frame is told."""
        seen = self._frames.seen
        while seen and self._on_seen:
            with uninterrupted():
                self._on_seen(*seen.pop(0))

    def tell_end(self) -> None:
        """Tell the rest of what happened: the run is over."""
        if timeline := self._env.timeline:
            self._tell_spans(timeline, is_over=True)

    def _tell_spans(self, timeline: Timeline, *, is_over: bool = False) -> None:
        """Tell what happened since the last time, or all the rest when the run is over."""
        assert self._on_spans, "there is no timeline without it"
        now = self._env.tick
        with uninterrupted():
            self._bus.records.tell(now + is_over)
            if is_over:
                timeline.end(now)
            self._on_spans(timeline.take())
