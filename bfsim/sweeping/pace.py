"""How long the rest of a sweep takes, by what its points took so far."""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.sweeping.planned import Planned
from bfsim.sweeping.running import Outcome


class Pace:
    """The seconds that one worker needs for a pixel."""

    def __init__(self) -> None:
        self._seconds = 0.0
        self._work = 0.0

    def add(self, planned: Planned, outcome: Outcome) -> None:
        """Learn from a point that is done, or of which some frames are."""
        if outcome.frames:
            self._seconds += outcome.seconds
            self._work += planned.work * outcome.frames / planned.frames

    def seconds_left(self, todo: Sequence[Planned], workers: int) -> float | None:
        """Return how long points take that so many workers share; None where nobody knows."""
        if not todo or not self._work:
            return None if todo else 0
        return sum(each.work for each in todo) * self._seconds / self._work / min(workers, len(todo))


def in_words(seconds: float | None) -> str:
    """Return a time for people."""
    if seconds is None:
        return "nobody knows how long"
    for length, unit in ((24 * 3600, "days"), (3600, "h"), (60, "min")):
        if seconds >= 2 * length:
            return f"about {seconds / length:.1f} {unit}"
    return f"about {seconds:.0f} s"
