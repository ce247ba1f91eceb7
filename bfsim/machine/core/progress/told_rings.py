"""How full the rings of a core that runs ahead are, told as soon as the bus knows."""

from __future__ import annotations

from collections import defaultdict, deque
from dataclasses import dataclass, field

from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.timeline import CoreTimeline


@dataclass(slots=True)
class _Output:
    """The lines of an output ring: copies without a known end, each with its cycle of sending, and the ends of the others."""

    sent: deque[tuple[int, int]] = field(default_factory=deque)
    ends: deque[int] = field(default_factory=deque)


class ToldRings:
    """Tells a `timeline` about rings, by the names of their owners."""

    def __init__(self, timeline: CoreTimeline, bus: WovenBus) -> None:
        self._timeline = timeline
        self._bus = bus
        self._outputs: dict[str, _Output] = defaultdict(_Output)

    def send(self, owner: str, copied: int, cclk: int) -> None:
        """Note that an output ring sent a line at a cycle. `copied` is the number of its copy."""
        self._outputs[owner].sent.append((copied, cclk))

    def ask(self, owner: str, *, is_there: bool, cclk: int) -> None:
        """Tell whether the next line of an input ring was there when the core asked for it."""
        self._tell(owner)  # it may have been an output ring before
        self._timeline.level(owner, int(is_there), cclk)

    def tell(self) -> None:
        """Tell how many lines were in transit when each was sent, as far as known."""
        for owner in self._outputs:
            self._tell(owner)

    def _tell(self, owner: str) -> None:
        sent, ends = self._outputs[owner].sent, self._outputs[owner].ends
        while sent and (end := self._bus.end_of(sent[0][0])) is not None:
            _, cclk = sent.popleft()
            ends.append(end)
            while ends[0] <= cclk * self._bus.cclk_ticks:
                ends.popleft()
            self._timeline.level(owner, len(ends), cclk)
