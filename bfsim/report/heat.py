"""Where in the pictures the time went: a fold over the timeline, frame by frame, and no more than a frame or two in memory."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bfsim.seen import CAMERAS, Seen, SeenFrame, SeenHeat
from bfsim.spans import Place, Span, SpanKind
from bfsim.trace import REST, BudgetRow, Identity

Cycles = Mapping[tuple[str, Place | None], int]
"""The cycles of a core in a frame by stage and place; None is no place."""

CORES = {camera: f"core {core}" for core, camera in CAMERAS.items()}
"""Who looks at the pictures of each camera."""

_FILLING = {SpanKind.CALL, SpanKind.WORK, SpanKind.STALL, SpanKind.IDLE}


class Heats:
    """The cycles by place of each frame that a core has finished. What is of no frame is left out."""

    def __init__(self) -> None:
        self._open: dict[str, Counter[tuple[str, Place | None]]] = defaultdict(Counter)
        self._done: dict[tuple[int, str], Cycles] = {}

    def add(self, spans: Iterable[Span]) -> None:
        """Take what happened next."""
        for each in spans:
            if each.kind in _FILLING:
                self._open[each.where][each.stage, each.place] += each.elapsed_cclk
            elif each.kind is SpanKind.FRAME:
                self._done[each.value, each.where] = self._open.pop(each.where, Counter())

    def has(self, frame: int, core: str) -> bool:
        """Whether a core, such as "core A", has finished a frame."""
        return (frame, core) in self._done

    def of(self, frame: int, core: str) -> Cycles:
        """Return the cycles of a frame that a core has finished."""
        return self._done[frame, core]

    def forget(self, frame: int) -> None:
        """Forget a frame and those before it."""
        self._done = {key: each for key, each in self._done.items() if key[0] > frame}


def heat_of(cycles: Cycles, stages: Sequence[str], width_px: int, height_px: int, cclk_hz: float) -> SeenHeat:
    """Return the heat of some stages in a picture: the time of a place goes evenly to its pixels.

    What is beyond the picture is elsewhere.
    """
    us_of_cclk = 1e6 / cclk_hz
    shares = {stage: np.zeros((height_px, width_px)) for stage in stages}
    elsewhere = dict.fromkeys(stages, 0.0)
    for (stage, place), cclk in cycles.items():
        if stage not in shares:
            continue
        where = _pixels_of(place, width_px, height_px) if place else None
        pixels = shares[stage][where].size if where else 0
        if pixels:
            shares[stage][where] += cclk * us_of_cclk / pixels
        else:
            elsewhere[stage] += cclk * us_of_cclk
    return SeenHeat(stages_us=shares, elsewhere_us=elsewhere)


def _pixels_of(place: Place, width_px: int, height_px: int) -> tuple[slice | list[int], slice | list[int]]:
    """Return rows and columns of a place as numpy takes them, without those beyond the picture."""
    if isinstance(place.rows, range):
        return _slice_of(place.rows), _columns_within(place.columns, width_px)
    assert isinstance(place.columns, tuple)
    within = [
        (row, column)
        for row, column in zip(place.rows, place.columns, strict=True)
        if 0 <= row < height_px and 0 <= column < width_px
    ]
    return [row for row, _ in within], [column for _, column in within]


def _slice_of(rows: range) -> slice:
    return slice(max(rows.start, 0), max(rows.stop, 0))


def _columns_within(columns: range | tuple[int, ...] | None, width_px: int) -> slice | list[int]:
    """Return the columns of a place as numpy takes them, without those beyond the picture."""
    if columns is None:
        return slice(0, width_px)
    if isinstance(columns, range):
        return _slice_of(columns)
    return [each for each in columns if 0 <= each < width_px]


def stages_of(rows: Sequence[BudgetRow], name: str | None = None) -> tuple[str, ...]:
    """Return the stages that row `name` of a budget holds, its own first; without a name all, and what is in no stage.

    Raises KeyError where there is no such row.
    """
    if name is None:
        return (*(each.stage for each in rows), REST)
    if name not in {each.stage for each in rows}:
        raise KeyError(name)
    parts = (part for each in rows if each.within == name for part in stages_of(rows, each.stage))
    return (name, *parts)


class HeatedFrames:
    """Takes frames that were seen and the timeline, and passes each frame on with the heat of `stages` in it.

    A frame waits for the timeline to reach its end on every core that looked at it.
    """

    def __init__(self, stages: Sequence[str], pass_on: Sequence[Callable[[SeenFrame], None]]) -> None:
        self._stages = stages
        self._pass_on = pass_on
        self._heats = Heats()
        self._waiting: list[SeenFrame] = []
        self._cclk_hz = 1.0

    def begin(self, identity: Identity, _frames: int) -> None:
        """Take note of what will run."""
        self._cclk_hz = identity.cclk_hz

    def add(self, frame: SeenFrame) -> None:
        """Take what was seen in the next frame."""
        self._waiting.append(frame)
        self._go_on()

    def add_spans(self, spans: Iterable[Span]) -> None:
        """Take what happened next."""
        self._heats.add(spans)
        self._go_on()

    def _go_on(self) -> None:
        while self._waiting and self._is_whole(self._waiting[0]):
            frame = self._waiting.pop(0)
            heated = replace(frame, cameras=tuple(self._heated(frame.index, each) for each in frame.cameras))
            self._heats.forget(frame.index)
            for each in self._pass_on:
                each(heated)

    def _is_whole(self, frame: SeenFrame) -> bool:
        return all(self._heats.has(frame.index, CORES[each.camera]) for each in frame.cameras)

    def _heated(self, frame: int, seen: Seen) -> Seen:
        cycles = self._heats.of(frame, CORES[seen.camera])
        heat = heat_of(cycles, self._stages, seen.width_px, seen.height_px, self._cclk_hz)
        return replace(seen, heat=heat)
