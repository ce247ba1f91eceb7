"""Perfetto traces: read back by Perfetto's own schema, they are the timeline, to the cycle."""

from __future__ import annotations

import io
import os
import tracemalloc
from collections import Counter
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.boards import BOARDS
from bfsim.report.viewers.perfetto import PerfettoTrace, cycle_of
from bfsim.report.viewers.perfetto_track import ns_of
from bfsim.run import Feed, simulate
from bfsim.spans import Span, SpanKind
from bfsim.trace import StallReason
from tests.report.perfetto_files import Slice, flows_of, tracks_of

HZ = 600_000_000
CLOCKS = sorted({each.clocks.cclk_hz for each in BOARDS.values()})


def written(*spans: Span, hz: float = HZ) -> bytes:
    """Return a trace of spans."""
    stream = io.BytesIO()
    trace = PerfettoTrace(stream, hz)
    trace.add(spans)
    trace.flush()
    return stream.getvalue()


@given(st.integers(0, 10**15), st.sampled_from([*CLOCKS, Fraction(400_000_000, 3), Fraction(999_999_999)]))
def test_a_cycle_comes_back_from_its_ns(cclk: int, hz: Fraction) -> None:
    """At the clock of every board, for days; and the ns is the last one at or before the cycle."""
    ns = ns_of(cclk, hz)
    assert cycle_of(ns, hz) == cclk
    assert ns <= cclk * 10**9 / hz < ns + 1


def test_a_call_has_its_cycles_and_its_waits_within() -> None:
    """Issue and interlocks are arguments; each wait for a memory is a slice at the end of the call."""
    stalls = {StallReason.SDRAM_PAGE_HIT: 60, StallReason.L2_LATENCY: 30, StallReason.INTERLOCK: 12}
    call = Span(SpanKind.CALL, "core A", "sobel_row", 600, 600 + 300 + 102, "Edges", 300, stalls)
    track = tracks_of(written(call))["core A", "work"]
    assert track.slices == [
        Slice(
            "sobel_row",
            1000,
            1670,
            {"issue_cclk": 300, "interlocks_cclk": 12},
            (),
            [Slice("SDRAM page hit", 1520, 1620), Slice("L2 latency", 1620, 1670)],
        )
    ]


@pytest.mark.parametrize("begin", [0, 30])
def test_an_arrow_leads_from_a_transfer_to_the_end_of_its_wait(begin: int) -> None:
    """Whichever of the two began first, and whichever was told first."""
    transfer = Span(SpanKind.TRANSFER, "MDMA1 stream 0", "camera → ring", 12, 60, value=640, flow=7)
    stalls = {StallReason.RING_EMPTY: 60 - begin}
    wait = Span(SpanKind.STALL, "core A", "ring empty", begin, 60, "Edges", 0, stalls, 0, 7)
    for spans in ((transfer, wait), (wait, transfer)):
        tracks = tracks_of(written(*spans))
        (joined,) = flows_of(tracks).values()
        began = [("transfers", "camera → ring"), ("work", "ring empty")]
        assert [(name, each.name) for name, each in joined] == [
            *sorted(began, reverse=begin == 0),
            ("work", "ended"),
        ]
        assert joined[-1][1].begin_ns == ns_of(60, Fraction(HZ))
        assert [each.name for each in tracks["core A", "work"].slices] == ["ring empty"]
        assert tracks["MDMA1 stream 0", "transfers"].slices[0].arguments == {"bytes": 640}


def test_levels_are_counters() -> None:
    """A value at each change."""
    levels = [
        Span(SpanKind.LEVEL, "semaphore lines", "count", at, at + 6, value=value)
        for at, value in ((0, 0), (6, 1), (12, 2))
    ]
    track = tracks_of(written(*levels))["semaphore lines", "count"]
    assert track.samples == [(0, 0), (10, 1), (20, 2)]


@pytest.mark.exhaustive
def test_many_values_are_written_as_they_are() -> None:
    """More different packets than are kept, and more spans than are compressed together."""
    calls = [
        Span(SpanKind.CALL, "core A", f"kernel {n % 300}", n * 3 * 10**6, n * 3 * 10**6 + 1 + n, "", 1 + n)
        for n in range(40_000)
    ]
    slices = tracks_of(written(*calls))["core A", "work"].slices
    assert [(each.name, each.arguments["issue_cclk"]) for each in slices] == [
        (each.name, each.issue_cclk) for each in calls
    ]
    assert [cycle_of(each.begin_ns, Fraction(HZ)) for each in slices] == [each.begin_cclk for each in calls]


@pytest.mark.exhaustive
def test_memory_stays_flat() -> None:
    """Ten times the spans take no more memory."""
    peaks = []
    for batches in (10, 100):
        with Path(os.devnull).open("wb") as stream:
            trace = PerfettoTrace(stream, HZ)
            tracemalloc.start()
            for at in range(0, 1000 * batches, 1000):
                trace.add(
                    [Span(SpanKind.CALL, "core A", "row", at + n, at + n + 1, "", 1) for n in range(1000)]
                )
            peaks.append(tracemalloc.get_traced_memory()[1])
            tracemalloc.stop()
    assert peaks[1] < 1.2 * peaks[0]


@pytest.mark.exhaustive
@pytest.mark.parametrize("feed", [Feed.DEMAND, Feed.RECORDED])
def test_a_trace_of_the_built_in_firmware_adds_up_to_its_budget(feed: Feed) -> None:
    """Slices of each core, read back from the file alone: their cycles are the rows of the budget, and each reason its stalls."""
    stream = io.BytesIO()
    trace = PerfettoTrace(stream, HZ)
    run = simulate(frames=2, feed=feed, on_spans=trace.add)
    trace.flush()
    tracks, hz = tracks_of(stream.getvalue()), Fraction(HZ)
    assert {f"PPI{number}" for number in (0, 1)} < {device for device, _ in tracks}
    for frame in run.frames:
        for core in frame.cores:
            stages: Counter[str] = Counter()
            edges = [
                (each.name, cycle_of(each.begin_ns, hz), cycle_of(each.end_ns, hz))
                for each in tracks[f"core {core.core}", "stages"].slices
            ]
            mine = [each for each in edges if core.begin_cclk <= each[1] and each[2] <= core.end_cclk]
            for name, begin, end in mine:
                stages[name] += end - begin
            assert stages == {each.stage: each.elapsed_cclk for each in core.stages if each.elapsed_cclk}
            assert _stalls(tracks[f"core {core.core}", "work"].slices, core.begin_cclk, core.end_cclk) == sum(
                (
                    Counter({reason.value: cclk for reason, cclk in each.stall_cclk.items()})
                    for each in core.stages
                ),
                Counter(),
            )
    for flow in flows_of(tracks).values():
        names = [each.name for name, each in flow if name == "work"]
        assert sum(name == "transfers" for name, _ in flow) == 1
        assert names.count("ended") == len(names) / 2 in (1, 2)
        assert flow[-1][1].name == "ended"


def _stalls(slices: list[Slice], begin_cclk: int, end_cclk: int) -> Counter[str]:
    """Return the cycles of each reason in a frame."""
    hz, reasons = Fraction(HZ), {each.value for each in StallReason}
    stalls: Counter[str] = Counter()
    for each in slices:
        begin, end = cycle_of(each.begin_ns, hz), cycle_of(each.end_ns, hz)
        if begin_cclk <= begin and end <= end_cclk:
            if interlocks := each.arguments.get("interlocks_cclk"):
                stalls[StallReason.INTERLOCK.value] += interlocks
            for wait in (*each.children, *([each] if each.name in reasons else [])):
                stalls[wait.name] += cycle_of(wait.end_ns, hz) - cycle_of(wait.begin_ns, hz)
    return stalls
