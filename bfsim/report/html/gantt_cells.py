"""How long each thing went on in each slice of a frame, on each track: in arrays, for a frame has some 10,000 spans."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from bfsim.spans import TRACKS, SpanKind
from bfsim.spans.columns import REASONS, Ints, SpanColumns, What

WORK, STALL, IDLE, BUSY = "work", "stall", "idle", "busy"
"""Possible meanings of a bar, besides the name of a stage."""

_MEANING = {
    SpanKind.CALL: WORK, SpanKind.WORK: WORK, SpanKind.STALL: STALL, SpanKind.IDLE: IDLE, SpanKind.INTERRUPT: BUSY,
    SpanKind.TRANSFER: BUSY, SpanKind.LINE: BUSY, SpanKind.MESSAGE: BUSY, SpanKind.LOCK: BUSY,
}  # fmt: skip
WAITS = " waits"
"""Ends the name of the track of a core's waits. It shows those that take an eighth of a slice or more."""

Key = tuple[str, str]
"""The meaning of a bar, and the name of the kernel, reason, stage or transfer."""


@dataclass(frozen=True, slots=True)
class Cells:
    """What went on in slices: one of `names`, a track and a key each; in which slice; for how many parts of it.

    Each combination occurs once. `firsts`: the order in which they came.
    """

    names: tuple[tuple[str, Key], ...]
    kinds: Ints
    slices: Ints
    parts: Ints
    firsts: Ints

    @property
    def tracks(self) -> set[str]:
        """The tracks on which something went on."""
        return {self.names[kind][0] for kind in np.unique(self.kinds).tolist()}

    def halved(self) -> Cells:
        """Return half as many slices, each twice as long."""
        return _summed(self.names, self.kinds, self.slices // 2, self.parts, self.firsts)

    def most(self, tracks: Mapping[str, int]) -> Iterator[tuple[str, int, Key, int]]:
        """Yield for each slice of each track, in the order of `tracks`, what took most of it, and its busy parts.

        What took most is decided first by meaning, then by name.
        """
        meanings = {
            meaning: place for place, meaning in enumerate(dict.fromkeys(key[0] for _, key in self.names))
        }
        track_of = np.array([tracks.get(track, 0) for track, _ in self.names], np.int64)[self.kinds]
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


def cells_of(spans: SpanColumns, begin_cclk: int, end_cclk: int, slices: int, length: int) -> Cells:
    """Return how long each thing went on in each slice of each track between two cycles.

    Lengths are in parts of a cycle, so that nothing is rounded: a cycle has `slices` parts, a slice `length`.
    """
    names, kinds, begins, ends, cclk = _shares(spans)
    elapsed = ends - begins
    begins, ends = ((np.clip(each, begin_cclk, end_cclk) - begin_cclk) * slices for each in (begins, ends))
    firsts, counts = begins // length, np.where(ends > begins, -(-ends // length) - begins // length, 0)
    each = np.repeat(np.arange(len(kinds)), counts)
    numbers = firsts[each] + np.arange(len(each)) - np.repeat(counts.cumsum() - counts, counts)
    overlaps = np.minimum(ends[each], (numbers + 1) * length) - np.maximum(begins[each], numbers * length)
    return _summed(names, kinds[each], numbers, _part(overlaps, cclk[each], elapsed[each]), each)


def _shares(spans: SpanColumns) -> tuple[tuple[tuple[str, Key], ...], Ints, Ints, Ints, Ints]:
    """Return the names that spans stand for, and for each span: the number of its name, its begin, its end, its cycles.

    A span with stalls also lies on the track of its core's waits.
    """
    names, whats = dict[tuple[str, Key], int](), spans.whats.all
    kinds = _numbered(
        spans.what,
        lambda number: names.setdefault(_name(whats[number]), len(names)),
    )
    waits = _numbered(
        spans.what[spans.stalled] * len(REASONS) + spans.reason,
        lambda number: names.setdefault(
            _wait(whats[number // len(REASONS)], number % len(REASONS)), len(names)
        ),
    )
    return (
        tuple(names),
        np.concatenate([kinds, waits]),
        np.concatenate([spans.begin_cclk, spans.begin_cclk[spans.stalled]]),
        np.concatenate([spans.end_cclk, spans.end_cclk[spans.stalled]]),
        np.concatenate([spans.elapsed_cclk, spans.stall_cclk]),
    )


def _numbered(numbers: Ints, other: Callable[[int], int]) -> Ints:
    """Return the numbers that replace these."""
    found, where = np.unique(numbers, return_inverse=True)
    return np.array([other(each) for each in found.tolist()], np.int64)[where]


def _name(what: What) -> tuple[str, Key]:
    """Return track and key of a span."""
    track = TRACKS[what.kind]
    on = what.where if track == "transfers" else f"{what.where} {track}"
    return on, (_MEANING.get(what.kind, what.name), what.name)


def _wait(what: What, reason: int) -> tuple[str, Key]:
    """Return track and key of a span's stall."""
    return f"{what.where}{WAITS}", (REASONS[reason].value, what.name)


def _part(overlaps: Ints, cclk: Ints, elapsed: Ints) -> Ints:
    """Return the share of each overlap that has cycles, in parts, rounded down."""
    is_large = int(overlaps.max(initial=0)) * int(cclk.max(initial=0)) >= 1 << 63
    exact = overlaps.astype(object) if is_large else overlaps
    return np.asarray(exact * cclk // elapsed, np.int64)


def _summed(
    names: tuple[tuple[str, Key], ...], kinds: Ints, slices: Ints, parts: Ints, firsts: Ints
) -> Cells:
    """Return cells with duplicates added up."""
    cells, (parts, firsts) = _sums((kinds, slices), parts, firsts)
    _, where = np.unique(cells, return_index=True)
    return Cells(names, kinds[where], slices[where], parts, firsts)


def _sums(by: tuple[Ints, Ints], parts: Ints, firsts: Ints) -> tuple[Ints, tuple[Ints, Ints]]:
    """Return the group of each row, by the two numbers in `by`; each group's sum of parts and its least of `firsts`."""
    one, other = by
    found, groups = np.unique(one * (int(other.max(initial=0)) + 1) + other, return_inverse=True)
    sums, first = np.zeros(len(found), np.int64), np.full(len(found), np.iinfo(np.int64).max)
    np.add.at(sums, groups, parts)
    np.minimum.at(first, groups, firsts)
    return groups, (sums, first)
