"""How long the rest of a sweep will take, from the times of its points so far."""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.sweeping.planned import Planned
from bfsim.sweeping.running import Outcome


class Pace:
    """The seconds that a worker needs for a pixel: for each kind of points, and for all together if a kind is unknown."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, ...], tuple[float, float]] = {}  # seconds, and pixels

    def add(self, planned: Planned, outcome: Outcome) -> None:
        """Learn from a finished point, or from some frames of one."""
        if outcome.frames:
            seconds, work = self._known.get(planned.kind, (0.0, 0.0))
            work += planned.work * outcome.frames / planned.frames
            self._known[planned.kind] = seconds + outcome.seconds, work

    def unknown(self, todo: Sequence[Planned]) -> list[Planned]:
        """Return one point of each kind without known times."""
        firsts: dict[tuple[str, ...], Planned] = {}
        for each in todo:
            firsts.setdefault(each.kind, each)
        return [each for kind, each in firsts.items() if kind not in self._known]

    def seconds_left(self, todo: Sequence[Planned], workers: int) -> float | None:
        """Return how long this many workers take for the points; None if unknown."""
        if not todo or not self._known:
            return None if todo else 0
        of_all = tuple(map(sum, zip(*self._known.values(), strict=True)))
        paces = (self._known.get(each.kind, of_all) for each in todo)
        seconds = sum(each.work * of / work for each, (of, work) in zip(todo, paces, strict=True))
        return seconds / min(workers, len(todo))


def in_words(seconds: float | None) -> str:
    """Return a time in words."""
    if seconds is None:
        return "nobody knows how long"
    for length, unit in ((24 * 3600, "days"), (3600, "h"), (60, "min")):
        if seconds >= 2 * length:
            return f"about {seconds / length:.1f} {unit}"
    return f"about {seconds:.0f} s"
