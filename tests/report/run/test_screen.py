"""What `bfsim run` says on one screen, and that it fits."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given, settings
from rich.console import Console, RenderableType

from bfsim.report.budget.bound import Cause, bound_of
from bfsim.report.budget.budget import budget_of
from bfsim.report.budget.start_up import start_up_cclk, without_start_up
from bfsim.report.budget.waits import busy_cclk
from bfsim.report.profile.tables import profile_report
from bfsim.report.run.full import run_report
from bfsim.report.run.screen import screen
from bfsim.shipped import ACCURACY
from bfsim.trace import REST, CoreFrame, RunRecord, RunWarning, StallReason, WarningKind
from tests.pages import ROOT
from tests.report.printed import printed
from tests.report.records import core_frame, cost, edge_run, frame, run_of, runs


def lines_of(run: RunRecord, width: int = 80) -> list[str]:
    """The screen as a pipe gets it."""
    return printed(screen(run), width)


def words_of(run: RunRecord) -> str:
    """The screen in one line, so that tests do not depend on where it is broken."""
    return " ".join(" ".join(lines_of(run)).split())


def run_with(*frames: tuple[CoreFrame, ...]) -> RunRecord:
    """A run of these frames."""
    return run_of([frame(index, *cores) for index, cores in enumerate(frames)])


def waiting_run(idle_cclk: int, frames: int = 3) -> RunRecord:
    """Frames of 10 ms of edge detection that begin with a wait, one core."""
    made, begin = [], 0
    for _ in range(frames):
        core = core_frame("A", begin, cost("Edge detection", 10_000), cost(REST, 0, idle_cclk=idle_cclk))
        made.append((core,))
        begin = core.end_cclk
    return run_with(*made)


def test_the_first_line_is_the_verdict() -> None:
    """99.95 of 100 ms on core A; core B has half of it and waits for the rest."""
    run = edge_run(99_950, 99_950)
    assert lines_of(run)[0] == "10.00 frames/s, 100.00 ms a frame: bound by core A's Edge detection (100 %)."


def test_the_core_that_waits_least_bounds_the_rate() -> None:
    """Not the one with the longest stage: what it waits for in that stage, the other does."""
    turns = {StallReason.SEMAPHORE: 90}
    a = core_frame("A", 0, cost("Edge detection", 10, turns))
    b = core_frame("B", 0, cost("Edge detection", 40), cost("Open & closing", 60))
    bound = bound_of(budget_of(run_with((a, b))))
    assert (bound.core.core, bound.cause, bound.row and bound.row.name, bound.cclk) == (
        "B",
        Cause.STAGE,
        "Open & closing",
        60,
    )


def test_pictures_bound_a_firmware_that_waits_for_them() -> None:
    """From the tick on at which a frame is more wait than work."""
    assert "bound by core A's Edge detection" in words_of(waiting_run(9_999))
    assert "bound by the pictures, core A waits for them (50 %)" in words_of(waiting_run(10_001))


def test_firmware_that_works_longer_than_it_waits_is_told_that_it_waits() -> None:
    """Else who makes that stage faster wonders why the frame rate stays; of firmware that never waits nothing is said."""
    told = "bound by core A's Edge detection (67 %), and it waits for each picture (33 %)."
    assert told in words_of(waiting_run(5_000))
    assert "(100 %)." in words_of(waiting_run(0))
    assert "waits for each" not in words_of(waiting_run(5_000, frames=1))


def test_cores_that_take_turns_bound_each_other() -> None:
    """Each waits for the other longer than it works."""
    turns = {StallReason.SEMAPHORE: 60}
    cores = tuple(core_frame(name, 0, cost("Edge detection", 40), cost(REST, 0, turns)) for name in "AB")
    assert "bound by the cores' turns, core A waits for its own (60 %)" in words_of(run_with(cores))


def test_work_outside_of_stages_is_called_so() -> None:
    """And not by the name of its row."""
    assert "bound by core A's work outside of stages (100 %)" in words_of(
        run_with((core_frame("A", 0, cost(REST, 9)),))
    )


def test_one_table_has_both_cores() -> None:
    """Median and stall of each, reference, share and bar of the core that bounds."""
    stalls = {StallReason.RING_EMPTY: 25_000}
    a = core_frame("A", 0, cost("Edge detection", 75_000, stalls))
    b = core_frame("B", 0, cost("Edge detection", 50_000), cost(REST, 0, idle_cclk=50_000))
    rows = [" ".join(line.split()) for line in lines_of(run_with((a, b)))]
    assert "Stage A ms stall% B ms stall% board % of A █ work ▓ stall ░ idle" in rows
    assert f"Edge detection 100.00 25.0 50.00 0.0 87 100.0 {'█' * 15}{'▓' * 5}" in rows
    assert "Open & closing" not in " ".join(rows)  # it took no time
    assert f"Frame 100.00 25.0 100.00 0.0 113 100.0 {'█' * 15}{'▓' * 5}" in rows


def test_only_firmware_with_a_reference_has_its_column() -> None:
    """Its name comes from the firmware."""
    run = edge_run(100)
    plain = replace(run, reference=None, rows=tuple(replace(each, reference_ms=None) for each in run.rows))
    assert "board means of 100 frames on a board." in words_of(run)
    assert "board means" not in words_of(plain)
    assert " board " not in lines_of(plain)[2]


def test_the_start_up_is_told_apart() -> None:
    """Frame 0 waited 16 ms for its picture, the others 1 ms: 15 ms of it are no cost of a frame."""
    run = waiting_run(1_000)
    first = core_frame("A", 0, cost("Edge detection", 10_000), cost(REST, 0, idle_cclk=16_000))
    late = replace(run, frames=(frame(0, first), *run.frames[1:]))
    assert start_up_cclk(late) == 15_000
    settled = without_start_up(late).frames[0].cores[0]
    assert (settled.begin_cclk, settled.end_cclk) == (15_000, 26_000)
    assert "median 11.00, max 11.00 ms (a p95 needs 20 frames). Frame 0 took 15.00 ms more" in words_of(late)
    assert start_up_cclk(run) == 0
    assert "Frame 0 took" not in words_of(run)


def test_of_a_single_frame_the_start_up_is_unknown() -> None:
    """It stays in, and the reader is told."""
    run = waiting_run(16_000, frames=1)
    assert start_up_cclk(run) == 0
    assert (
        "1 done, 0 missed; 26.00 ms. All numbers include the 16.00 ms until the first picture came"
        in words_of(run)
    )


@settings(max_examples=30, deadline=None)
@given(runs())
def test_without_its_start_up_a_run_keeps_its_promises(run: RunRecord) -> None:
    """Stages fill the frame, ends stay, nothing grows, and the parts of the bound are within a frame."""
    settled = without_start_up(run)
    assert settled.frames[1:] == run.frames[1:]
    for before, after in zip(run.frames[0].cores, settled.frames[0].cores, strict=True):
        assert after.end_cclk == before.end_cclk
        assert sum(each.elapsed_cclk for each in after.stages) == after.end_cclk - after.begin_cclk
        assert after.begin_cclk >= before.begin_cclk
    budget = budget_of(settled)
    bound = bound_of(budget)
    assert 0 <= bound.cclk <= bound.core.frame.elapsed_cclk.total
    assert busy_cclk([bound.core.frame]) == max(busy_cclk([each.frame]) for each in budget.cores)


def test_the_latency_is_explained() -> None:
    """The second picture was there for 40 ms when the first frame was done."""
    cores = [core_frame("A", begin, cost("Edge detection", 50_000)) for begin in (0, 50_000, 100_000)]
    run = run_of([frame(index, core, latency_cclk=90_000) for index, core in enumerate(cores)])
    assert (
        "Latency median 90.00, max 90.00 ms from last line in to result out; 40.00 of the median are the wait for the frame before."
        in words_of(run)
    )


def test_a_p95_takes_twenty_frames() -> None:
    """Of nineteen the reader learns why there is none."""
    without, told = (words_of(edge_run(*range(100, 100 + frames))) for frames in (19, 20))
    assert "a p95 needs 20 frames" in without
    assert "median 0.16, p95 0.17, max 0.17 ms." in told
    assert "a p95 needs" not in told


def test_what_must_not_be_overlooked_stands_below_the_table() -> None:
    """Assumed geometry, missed frames, losses, and that it was interrupted."""
    run = edge_run(100, 100)
    frames = (
        run.frames[0],
        replace(run.frames[1], results={"edges_lost_A": 5}, remarks=("an order was refused",)),
    )
    assumed = RunWarning(kind=WarningKind.GEOMETRY, text="there was none")
    words = words_of(replace(run, frames=frames, missed=(2,), assumptions=(assumed,), interrupted=True))
    for text in (
        "Warning geometry: there was none",
        "Warning missed frames: 1 of 3 frames",
        "Warning lost: edges without room: 5 on core A",
        "2 done, 1 (2) missed",
        "Interrupted: these are the frames done until then.",
        "frame 1: an order was refused",
    ):
        assert text in words
    assert "Warning" not in words_of(run)


def test_it_says_where_the_cameras_are() -> None:
    """Of firmware that asks for it."""
    run = edge_run(100, 100)
    assert "Cameras focal length 9 px (of the recording)" in words_of(
        replace(run, geometry="focal length 9 px (of the recording)")
    )
    assert "Cameras" not in words_of(replace(run, geometry=""))


@pytest.mark.parametrize("report", [screen, run_report, profile_report])
def test_it_says_where_its_errors_are_told(report: Callable[[RunRecord], RenderableType]) -> None:
    """In a line of its own that fits a terminal: the page that comes with bfsim."""
    [line] = [each for each in printed(report(edge_run(1000, 900)), 80) if each.startswith("Trust ")]
    named = [word.strip(":") for word in line.split() if word.endswith(".md:")]
    assert [(ROOT / each).resolve() for each in named] == [ACCURACY]


def test_where_to_look_next_depends_on_the_stalls() -> None:
    """With a tenth of the frame stalled, at the placement too."""
    core = core_frame("A", 0, cost("Edge detection", 90, {StallReason.L2_LATENCY: 10}))
    more = core_frame("A", 0, cost("Edge detection", 89, {StallReason.L2_LATENCY: 11}))
    assert "bfsim ldf" not in words_of(run_with((core,)))
    assert "bfsim ldf where the buffers lie" in words_of(run_with((more,)))
    assert "bfsim run --full" in words_of(run_with((core,)))


@pytest.mark.parametrize("width", [20, 33, 60, 79, 80])
def test_it_fits_however_narrow(width: int) -> None:
    """No line is wider than the terminal, numbers stand whole, and there are no escape codes in a pipe."""
    lines = lines_of(edge_run(99_950, 99_950), width)
    assert max(map(len, lines)) <= width
    assert not any("\x1b" in line for line in lines)
    assert any("99.95" in line.split() for line in lines)


def test_colours_are_for_terminals() -> None:
    """The same text, with escape codes."""
    console = Console(file=io.StringIO(), width=80, force_terminal=True, color_system="standard")
    console.print(screen(edge_run(100, 100)))
    assert isinstance(console.file, io.StringIO)
    assert "\x1b[36m" in console.file.getvalue()
