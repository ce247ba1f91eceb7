"""What a target is, and what is left over of it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from bfsim.errors import ConfigError
from bfsim.report.budget.target import Target, kept_frames, slacks_of, target_of, target_words, used_cclk
from bfsim.trace import StallReason
from tests.report.records import core_frame, cost, edge_run, frame, run_of


@pytest.mark.parametrize(
    ("text", "frame_ms"),
    [("15Hz", 1000 / 15), ("15 hz", 1000 / 15), ("66ms", 66), ("66.5 MS", 66.5), (" 0.5Hz ", 2000)],
)
def test_a_rate_and_a_time_are_targets(text: str, frame_ms: float) -> None:
    """In whatever case."""
    assert target_of(text).frame_ms == pytest.approx(frame_ms)


@pytest.mark.parametrize(
    "text", ["", "15", "Hz", "0Hz", "0.0ms", "-3ms", "nanms", "1e3Hz", "15 fps", "9" * 400 + "Hz", "१५Hz"]
)
def test_anything_else_is_refused(text: str) -> None:
    """And said what it must be."""
    with pytest.raises(
        ConfigError, match="must be a frame rate such as 15Hz or a frame time such as 66ms, not "
    ):
        target_of(text)


def test_what_counts_is_all_but_idling() -> None:
    """Waiting for the other core counts: the frame is not done before."""
    core = core_frame("A", 0, cost("Edge detection", 30, {StallReason.SEMAPHORE: 12}, idle_cclk=1000))
    assert used_cclk(core) == 42


def test_a_frame_keeps_a_target_up_to_its_last_cycle() -> None:
    """100 ms are 100,000 cycles; core B uses half of what core A does."""
    run = edge_run(100_000, 100_001, 99_000)
    assert kept_frames(run, Target(100)) == 2
    a, b = slacks_of(run, Target(100))
    assert (a.core, a.used_ms, a.most_ms, a.worst_frame, a.kept) == ("A", 100.0, 100.001, 1, 2)
    assert (b.core, b.used_ms, b.kept) == ("B", 50.0, 3)
    assert [each.kept for each in slacks_of(run, None)] == [3, 3]


def test_a_frame_keeps_a_target_only_if_both_cores_do() -> None:
    """Each core is late in another frame."""
    late, early = cost("Edge detection", 20), cost("Edge detection", 5)
    frames = [
        frame(index, core_frame("A", 0, a), core_frame("B", 0, b))
        for index, (a, b) in enumerate([(late, early), (early, late), (early, early)])
    ]
    run = run_of(frames)
    run = replace(run, identity=replace(run.identity, cclk_hz=1000.0))
    assert [each.kept for each in slacks_of(run, Target(10))] == [2, 2]
    assert kept_frames(run, Target(10)) == 1


def test_the_words_of_a_kept_target_say_what_is_left() -> None:
    """Up to the last cycle; in the frame that used most."""
    run = edge_run(80_000, 90_000)
    assert target_words(run, Target(90)) == (
        "11.1111 Hz, 90.00 ms a frame: kept by 2 of 2 frames; the worst, frame 1, has 0.00 ms left."
    )


def test_the_words_of_a_broken_target_say_what_must_be_saved_and_where() -> None:
    """On the core that works: the other one waits for it; parts of a stage count to it, and idling is nothing to save."""
    waits = cost("Edge detection", 10_000, {StallReason.SEMAPHORE: 50_000})
    works = (
        cost("Edge detection", 40_000),
        cost("Open & closing", 15_000, {StallReason.SEMAPHORE: 2_000}, 900),
    )
    run = run_of([frame(3, core_frame("A", 0, waits), core_frame("B", 0, *works))])
    assert target_words(run, Target(50)) == (
        "20 Hz, 50.00 ms a frame: kept by 0 of 1 frame; the worst, frame 3, must save 10.00 ms. Most of it, on core B: "
        "Edge detection 40.00, Open & closing 15.00, waits for the other core 2.00."
    )
