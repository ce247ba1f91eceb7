"""The bars of a Gantt chart: what took most of each slice of time, on each track."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bfsim.report.html.gantt_cells import WAITS, Cells, Key, cells_of
from bfsim.spans.columns import SpanColumns

SLICES = 400
"""Of a frame: about as many as a screen can show. Half of them, or fewer, where that makes more than MOST_BARS."""
MOST_BARS = 1500
"""So many fit into a page of a hundred frames: some 20 KB."""

_QUARTERS = 4
Bar = tuple[int, int, int, int, int]
"""Track, key, first slice, last slice, and quarters of their time that were busy."""


def chart_of(
    spans: SpanColumns, begin_cclk: int, end_cclk: int, cclk_hz: float, slices: int = SLICES
) -> dict[str, Any]:
    """Return the bars of what went on between two cycles, and the names of their tracks and keys.

    `slice_ms` is how long a slice is: the time has `slices` of them, or so many fewer that there are not too many bars.
    """
    length = max(slices, end_cclk - begin_cclk)
    cells, parts = cells_of(spans, begin_cclk, end_cclk, slices, length), length
    tracks = sorted(cells.tracks, key=track_order)
    while True:
        keys, bars = _bars(cells, {track: place for place, track in enumerate(tracks)}, parts)
        if len(bars) <= MOST_BARS or parts >= slices * length:
            break
        cells, parts = cells.halved(), 2 * parts
    return {
        "tracks": tracks,
        "keys": [list(key) for key in keys],
        "slice_ms": 1000 * parts / slices / cclk_hz,
        "bars": bars,
    }


def _bars(cells: Cells, places: Mapping[str, int], slice_parts: int) -> tuple[list[Key], list[Bar]]:
    """Return the bars of all tracks, whose `places` are told, and what they mean: neighbours that are alike become one."""
    keys, bars = dict[Key, int](), list[Bar]()
    for track, number, key, parts in cells.most(places):
        least = 0 if track.endswith(WAITS) else 1
        quarters = min(_QUARTERS, max(least, round(parts / slice_parts * _QUARTERS)))
        if not quarters:
            continue
        place, name = places[track], keys.setdefault(key, len(keys))
        if bars and (*bars[-1][:2], *bars[-1][3:]) == (place, name, number - 1, quarters):
            bars[-1] = (place, name, bars[-1][2], number, quarters)
        else:
            bars.append((place, name, number, number, quarters))
    return list(keys), bars


def track_order(track: str) -> tuple[bool, str]:
    """Cores come first."""
    return not track.startswith("core "), track
