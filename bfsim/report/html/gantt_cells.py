"""How long what went on in each slice of a frame, on each track: arrays, for a frame has tens of thousands of spans."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.spans import Span, SpanKind

WORK, STALL, IDLE, BUSY = "work", "stall", "idle", "busy"
"""What a bar can mean, beside the name of a stage."""

_MEANING = {
    SpanKind.CALL: WORK, SpanKind.WORK: WORK, SpanKind.STALL: STALL, SpanKind.IDLE: IDLE, SpanKind.INTERRUPT: BUSY,
    SpanKind.TRANSFER: BUSY, SpanKind.LINE: BUSY, SpanKind.MESSAGE: BUSY, SpanKind.LOCK: BUSY,
}  # fmt: skip
WAITS = " waits"
"""What the track of a core's waits is called behind its name. It has those that take an eighth of a slice or more."""

Key = tuple[str, str]
"""What a bar means, and its name: of a kernel, a reason, a stage, what is moved."""

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Cells:
    """What was going on in slices: which of the `names`, a track and a key, in which slice, and for how many parts of it.

    Each comes once. `firsts`: the order in which they came.
    """

    names: tuple[tuple[str, Key], ...]
    kinds: Ints
    slices: Ints
    parts: Ints
    firsts: Ints

    def halved(self) -> Cells:
        """Return half as many slices, each as long as two."""
        return _summed(self.names, self.kinds, self.slices // 2, self.parts, self.firsts)

    def most(self, tracks: Mapping[str, int]) -> Iterator[tuple[str, int, Key, int]]:
        """Yield for each slice of each track, in the order of `tracks`, what took most of it, and how many parts of it had anything.

        What took most: first of what it can mean, then of the names of that.
        """
        meanings = {
            meaning: place for place, meaning in enumerate(dict.fromkeys(key[0] for _, key in self.names))
        }
        track_of = np.array([tracks[track] for track, _ in self.names], np.int64)[self.kinds]
        meaning_of = np.array([meanings[key[0]] for _, key in self.names], np.int64)[self.kinds]
        groups, (parts, _) = _sums((track_of, self.slices), self.parts, self.firsts)
        alike, (of_meaning, firsts) = _sums((groups, meaning_of), self.parts, self.firsts)
        order = np.lexsort((self.firsts, -self.parts, firsts[alike], -of_meaning[alike], groups))
        best = order[np.diff(groups[order], prepend=-1) > 0]
        for kind, number, whole in zip(
            self.kinds[best].tolist(), self.slices[best].tolist(), parts.tolist(), strict=True
        ):
            track, key = self.names[kind]
            yield track, number, key, whole


def cells_of(spans: Sequence[Span], begin_cclk: int, end_cclk: int, slices: int, length: int) -> Cells:
    """Return how long what was going on in each slice of each track between two cycles.

    In parts of a cycle, of which a cycle has `slices` and a slice `length`, nothing is rounded.
    """
    names, kinds, begins, ends, cclk = _shares(spans)
    elapsed = ends - begins
    begins, ends = ((np.clip(each, begin_cclk, end_cclk) - begin_cclk) * slices for each in (begins, ends))
    firsts, counts = begins // length, np.where(ends > begins, -(-ends // length) - begins // length, 0)
    each = np.repeat(np.arange(len(kinds)), counts)
    numbers = firsts[each] + np.arange(len(each)) - np.repeat(counts.cumsum() - counts, counts)
    overlaps = np.minimum(ends[each], (numbers + 1) * length) - np.maximum(begins[each], numbers * length)
    return _summed(names, kinds[each], numbers, _part(overlaps, cclk[each], elapsed[each]), each)


def _shares(spans: Sequence[Span]) -> tuple[tuple[tuple[str, Key], ...], Ints, Ints, Ints, Ints]:
    """Return the names of what spans are, and what each has of whom: which name, from when to when, and how many cycles.

    A span lies on its own track, and on that of its core's waits.
    """
    names = dict[tuple[str, Key], int]()
    kinds, wheres, whats, begins, ends, _, _, stalls, *_ = _columns(spans, len(Span._fields))
    own = list(
        zip(map(id, kinds), wheres, whats, strict=True)
    )  # the hash of a kind takes as long as all else
    numbers: dict[object, int] = {
        one: names.setdefault((_track(each), (_MEANING.get(each.kind, each.name), each.name)), len(names))
        for one, each in dict(zip(own, spans, strict=True)).items()
    }
    places, reasons, stalled_cclk = _columns(
        [(place, *each) for place, stalled in enumerate(stalls) if stalled for each in stalled.items()], 3
    )
    waits = [(own[place], reason) for place, reason in zip(places, map(id, reasons), strict=True)]
    for one, (place, reason) in dict(zip(waits, zip(places, reasons, strict=True), strict=True)).items():
        wait = f"{wheres[place]}{WAITS}", (reason.value, whats[place])
        numbers[one] = names.setdefault(wait, len(names))
    begin, end, at = (np.array(each, np.int64) for each in (begins, ends, places))
    return (
        tuple(names),
        np.array([numbers[each] for each in (*own, *waits)], np.int64),
        np.concatenate([begin, begin[at]]),
        np.concatenate([end, end[at]]),
        np.concatenate([end - begin, np.array(stalled_cclk, np.int64)]),
    )


def _columns(rows: Sequence[tuple[Any, ...]], count: int) -> tuple[tuple[Any, ...], ...]:
    """Return rows as so many columns."""
    return tuple(zip(*rows, strict=True)) or count * ((),)


def _part(overlaps: Ints, cclk: Ints, elapsed: Ints) -> Ints:
    """Return so many parts of what overlaps, rounded down."""
    is_large = int(overlaps.max(initial=0)) * int(cclk.max(initial=0)) >= 1 << 63
    exact = overlaps.astype(object) if is_large else overlaps
    return np.asarray(exact * cclk // elapsed, np.int64)


def _summed(
    names: tuple[tuple[str, Key], ...], kinds: Ints, slices: Ints, parts: Ints, firsts: Ints
) -> Cells:
    """Return what comes several times as one."""
    cells, (parts, firsts) = _sums((kinds, slices), parts, firsts)
    _, where = np.unique(cells, return_index=True)
    return Cells(names, kinds[where], slices[where], parts, firsts)


def _sums(by: tuple[Ints, Ints], parts: Ints, firsts: Ints) -> tuple[Ints, tuple[Ints, Ints]]:
    """Return which group each number is in, by two numbers, in their order; and of each group the sum of the parts and the first."""
    one, other = by
    found, groups = np.unique(one * (int(other.max(initial=0)) + 1) + other, return_inverse=True)
    sums, first = np.zeros(len(found), np.int64), np.full(len(found), np.iinfo(np.int64).max)
    np.add.at(sums, groups, parts)
    np.minimum.at(first, groups, firsts)
    return groups, (sums, first)


def _track(span: Span) -> str:
    where, track = span.track
    return where if track == "transfers" else f"{where} {track}"
