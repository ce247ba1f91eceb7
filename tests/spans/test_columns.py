"""Spans as columns: nothing is lost on the way there and back."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from bfsim.spans import Place, Span, SpanKind
from bfsim.spans.columns import SpanColumns, Spans, Whats, columns_of, joined
from bfsim.trace import StallReason

PLACES = st.none() | st.builds(lambda row: Place(range(row, row + 1)), st.integers(0, 3))
STALLS = st.dictionaries(st.sampled_from(StallReason), st.integers(1, 9), max_size=3)
SPANS = st.lists(
    st.builds(
        Span,
        st.sampled_from(SpanKind),
        st.sampled_from(["core A", "PPI0"]),
        st.sampled_from(["sobel", "line 3"]),
        st.integers(0, 99),
        st.integers(100, 1 << 60),
        st.sampled_from(["", "Edges"]),
        st.integers(0, 9),
        STALLS,
        st.integers(0, 9),
        st.integers(0, 9),
        PLACES,
    ),
    max_size=8,
)


def back(columns: SpanColumns) -> list[Span]:
    """The spans again."""
    return list(columns.spans())


@given(SPANS, SPANS)
def test_spans_become_columns_and_spans_again(first: list[Span], second: list[Span]) -> None:
    """Alone, joined, and as what a timeline hands out, in which some are columns already."""
    whats = Whats()
    one, other = columns_of(first, whats), columns_of(second, whats)
    assert back(one) == first
    assert back(joined([one, other])) == first + second
    spans = Spans([one, second], whats)
    assert list(spans) == first + second
    assert (len(spans), spans[:]) == (len(first + second), first + second)
    assert back(columns_of(spans, Whats())) == first + second


@given(SPANS, st.lists(st.booleans(), min_size=8, max_size=8))
def test_some_rows_are_those_spans(spans: list[Span], some: list[bool]) -> None:
    """With their stalls and places; or of some kinds, or without places."""
    columns, wanted = columns_of(spans, Whats()), some[: len(spans)]
    kept = [each for each, is_wanted in zip(spans, wanted, strict=True) if is_wanted]
    assert back(columns.rows(np.array(wanted, bool))) == kept
    calls = columns.rows(columns.are(SpanKind.CALL, SpanKind.FRAME))
    assert back(calls) == [each for each in spans if each.kind in {SpanKind.CALL, SpanKind.FRAME}]
    assert back(columns.anywhere()) == [each._replace(place=None) for each in spans]
