"""The frames of a long run that are drawn for its page, chosen as they end: a page shows at most a hundred."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from heapq import nlargest

from bfsim.report.html.frames import WORST, is_spaced
from bfsim.spans import Span, SpanKind
from bfsim.spans.columns import Whats, columns_of
from bfsim.trace import Identity

_ENDING = 4
"""The most frames that one core may have ended and another not yet."""


class Chosen:
    """Frames that are evenly spaced over a run, and the worst so far; some of these are drawn in vain."""

    def __init__(self) -> None:
        self.frames = 1
        self._places: dict[int, int] = {}  # position in the run, by index in the recording
        self._used_cclk: dict[int, int] = {}  # for the worst frames and those about to end, by index
        self._idle_cclk: Counter[str] = Counter()
        self._whats = Whats()

    def begin(self, _identity: Identity, frames: int) -> None:
        """Prepare for the expected number of frames; some may be missed."""
        self.frames = frames

    def add(self, spans: Iterable[Span]) -> None:
        """Take the next spans."""
        columns = columns_of(spans, self._whats)
        for each in columns.rows(columns.are(SpanKind.IDLE, SpanKind.FRAME)).spans():
            if each.kind is SpanKind.IDLE:
                self._idle_cclk[each.where] += each.elapsed_cclk
            else:
                self._end(each.value, each.elapsed_cclk - self._idle_cclk.pop(each.where, 0))

    def has(self, index: int) -> bool:
        """Whether to draw a frame that all cores have ended.

        Ask before the next one ends, as that can change which are the worst.
        """
        return is_spaced(self._places[index], self.frames) or index in self._worst()

    def _end(self, index: int, used_cclk: int) -> None:
        self._places.setdefault(index, len(self._places))
        self._used_cclk[index] = max(used_cclk, self._used_cclk.get(index, 0))
        kept = {*self._worst(), *list(self._places)[-_ENDING:]}
        self._used_cclk = {each: cclk for each, cclk in self._used_cclk.items() if each in kept}

    def _worst(self) -> list[int]:
        return nlargest(WORST, self._used_cclk, key=lambda each: self._used_cclk[each])
