"""Spans as columns of numbers: a frame has tens of thousands, and making a record of each takes longer than using them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from bfsim.spans import NO_STALLS, Place, Span, SpanKind
from bfsim.trace import StallReason

Ints = NDArray[np.int64]
REASONS = tuple(StallReason)
"""Reasons of stalls, by number."""
NUMBER_OF = {reason: number for number, reason in enumerate(REASONS)}
KINDS = tuple(SpanKind)


class What(NamedTuple):
    """What a span is: the fields of `Span` with these names."""

    kind: SpanKind
    where: str
    name: str
    stage: str


class Whats:
    """Every `What` of a timeline's spans, by number."""

    def __init__(self) -> None:
        self.all: list[What] = []
        self.stages: dict[tuple[str, str], int] = {}
        """Numbers of pairs of `where` and stage."""
        # hashing a kind takes longer than its id
        self._numbers: dict[tuple[int, str, str, str], int] = {}
        self._known: list[tuple[int, int]] = []  # numbers of kind and stage of each
        self._columns: Ints = np.zeros((2, 0), np.int64)

    def number(self, kind: SpanKind, where: str, name: str, stage: str = "") -> int:
        """Return the number of a `What`, which may be new."""
        key = id(kind), where, name, stage
        found = self._numbers.get(key)
        if found is None:
            found = self._numbers[key] = len(self.all)
            self.all.append(What(kind, where, name, stage))
            in_stage = self.stages.setdefault((where, stage), len(self.stages))
            self._known.append((KINDS.index(kind), in_stage))
        return found

    def in_stages(self) -> Ints:
        """Return for each `What` the number of its pair in `stages`."""
        stages: Ints = self._kinds_and_stages()[1]
        return stages

    def are(self, *kinds: SpanKind) -> NDArray[np.bool_]:
        """Return for each `What` whether it is of one of these kinds."""
        return np.isin(self._kinds_and_stages()[0], [KINDS.index(each) for each in kinds])

    def _kinds_and_stages(self) -> Ints:
        if self._columns.shape[1] != len(self._known):
            self._columns = np.array(self._known, np.int64).T
        return self._columns


PER_SPAN = "what", "begin_cclk", "end_cclk", "issue_cclk", "value", "flow", "place"
PER_STALL = "stalled", "reason", "stall_cclk"
NO_ROWS: Ints = np.zeros((0, len(PER_STALL)), np.int64)


@dataclass(frozen=True, slots=True, kw_only=True)
class SpanColumns:
    """A row for each span. `what` and `place` are numbers in `whats` and `places`; the others are fields of `Span`.

    Stalls have their own rows: the row of the span, the number of the reason in REASONS, and the cycles.
    """

    whats: Whats
    places: Sequence[Place | None]
    what: Ints
    begin_cclk: Ints
    end_cclk: Ints
    issue_cclk: Ints
    value: Ints
    flow: Ints
    place: Ints
    stalled: Ints
    reason: Ints
    stall_cclk: Ints

    @classmethod
    def of(
        cls, whats: Whats, spans: Ints, stalls: Ints = NO_ROWS, places: Sequence[Place | None] = (None,)
    ) -> SpanColumns:
        """Return span columns from tables whose columns are in the order of PER_SPAN and PER_STALL."""
        return cls(
            whats=whats,
            places=places,
            **dict(zip(PER_SPAN, spans.T, strict=True)),
            **dict(zip(PER_STALL, stalls.T, strict=True)),
        )

    def __len__(self) -> int:
        return len(self.what)

    @property
    def elapsed_cclk(self) -> Ints:
        """Cycles from begin to end."""
        return self.end_cclk - self.begin_cclk

    def are(self, *kinds: SpanKind) -> NDArray[np.bool_]:
        """Return for each row whether its span is of one of these kinds."""
        return self.whats.are(*kinds)[self.what]

    def rows(self, wanted: NDArray[np.bool_]) -> SpanColumns:
        """Return the wanted rows."""
        has_row = wanted[self.stalled]
        kept = {name: getattr(self, name)[wanted] for name in PER_SPAN}
        kept |= {name: getattr(self, name)[has_row] for name in PER_STALL}
        kept["stalled"] = (wanted.cumsum() - 1)[kept["stalled"]]
        return replace(self, **kept)

    def anywhere(self) -> SpanColumns:
        """Return the rows without their places."""
        return replace(self, places=(None,), place=np.zeros_like(self.place))

    def spans(self) -> Iterator[Span]:
        """Yield a record of each span."""
        stalls: dict[int, dict[StallReason, int]] = {}
        for row, reason, cclk in zip(*(getattr(self, each).tolist() for each in PER_STALL), strict=True):
            stalls.setdefault(row, {})[REASONS[reason]] = cclk
        rows = zip(*(getattr(self, each).tolist() for each in PER_SPAN), strict=True)
        for row, (what, begin_cclk, end_cclk, issue_cclk, value, flow, place) in enumerate(rows):
            kind, where, name, stage = self.whats.all[what]
            stall_cclk, about = stalls.get(row, NO_STALLS), self.places[place]
            yield Span(
                kind, where, name, begin_cclk, end_cclk, stage, issue_cclk, stall_cclk, value, flow, about
            )


def columns_of(spans: SpanColumns | Iterable[Span], whats: Whats) -> SpanColumns:
    """Return spans as columns, with numbers of `whats` unless they are columns already."""
    if isinstance(spans, SpanColumns):
        return spans
    if isinstance(spans, Spans):
        return spans.columns
    rows = list(spans)
    numbers = [
        (whats.number(kind, where, name, stage), begin_cclk, end_cclk, issue_cclk, value, flow, row)
        for row, (kind, where, name, begin_cclk, end_cclk, stage, issue_cclk, _, value, flow, _) in enumerate(
            rows
        )
    ]
    stalls = [
        (row, NUMBER_OF[reason], cclk)
        for row, each in enumerate(rows)
        for reason, cclk in each.stall_cclk.items()
    ]
    return SpanColumns.of(
        whats,
        np.array(numbers, np.int64).reshape(-1, len(PER_SPAN)),
        np.array(stalls, np.int64).reshape(-1, len(PER_STALL)),
        [each.place for each in rows],
    )


def joined(parts: Sequence[SpanColumns]) -> SpanColumns:
    """Return the rows of all parts, at least one. All parts with rows have the `whats` of the last part."""
    columns = {
        name: np.concatenate([getattr(each, name) for each in parts]) for name in (*PER_SPAN, *PER_STALL)
    }
    for name, counts, repeats in (
        ("place", [len(each.places) for each in parts], [len(each) for each in parts]),
        ("stalled", [len(each) for each in parts], [len(each.stalled) for each in parts]),
    ):
        columns[name] += np.repeat(np.cumsum([0, *counts[:-1]]), repeats)
    return SpanColumns(
        whats=parts[-1].whats, places=[place for each in parts for place in each.places], **columns
    )


class Spans(Sequence[Span]):
    """The spans told at one time: records for consumers that read them one by one, columns for those that count."""

    def __init__(self, parts: Sequence[SpanColumns | Sequence[Span]], whats: Whats) -> None:
        self._parts = parts
        self._whats = whats

    @cached_property
    def columns(self) -> SpanColumns:
        """All spans as columns."""
        return joined([columns_of(each, self._whats) for each in (*self._parts, ())])

    @cached_property
    def _records(self) -> list[Span]:
        return [
            each for part in self._parts for each in (part.spans() if isinstance(part, SpanColumns) else part)
        ]

    def __len__(self) -> int:
        return sum(map(len, self._parts))

    @overload
    def __getitem__(self, index: int) -> Span: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Span]: ...
    def __getitem__(self, index: int | slice) -> Span | Sequence[Span]:
        return self._records[index]

    def __iter__(self) -> Iterator[Span]:
        return iter(self._records)
