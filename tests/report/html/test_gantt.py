"""The Gantt chart of a page: each slice of a frame shows what took most of it, and no frame loses a span."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.report.html.gantt import Gantts
from bfsim.report.html.gantt_bars import SLICES, chart_of
from bfsim.run import simulate
from bfsim.spans import Span, SpanKind
from bfsim.spans.columns import Whats, columns_of
from bfsim.trace import StallReason
from tests.report.records import IDENTITY

HZ = 1_000_000.0
"""1000 cycles are 1 ms."""


def call(begin: int, end: int, name: str = "sobel") -> Span:
    """A kernel call of core A."""
    return Span(SpanKind.CALL, "core A", name, begin, end)


def stall(begin: int, end: int, name: str = "ring empty") -> Span:
    """A wait of core A."""
    return Span(SpanKind.STALL, "core A", name, begin, end)


def frame(index: int, begin: int, end: int, core: str = "A") -> Span:
    """The end of a frame, as a core tells it."""
    return Span(SpanKind.FRAME, f"core {core}", f"frame {index}", begin, end)


def bars_of(spans: list[Span], begin: int, end: int) -> list[tuple[str, str, str, int, int, int]]:
    """The bars of a chart with their words: track, meaning, name, first and last slice, quarters."""
    chart = chart_of(columns_of(spans, Whats()), begin, end, HZ)
    return [
        (chart["tracks"][track], *chart["keys"][key], first, last, quarters)
        for track, key, first, last, quarters in chart["bars"]
    ]


def test_a_slice_shows_what_took_most_of_it() -> None:
    """Ten cycles each: six against four, at the first slice for work and at the second for waiting."""
    spans = [call(0, 6), stall(6, 10), call(10, 14), stall(14, 20), call(20, SLICES * 10)]
    assert bars_of(spans, 0, SLICES * 10) == [
        ("core A work", "work", "sobel", 0, 0, 4),
        ("core A work", "stall", "ring empty", 1, 1, 4),
        ("core A work", "work", "sobel", 2, SLICES - 1, 4),
    ]


def test_work_of_many_kernels_is_more_than_one_long_wait() -> None:
    """Work wins with its dearest kernel: 3 + 3 cycles of it against 4 of a wait."""
    spans = [call(0, 3, "a"), stall(3, 7), call(7, 10, "b"), call(10, SLICES * 10)]
    assert bars_of(spans, 0, SLICES * 10)[0] == ("core A work", "work", "a", 0, 0, 4)


@pytest.mark.parametrize(
    ("busy", "quarters"), [(1, 1), (37, 1), (38, 2), (62, 2), (63, 3), (88, 4), (100, 4)]
)
def test_a_device_shows_how_busy_it_was(busy: int, quarters: int) -> None:
    """To the nearest quarter of a slice, and never nothing."""
    spans = [Span(SpanKind.TRANSFER, "MDMA1 stream 0", "a → b", 100, 100 + busy)]
    assert bars_of(spans, 0, SLICES * 100) == [("MDMA1 stream 0", "busy", "a → b", 1, 1, quarters)]


def test_waits_inside_of_calls_have_a_track_of_their_own() -> None:
    """By reason, spread evenly over the call; less than an eighth of a slice is not drawn, half of one pale."""
    stalls = {StallReason.L2_LATENCY: 500, StallReason.INTERLOCK: 100}
    waits = call(0, 1000)._replace(stall_cclk=stalls)
    hardly = call(1000, 100 * SLICES, "blur")._replace(stall_cclk={StallReason.L2_PORT: 1200})
    assert bars_of([waits, hardly], 0, 100 * SLICES) == [
        ("core A waits", "L2 latency", "sobel", 0, 9, 2),
        ("core A work", "work", "sobel", 0, 9, 4),
        ("core A work", "work", "blur", 10, SLICES - 1, 4),
    ]


def test_what_reaches_over_the_ends_of_a_frame_is_cut() -> None:
    """And what lies outside is not there; a slice of 10 cycles is 0.01 ms."""
    spans = [call(0, 5, "before"), call(900, 1_000 + 10 * SLICES + 900), call(10**6, 10**6 + 1, "after")]
    assert bars_of(spans, 1_000, 1_000 + 10 * SLICES) == [("core A work", "work", "sobel", 0, SLICES - 1, 4)]
    columns = columns_of(spans, Whats())
    assert chart_of(columns, 1_000, 1_000 + 10 * SLICES, HZ)["slice_ms"] == pytest.approx(0.01)


@given(st.lists(st.integers(1, 5_000), min_size=1, max_size=50))
def test_a_core_that_is_never_without_a_span_has_bars_without_a_gap(lengths: list[int]) -> None:
    """From the first slice to the last one, each once, whatever the frame's length."""
    spans, here = [], 7
    for number, length in enumerate(lengths):
        spans.append((call if number % 2 else stall)(here, here + length))
        here += length
    bars = bars_of(spans, 7, here)
    slices = [number for *_, first, last, _ in bars for number in range(first, last + 1)]
    assert len(slices) == len(set(slices))
    if here - 7 >= SLICES:
        assert slices == list(range(SLICES))
        assert {quarters for *_, quarters in bars} == {4}


def test_too_many_bars_become_fewer_and_longer(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half as many slices from the first bar on that is too many."""
    spans = [call(number * 10, number * 10 + 10, f"kernel {number % 2}") for number in range(SLICES)]
    monkeypatch.setattr("bfsim.report.html.gantt_bars.MOST_BARS", SLICES)
    assert len(bars_of(spans, 0, 10 * SLICES)) == SLICES
    monkeypatch.setattr("bfsim.report.html.gantt_bars.MOST_BARS", SLICES - 1)
    chart = chart_of(columns_of(spans, Whats()), 0, 10 * SLICES, HZ)
    assert len(chart["bars"]) == 1  # each of the longer slices has as much of one kernel as of the other
    assert chart["slice_ms"] == pytest.approx(0.02)


def test_a_frame_is_drawn_when_the_next_one_is_told_by_all_cores() -> None:
    """Also where one core tells its end later; its time is that of both."""
    stages = [Span(SpanKind.STAGE, f"core {core}", "Edges", 0, 4_000, "Edges") for core in "AB"]
    with Gantts() as gantts:
        gantts.begin(IDENTITY, 2)
        gantts.add([*stages, frame(0, 0, 4_000)])
        gantts.add([frame(1, 4_000, 8_000)])
        assert gantts.chart(0) is None
        gantts.add([frame(0, 0, 4_400, "B")])
        chart = gantts.chart(0)
        assert chart and chart["slice_ms"] * SLICES == pytest.approx(4.4)
        assert gantts.chart(1) is None
        gantts.finish()
        assert gantts.chart(1)
        assert gantts.tracks == ("core A stages", "core B stages")


@pytest.mark.exhaustive
def test_the_charts_of_a_run_hold_its_frames_and_memory_stays_flat() -> None:
    """Of three frames never more than two are in memory; a core's work fills each frame, and a stage has its part of it."""
    most, told = 0, 0
    with Gantts() as gantts:

        def add(spans: list[Span]) -> None:
            nonlocal most, told
            told += len(spans)
            gantts.add(spans)
            most = max(most, sum(map(len, gantts._spans)))

        done = simulate(frames=4, before=gantts.begin, on_spans=add)
        gantts.finish()
        assert most < 0.6 * told
        for record in done.frames[1:]:
            chart = gantts.chart(record.index)
            assert chart
            begin = min(core.begin_cclk for core in record.cores)
            end = max(core.end_cclk for core in record.cores)
            assert chart["slice_ms"] * SLICES == pytest.approx((end - begin) * 1000 / done.identity.cclk_hz)
            slices = Counter[str]()
            for track, key, first, last, _ in chart["bars"]:
                if chart["tracks"][track] == "core A stages":
                    slices[chart["keys"][key][0]] += last - first + 1
            assert sum(slices.values()) >= SLICES - 1
            dearest = max(record.cores[0].stages, key=lambda cost: cost.elapsed_cclk)
            share = dearest.elapsed_cclk / (end - begin)
            assert slices[dearest.stage] / SLICES == pytest.approx(share, abs=0.1)
