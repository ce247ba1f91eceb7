"""What a page of a run holds: the run's numbers, its worst frames, pictures that fit, and nobody's markup but its own."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from bfsim.report.budget.budget import budget_of
from bfsim.report.budget.target import Target
from bfsim.report.html import charts, frames
from bfsim.report.html.chosen import Chosen
from bfsim.report.html.frames import facts_of, told_of, worst_of
from bfsim.report.html.gantt import Gantts
from bfsim.report.html.gantt_bars import SLICES
from bfsim.report.html.pictures import Pictures
from bfsim.report.html.rendering import with_code
from bfsim.report.html.shrinking import Shrinker
from bfsim.report.html.sources import dearest_sources
from bfsim.spans import Span, SpanKind
from bfsim.trace import REST, BudgetRow, FrameRecord, LineCost, RunRecord, StallReason
from tests.report.evil import EVIL, Elements, evil_run
from tests.report.pages_by_hand import page_of
from tests.report.records import core_frame, cost, edge_run, frame, kernel, run_of, runs
from tests.seen_frames import frame as seen_frame
from tests.tiers import tried


def values_of(spec: charts.Spec) -> list[dict[str, float]]:
    """The data of a chart."""
    found: list[dict[str, float]] = (
        spec["layer"][0]["data"]["values"] if "layer" in spec else spec["data"]["values"]
    )
    return found


def test_all_frames_are_told_up_to_the_limit() -> None:
    """From one more on some are left out."""
    run = edge_run(*range(1, 11))
    assert told_of(run, 10, 10) == run.frames
    assert len(told_of(run, 10, 9)) == 6  # the five worst, of which one is the last, and the first


@given(st.lists(st.integers(1, 1000), min_size=1, max_size=200), st.integers(8, 40))
def test_of_many_frames_the_worst_the_first_and_the_last_are_told(used: list[int], most: int) -> None:
    """In their order, and no one twice."""
    run = edge_run(*used)
    told = [each.index for each in told_of(run, len(used), most)]
    assert told == sorted(set(told))
    assert len(told) <= most
    assert {0, len(used) - 1, *(each.index for each in worst_of(run))} <= set(told)


def ends_of(record: FrameRecord) -> list[Span]:
    """What a timeline tells of a frame, as far as it matters to whether it is one of the worst."""
    return [
        span
        for core in record.cores
        for span in (
            Span(SpanKind.IDLE, core.core, "idle", 0, sum(each.idle_cclk for each in core.stages)),
            Span(SpanKind.FRAME, core.core, "frame", core.begin_cclk, core.end_cclk, value=record.index),
        )
    ]


@given(st.lists(st.integers(1, 50), min_size=101, max_size=150), st.data())
def test_what_is_told_was_drawn_as_it_ended(used: list[int], data: st.DataObject) -> None:
    """Of a run that was cut short by Ctrl-C, too."""
    run = edge_run(*used)
    left = run.frames[: data.draw(st.integers(1, len(used)))]
    chosen, drawn = Chosen(), set[int]()
    chosen.begin(run.identity, len(used))
    for each in left:
        chosen.add(ends_of(each))
        if chosen.has(each.index):
            drawn.add(each.index)
    assert {each.index for each in told_of(replace(run, frames=left), len(used))} <= drawn


def test_of_a_thousand_frames_few_are_drawn() -> None:
    """A hundred are told; the worst five so far are others some 5 ln(1000 / 5) times where frames come in any order."""
    run, chosen, drawn = edge_run(*Random(1).sample(range(1, 1001), 1000)), Chosen(), 0
    chosen.begin(run.identity, 1000)
    for each in run.frames:
        chosen.add(ends_of(each))
        drawn += chosen.has(each.index)
    assert 100 <= drawn < 130


def test_the_worst_frame_is_the_one_that_used_most_of_a_core() -> None:
    """Idling is no use: a frame that waited long for its picture is not the worst."""
    waited = frame(0, core_frame("A", 0, cost("Edge detection", 10, idle_cclk=900)))
    worked = frame(1, core_frame("A", 910, cost("Edge detection", 20)))
    assert [each.index for each in worst_of(run_of([waited, worked]))] == [1, 0]


def test_a_frame_is_compared_with_the_median() -> None:
    """Stage by stage on each core; its slack is that of the core that used most."""
    run = edge_run(10_000, 20_000, 50_000)
    (worst,) = facts_of(run, budget_of(run), run.frames[2:], Target(40))
    edges = worst.rows[0]
    assert (edges.name, [(cell.ms, cell.more_ms) for cell in edges.cells]) == (
        "Edge detection", [(50.0, 30.0), (25.0, 15.0)],
    )  # fmt: skip
    assert (worst.used_ms, worst.slack_ms) == ({"A": 50.0, "B": 25.0}, -10.0)


def test_a_time_series_has_all_that_was_used() -> None:
    """And nothing of what was idled."""
    run = edge_run(10_000, 20_000)
    assert [(each["frame"], each["ms"]) for each in values_of(charts.time_series(run, 1, Target(9)))] == [
        (0, 5.0),
        (1, 10.0),
    ]


def test_a_stage_has_one_colour_on_the_whole_page() -> None:
    """Also where one before it is a part of another and has no bar of its own."""
    rows = (BudgetRow(stage="Edges"), BudgetRow(stage="Blur", within="Edges"), BudgetRow(stage="Lines"))
    stages = (cost(row.stage, 10) for row in rows)
    run = replace(run_of([frame(0, core_frame("A", 0, *stages, cost(REST, 1)))]), rows=rows)
    colours = charts.row_colours(run)
    assert list(colours) == ["Edges", "Lines", REST]
    for spec in (charts.time_series(run, 0, None), charts.gantt(run, ["core A stages"])):
        scale = spec["encoding"]["color"]["scale"]
        assert colours.items() <= dict(zip(scale["domain"], scale["range"], strict=True)).items()


def test_a_long_time_series_shows_the_worst_of_neighbours(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two frames a bar from the first one on for which there is no bar."""
    monkeypatch.setattr(charts, "MOST_BARS", 3)
    assert charts.frames_a_bar(edge_run(1, 2, 3)) == 1
    run = edge_run(1000, 3000, 2000, 500)
    assert charts.frames_a_bar(run) == 2
    assert [(each["frame"], each["ms"]) for each in values_of(charts.time_series(run, 0, None))] == [
        (1, 3.0),
        (2, 2.0),
    ]


@tried(6, 30)
def test_a_cycle_stack_sums_to_the_mean_frame(examples: int) -> None:
    """Work, every reason and idling, of the rows that are no part of another."""

    @settings(max_examples=examples)
    @given(runs())
    def holds(run: RunRecord) -> None:
        budget = budget_of(run)
        for core in budget.cores:
            mean_ms = core.frame.elapsed_cclk.total / len(run.frames) / 1000
            values = values_of(charts.cycle_stack(run, budget, core))
            assert sum(each["ms"] for each in values) == pytest.approx(mean_ms, abs=1e-4 * len(values))

    holds()


def test_sources_add_up_over_the_cores() -> None:
    """Lines without a cost stand where they are; the dearest kernel comes first, and what it waited counts."""
    line = LineCost(line=11, executions=5, issue_cclk=30, stall_cclk={StallReason.INTERLOCK: 10})
    waits = {StallReason.L2_LATENCY: 15, StallReason.INTERLOCK: 5}
    run = replace(
        run_of([frame(0, core_frame("A", 0, cost(REST, 1)))]),
        kernels=(
            kernel("Edge detection", "works", replace(line, issue_cclk=60, stall_cclk={})),
            kernel("Edge detection", "waits", line),
            kernel("Edge detection", "waits", replace(line, stall_cclk=waits), core="B"),
        ),
    )
    waiting, working = dearest_sources(run)
    assert (waiting.kernel, waiting.place, waiting.calls) == ("waits", "edges.py:10", 2)
    assert (waiting.cost.issue_cclk, waiting.cost.elapsed_cclk, waiting.share) == (60, 90, 0.6)
    assert waiting.cost.stall_cclk == {StallReason.INTERLOCK: 15, StallReason.L2_LATENCY: 15}
    assert [(each.line, each.executions, each.issue_share, each.share) for each in waiting.lines] == [
        (10, 0, 0.0, 0.0),
        (11, 10, 60 / 90, 1.0),
    ]  # fmt: skip
    assert dearest_sources(run, 1) == (waiting,)
    assert (working.share, working.cost.stalled_cclk) == (0.4, 0)


def test_a_kernel_that_was_never_called_is_told_as_inlined() -> None:
    """Its lines ran where the compiler has put them."""
    line = LineCost(line=11, executions=5, issue_cclk=30, stall_cclk={})
    run = replace(
        run_of([frame(0, core_frame("A", 0, cost(REST, 1)))]),
        kernels=(
            kernel("Edge detection", "called", line),
            kernel("Edge detection", "put_in", line, calls=0),
        ),
    )
    with Pictures() as pictures:
        page = page_of(run, pictures)
    assert "edges.py:10 · Edge detection · 1 call<" in page
    assert "edges.py:10 · Edge detection · inlined<" in page


def noise(width: int = 1980, height: int = 810) -> Image.Image:
    """The worst that can be asked of a codec."""
    return Image.fromarray(np.random.default_rng(1).integers(0, 255, (height, width, 3), np.uint8))


def test_a_picture_is_as_small_as_is_asked() -> None:
    """At its full size where there is room."""
    plain = Image.new("RGB", (1980, 810))
    with Image.open(BytesIO(Shrinker(100_000).webp_of(plain))) as image:
        assert image.size == (1980, 810)
    for nbytes in (60_000, 10_000):
        assert len(Shrinker(nbytes).webp_of(noise())) <= nbytes


def restless(record: FrameRecord) -> list[Span]:
    """What makes the largest charts: all of seven tracks changes in every slice, and half of these are just not too many."""
    begin, end = record.cores[0].begin_cclk, record.cores[0].end_cclk
    cuts = [begin + (end - begin) * number // SLICES for number in range(SLICES + 1)]
    spans = [
        Span(SpanKind.CALL, where, f"kernel_{number % 20}", *cuts[number : number + 2])
        for where in ("core A", "core B", "MDMA1", "MDMA2", "MDMA3", "MDMA4", "SPI")
        for number in range(SLICES)
    ]
    return [*spans, Span(SpanKind.FRAME, "core A", f"frame {record.index}", begin, end)]


@pytest.mark.exhaustive
def test_a_page_of_a_hundred_full_frames_has_at_most_8_mb(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every picture is as large as it may be, and no slice of time is like the one before."""
    monkeypatch.setattr("bfsim.report.html.pictures.overlay_of", lambda *_: noise(1, 1))
    monkeypatch.setattr(Shrinker, "webp_of", lambda shrinker, _image: bytes(shrinker._nbytes))
    with Pictures() as pictures, Gantts() as gantts:
        pictures.make_room(frames.MOST)
        run = edge_run(*range(1000, 1000 + frames.MOST))
        for each in run.frames:
            pictures.add_with_heat(seen_frame(each.index))
            gantts.add(restless(each))
        gantts.finish()
        pictures.finish()
        text = page_of(run, pictures, Target(1), gantts)
    assert 7_000_000 < len(text.encode()) < 8_000_000
    assert text.count("data:image/webp") == 2 * frames.MOST


def test_a_command_in_a_sentence_is_code() -> None:
    """Between backticks, as a terminal shows it; what is in it is words, and one that stands alone stays."""
    assert with_code("a; `bfsim run <b>` does, or `") == "a; <code>bfsim run &lt;b&gt;</code> does, or `"


def test_names_are_words_and_no_markup() -> None:
    """Whatever firmware, kernels, recordings and results are called: there are the page's three scripts, and all addresses are its own."""
    with Pictures() as pictures:
        pictures.add(seen_frame(0))
        plain = Elements(page_of(edge_run(1000), pictures))
        evil = Elements(page_of(evil_run(), pictures))
    assert evil.names.count("script") == plain.names.count("script") == 3
    assert evil.names.count("img") == 1
    assert evil.words.count(EVIL) >= 12
    assert all(each.startswith(("#", "data:")) for each in plain.addresses + evil.addresses)
