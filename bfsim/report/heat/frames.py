"""Frames that were seen, each with the heat of its pictures, with only a frame or two in memory."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from bfsim.report.heat.places import Heats, heat_of
from bfsim.seen import CAMERAS, Seen, SeenFrame
from bfsim.spans import Span
from bfsim.trace import REST, BudgetRow, Identity

CORES = {camera: f"core {core}" for core, camera in CAMERAS.items()}
"""The core that looks at the pictures of each camera."""


def stages_of(rows: Sequence[BudgetRow], name: str | None = None) -> tuple[str, ...]:
    """Return the stages of row `name` of a budget, its own first; without a name, all of them, and time in no stage.

    Raises KeyError if there is no such row.
    """
    if name is None:
        return (*(each.stage for each in rows), REST)
    if name not in {each.stage for each in rows}:
        raise KeyError(name)
    parts = (part for each in rows if each.within == name for part in stages_of(rows, each.stage))
    return (name, *parts)


class HeatedFrames:
    """Takes frames that were seen and the timeline, and passes each frame on with the heat of `stages` in it.

    A frame is held back until the timeline has reached its end on every core that looked at it; if it is not wanted by
    then, it is dropped.
    """

    def __init__(
        self,
        stages: Sequence[str],
        pass_on: Sequence[Callable[[SeenFrame], None]],
        is_wanted: Callable[[int], bool] = lambda _index: True,
    ) -> None:
        self._stages = stages
        self._pass_on = pass_on
        self._is_wanted = is_wanted
        self._heats = Heats()
        self._waiting: list[SeenFrame] = []
        self._cclk_hz = 1.0

    def begin(self, identity: Identity, _frames: int) -> None:
        """Prepare for what will run."""
        self._cclk_hz = identity.cclk_hz

    def add(self, frame: SeenFrame) -> None:
        """Take what was seen in the next frame."""
        self._waiting.append(frame)
        self._go_on()

    def add_spans(self, spans: Iterable[Span]) -> None:
        """Take the next spans."""
        self._heats.add(spans)
        self._go_on()

    def _go_on(self) -> None:
        while self._waiting and self._is_whole(self._waiting[0]):
            frame = self._waiting.pop(0)
            if self._is_wanted(frame.index):
                cameras = tuple(self._heated(frame.index, each) for each in frame.cameras)
                for each in self._pass_on:
                    each(replace(frame, cameras=cameras))
            self._heats.forget(frame.index)

    def _is_whole(self, frame: SeenFrame) -> bool:
        return all(self._heats.has(frame.index, CORES[each.camera]) for each in frame.cameras)

    def _heated(self, frame: int, seen: Seen) -> Seen:
        cycles = self._heats.of(frame, CORES[seen.camera])
        heat = heat_of(cycles, self._stages, seen.width_px, seen.height_px, self._cclk_hz)
        return replace(seen, heat=heat)
