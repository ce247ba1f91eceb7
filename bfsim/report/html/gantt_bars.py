"""The bars of a Gantt chart: what took most of each slice of time, on each track."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bfsim.spans import Span, SpanKind

SLICES = 400
"""Of a frame: about as many as a screen can show. Half of them, or fewer, where that makes more than MOST_BARS."""
MOST_BARS = 1500
"""So many fit into a page of a hundred frames: some 20 KB."""

WORK, STALL, IDLE, BUSY = "work", "stall", "idle", "busy"
"""What a bar can mean, beside the name of a stage."""

_MEANING = {
    SpanKind.CALL: WORK, SpanKind.WORK: WORK, SpanKind.STALL: STALL, SpanKind.IDLE: IDLE, SpanKind.INTERRUPT: BUSY,
    SpanKind.TRANSFER: BUSY, SpanKind.LINE: BUSY, SpanKind.MESSAGE: BUSY, SpanKind.LOCK: BUSY,
}  # fmt: skip
_QUARTERS = 4
WAITS = " waits"
"""What the track of a core's waits is called behind its name. It has those that take an eighth of a slice or more."""

Key = tuple[str, str]
"""What a bar means, and its name: of a kernel, a reason, a stage, what is moved."""

Bar = tuple[int, int, int, int, int]
"""Track, key, first slice, last slice, and quarters of their time that were busy."""


def chart_of(
    spans: Sequence[Span], begin_cclk: int, end_cclk: int, cclk_hz: float, slices: int = SLICES
) -> dict[str, Any]:
    """Return the bars of what went on between two cycles, and the names of their tracks and keys.

    `slice_ms` is how long a slice is: the time has `slices` of them, or so many fewer that there are not too many bars.
    """
    length = max(slices, end_cclk - begin_cclk)
    sliced = _sliced(spans, begin_cclk, end_cclk, slices, length)
    tracks, parts = sorted(sliced, key=track_order), length
    while True:
        keys, bars = dict[Key, int](), list[Bar]()
        for place, name in enumerate(tracks):
            least = 0 if name.endswith(WAITS) else 1
            bars += _bars(place, sliced[name], keys, parts, least)
        if len(bars) <= MOST_BARS or parts >= slices * length:
            break
        sliced, parts = {name: _halved(each) for name, each in sliced.items()}, 2 * parts
    return {
        "tracks": tracks,
        "keys": [list(key) for key in keys],
        "slice_ms": 1000 * parts / slices / cclk_hz,
        "bars": bars,
    }


def _sliced(
    spans: Sequence[Span], begin_cclk: int, end_cclk: int, slices: int, length: int
) -> dict[str, dict[int, Counter[Key]]]:
    """Return how long what was going on in each slice of each track.

    In parts of a cycle, of which a cycle has `slices` and a slice `length`, nothing is rounded.
    """
    sliced: dict[str, dict[int, Counter[Key]]] = defaultdict(lambda: defaultdict(Counter))
    for span in spans:
        begin = (max(span.begin_cclk, begin_cclk) - begin_cclk) * slices
        end = (min(span.end_cclk, end_cclk) - begin_cclk) * slices
        if end <= begin:
            continue
        first, behind = begin // length, -(-end // length)
        for track, key, cclk in _shares(span):
            found = sliced[track]
            if behind == first + 1:  # most are short
                found[first][key] += (end - begin) * cclk // span.elapsed_cclk
                continue
            for number in range(first, behind):
                overlap = min(end, (number + 1) * length) - max(begin, number * length)
                found[number][key] += overlap * cclk // span.elapsed_cclk
    return sliced


def _halved(slices: Mapping[int, Counter[Key]]) -> dict[int, Counter[Key]]:
    """Return half as many slices, each as long as two."""
    found: dict[int, Counter[Key]] = defaultdict(Counter)
    for number, counts in slices.items():
        found[number // 2].update(counts)
    return found


def _shares(span: Span) -> Iterator[tuple[str, Key, int]]:
    """Yield the tracks that a span lies on, as what, and with how many of its cycles: its own, and that of its core's waits."""
    yield _track(span), (_MEANING.get(span.kind, span.name), span.name), span.elapsed_cclk
    for reason, cclk in span.stall_cclk.items():
        yield f"{span.where}{WAITS}", (reason.value, span.name), cclk


def _bars(
    place: int, slices: dict[int, Counter[Key]], keys: dict[Key, int], slice_parts: int, least: int
) -> list[Bar]:
    """Return the bars of a track, of at least so many quarters: neighbours that are alike become one."""
    bars: list[Bar] = []
    for number in sorted(slices):
        key = _most(slices[number])
        busy = sum(slices[number].values()) / slice_parts
        quarters = min(_QUARTERS, max(least, round(busy * _QUARTERS)))
        if not quarters:
            continue
        name = keys.setdefault(key, len(keys))
        if bars and (bars[-1][1], *bars[-1][3:]) == (name, number - 1, quarters):
            bars[-1] = (place, name, bars[-1][2], number, quarters)
        else:
            bars.append((place, name, number, number, quarters))
    return bars


def _most(counts: Counter[Key]) -> Key:
    """Return what took most: first of what it can mean, then of the names of that."""
    meanings = Counter[str]()
    for (meaning, _), parts in counts.items():
        meanings[meaning] += parts
    (most, _), *_ = meanings.most_common(1)
    return max((key for key in counts if key[0] == most), key=lambda key: counts[key])


def _track(span: Span) -> str:
    where, track = span.track
    return where if track == "transfers" else f"{where} {track}"


def track_order(track: str) -> tuple[bool, str]:
    """Cores come first."""
    return not track.startswith("core "), track
