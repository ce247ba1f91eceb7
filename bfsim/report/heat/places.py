"""The cycles of a frame by place, summed up from the timeline, and their heat in a picture."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from bfsim.seen import SeenHeat
from bfsim.spans import Place, Span, SpanKind
from bfsim.spans.columns import SpanColumns, Whats, columns_of

Cycles = Mapping[tuple[str, Place | None], int]
"""The cycles of a core in a frame by stage and place; None stands for no place."""

_FILLING = (SpanKind.CALL, SpanKind.WORK, SpanKind.STALL, SpanKind.IDLE)


class Heats:
    """The cycles by place of each frame that a core has finished. Cycles outside of frames are left out."""

    def __init__(self) -> None:
        self._open: dict[str, Counter[tuple[str, Place | None]]] = defaultdict(Counter)
        self._done: dict[tuple[int, str], Cycles] = {}
        self._whats = Whats()

    def add(self, spans: Iterable[Span]) -> None:
        """Take the next spans."""
        columns = columns_of(spans, self._whats)
        columns = columns.rows(columns.are(*_FILLING, SpanKind.FRAME))
        (frames,) = columns.are(SpanKind.FRAME).nonzero()
        begin = 0
        for row in (*frames.tolist(), len(columns)):
            self._put(columns, begin, row)
            begin = row + 1
            if row < len(columns):
                where = columns.whats.all[columns.what[row]].where
                self._done[int(columns.value[row]), where] = self._open.pop(where, Counter())

    def _put(self, columns: SpanColumns, begin: int, end: int) -> None:
        """Add up the rows from `begin` to `end`, in the order in which their places come."""
        stage, count = columns.whats.in_stages()[columns.what[begin:end]], len(columns.places)
        both = stage * count + columns.place[begin:end]
        found, firsts, groups = np.unique(both, return_index=True, return_inverse=True)
        sums, stages = np.zeros(len(found), np.int64), list(columns.whats.stages)
        np.add.at(sums, groups, columns.elapsed_cclk[begin:end])
        for row in firsts.argsort().tolist():
            number, place = divmod(int(found[row]), count)
            core, name = stages[number]
            self._open[core][name, columns.places[place]] += int(sums[row])

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
    """Return the heat of some stages in a picture: the time of a place is spread evenly over its pixels.

    Places beyond the picture count as elsewhere.
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
    """Return the rows and columns of a place as numpy indices, without those beyond the picture."""
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
    """Return the columns of a place as numpy indices, without those beyond the picture."""
    if columns is None:
        return slice(0, width_px)
    if isinstance(columns, range):
        return _slice_of(columns)
    return [each for each in columns if 0 <= each < width_px]
