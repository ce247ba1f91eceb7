"""What each core and device did in each frame, coarse enough for a page: what took most of each slice of time."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

from bfsim.files.spool import Spool
from bfsim.report.html.gantt_bars import chart_of, track_order
from bfsim.spans import Span, SpanKind
from bfsim.spans.columns import SpanColumns, Whats, columns_of, joined
from bfsim.trace import Identity

_LEFT_OUT = (SpanKind.FRAME, SpanKind.LEVEL)


@dataclass(slots=True)
class _Window:
    """The time of a frame on all cores that have reported its end, in cycles."""

    begin_cclk: int
    end_cclk: int
    cores: set[str] = field(default_factory=set)


class Gantts:
    """The Gantt chart of each frame, by its index. A context manager.

    Only the spans of some two frames are in memory; `is_wanted` says for which frames a chart is drawn. Raises
    ConfigError if there is no room for its file.
    """

    def __init__(self, is_wanted: Callable[[int], bool] = lambda _index: True) -> None:
        self._is_wanted = is_wanted
        self.tracks: tuple[str, ...] = ()
        self.meanings: set[str] = set()
        self._cclk_hz = 1.0
        self._cores: set[str] = set()
        self._whats = Whats()
        self._nothing = columns_of((), self._whats)
        self._spans: list[SpanColumns] = []
        self._windows: dict[int, _Window] = {}
        self._spool = Spool()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._spool.__exit__()

    def begin(self, identity: Identity, _frames: int) -> None:
        """Note how long a cycle is."""
        self._cclk_hz = identity.cclk_hz

    def add(self, spans: Sequence[Span]) -> None:
        """Take spans as they come."""
        columns = columns_of(spans, self._whats)
        for span in columns.rows(columns.are(SpanKind.FRAME, SpanKind.STAGE)).spans():
            if span.kind is SpanKind.FRAME:
                self._end(span)
            else:
                self._cores.add(span.where)
        self._spans.append(columns.rows(~columns.are(*_LEFT_OUT)).anywhere())
        # each core reports the end of a frame; a frame is surely complete when a later one is
        while len(self._windows) > 1 and self._windows[min(self._windows)].cores >= self._cores:
            self._draw(min(self._windows))

    def finish(self) -> None:
        """Draw what is still to be drawn."""
        for index in sorted(self._windows):
            self._draw(index)

    def chart(self, index: int) -> dict[str, Any] | None:
        """Return the chart of a frame in the form of `chart_of`; None if there is none."""
        found: dict[str, Any] | None = json.loads(self._spool[index]) if index in self._spool else None
        return found

    def _end(self, span: Span) -> None:
        index = int(span.name.removeprefix("frame "))
        window = self._windows.setdefault(index, _Window(span.begin_cclk, span.end_cclk))
        window.begin_cclk = min(window.begin_cclk, span.begin_cclk)
        window.end_cclk = max(window.end_cclk, span.end_cclk)
        window.cores.add(span.where)

    def _draw(self, index: int) -> None:
        window = self._windows.pop(index)
        if self._is_wanted(index):
            chart = chart_of(
                joined([self._nothing, *self._spans]), window.begin_cclk, window.end_cclk, self._cclk_hz
            )
            self.tracks = tuple(sorted({*self.tracks, *chart["tracks"]}, key=track_order))
            self.meanings.update(meaning for meaning, _ in chart["keys"])
            self._spool.put(index, json.dumps(chart, separators=(",", ":")).encode())
        following = min((each.begin_cclk for each in self._windows.values()), default=window.end_cclk)
        self._spans = [each.rows(each.end_cclk > following) for each in self._spans]
        self._spans = [each for each in self._spans if len(each)]
