"""The bars of a Gantt chart: what took most of each slice of time, on each track."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bfsim.report.html.gantt_cells import WAITS, Cells, Key, cells_of
from bfsim.spans.columns import SpanColumns

SLICES = 400
"""Slices of a frame, about as many as a screen can show. They are halved until there are at most MOST_BARS bars."""
MOST_BARS = 1500
"""The most bars of a frame, some 20 KB, for a page of a hundred frames."""

_QUARTERS = 4
Bar = tuple[int, int, int, int, int]
"""Track, key, first slice, last slice, and how many quarters of their time were busy."""


def chart_of(
    spans: SpanColumns, begin_cclk: int, end_cclk: int, cclk_hz: float, slices: int = SLICES
) -> dict[str, Any]:
    """Return the bars of what happened between two cycles, and the names of their tracks and keys.

    `slice_ms` is the length of a slice: there are `slices` of them, or fewer if there would be too many bars.
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
    """Return the bars of all tracks, at their `places`, and their keys; like neighbours become one bar."""
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
    """Return a key that sorts cores first."""
    return not track.startswith("core "), track
