"""What a run is told when it is held against a baseline file: limits, tolerances, and what a person requires."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from bfsim.report.check.baseline import Case
from bfsim.report.check.judge import judge
from bfsim.report.check.sentences import broken_lines
from bfsim.report.check.tables import changes
from bfsim.trace import REST, RunRecord, StallReason
from tests.report.check_rig import (
    broken,
    hold,
    measured,
    replace_in,
    result,
    with_memory,
    with_results,
)
from tests.report.records import IDENTITY, core_frame, cost, edge_run, frame, run_of


def required(run: RunRecord, *sentences: str) -> list[str]:
    """Which of a person's sentences a run breaks."""
    outcome = judge(Case(name="drive", require=list(sentences)), result(run), Path("bfsim.toml"))
    return [each.requirement.text for each in outcome.broken]


def test_same_run_passes(baseline: Path) -> None:
    """Equal numbers break nothing and beat nothing, the frame rate included."""
    outcome = hold(edge_run(950, 1050), baseline)
    assert outcome.passed
    assert outcome.better == ()
    assert len(outcome.verdicts) == 1 + 1 + 2 + 2 + 4  # rate, missed; latency, frame and a stage on two cores


def test_one_cycle_more_breaks_every_limit_it_touches(baseline: Path) -> None:
    """With no tolerance, one cycle in the longest frame shows in the maxima of stage and frame, and in the rate."""
    assert broken(hold(edge_run(950, 1051), baseline)) == [
        "frame_rate",
        "frame.max",
        '"Edge detection".A.max',
    ]


@pytest.mark.parametrize("waits", [{}, {StallReason.SEMAPHORE: 400}])
def test_faster_is_never_a_failure(tmp_path: Path, waits: dict[StallReason, int]) -> None:
    """Core A is 400 cycles faster and waits for core B instead, idle or at a semaphore: reported, and passed."""

    def run(a_cclk: int, waits: dict[StallReason, int], idle_cclk: int) -> RunRecord:
        rest = cost(REST, 0, waits, idle_cclk)
        return run_of([
            frame(0, core_frame("A", 0, cost("Edge", a_cclk), rest), core_frame("B", 0, cost("Edge", 1000)))
        ])  # fmt: skip

    path = tmp_path / "bfsim.toml"
    measured(path, run(1000, {}, 0))
    outcome = hold(run(600, waits, 0 if waits else 400), path)
    assert outcome.passed
    assert {each.requirement.name for each in outcome.better} == {("Edge", "A")}


def test_tolerance_is_exact_at_its_edge(baseline: Path) -> None:
    """Ten percent over 1050 allow 1155 and not 1156."""
    replace_in(baseline, 'name = "drive"', 'name = "drive"\ntolerance_percent = 10')
    assert hold(edge_run(950, 1155, rest_cclk=0), baseline).passed
    assert broken(hold(edge_run(950, 1156), baseline)) == [
        "frame.max",
        '"Edge detection".A.max',
        '"Edge detection".B.max',
    ]


def test_a_short_stage_may_grow_by_what_is_not_seen_in_a_frame(tmp_path: Path) -> None:
    """Of 10,000 cycles a frame 1 % of a tenth are 10: a stage of 20 cycles may take 30, and not 31."""

    def run(short: int) -> RunRecord:
        return run_of([frame(0, core_frame("A", 0, cost("Long", 10_000 - short), cost("Short", short)))])

    path = tmp_path / "bfsim.toml"
    measured(path, run(20), tolerance_percent=1)
    assert hold(run(30), path).passed
    assert broken(hold(run(31), path)) == ["Short.A.median", "Short.A.max"]


def test_missed_frames(baseline: Path) -> None:
    """None were missed when the limits were measured."""
    assert "missed" in broken(hold(replace(edge_run(950, 1050), missed=(2,)), baseline))


@pytest.mark.parametrize(
    ("sentence", "holds"),
    [
        ("frame_rate >= 909.0 Hz", True),  # the second frame takes 1100 cycles at 1 MHz
        ("frame_rate >= 910 Hz", False),
        ("frame <= 1050 us", True),
        ("frame <= 1.049 ms", False),
        ("frame.min <= 950 cycles", True),
        ("frame.median <= 0.000949 s", False),
        ('"Edge detection" <= 1050 cycles', True),
        ('"Edge detection".B.max <= 524 cycles', False),
        ("latency == 10 cycles", True),
        ("latency.max >= 11 cycles", False),
        ("missed == 0", True),
        ("memory.L2 <= 64 KB", True),
        ("memory.L2 <= 65535 B", False),
        ("memory.L2 <= 50 %", True),
        ("memory.L2 <= 49.9 %", False),
        ("results.balls >= 1", True),
        ("results.balls >= 2", False),  # in each frame
        ("results.balls <= 2", False),
        ("results.balls.total == 4", True),
        ("results.balls == 1 3", True),
        ("results.balls == 3 1", False),
        ("results.balls == 1", False),
    ],
)
def test_what_a_person_requires(sentence: str, holds: bool) -> None:
    """Without a statistic a sentence is about every frame."""
    run = with_memory(with_results(edge_run(950, 1050), {"balls": 1}, {"balls": 3}), 65_536)
    assert required(run, sentence) == ([] if holds else [sentence])


def test_a_fraction_of_a_count_is_told_as_one(tmp_path: Path) -> None:
    """`missed == 0.5` was told as `must be == 0, not 0`."""
    path = tmp_path / "bfsim.toml"
    measured(path, edge_run(950, 1050))
    replace_in(path, 'name = "drive"', 'name = "drive"\nrequire = ["missed == 0.5"]')
    assert list(broken_lines(hold(edge_run(950, 1050), path))) == ["missed must be == 0.5, not 0 (-100.00 %)"]


@pytest.mark.parametrize(
    ("sentence", "holds"),
    [
        ("results.drift >= -4", True),
        ("results.drift >= -3", False),
        ("results.drift.max <= -1", True),
        ("results.drift == -4 -1", True),
        ("results.drift.total == -5", True),
    ],
)
def test_a_person_may_require_negative_numbers(sentence: str, holds: bool) -> None:
    """Of what is published."""
    run = with_results(edge_run(950, 1050), {"drift": -4}, {"drift": -1})
    assert required(run, sentence) == ([] if holds else [sentence])


def test_what_changed_beside_the_limits(baseline: Path) -> None:
    """Firmware that was edited and never loaded is told to be the same."""
    run = edge_run(950, 1050)
    assert list(changes(hold(run, baseline))) == [
        "Firmware tinyphoon (built in) is the same as when the limits were measured."
    ]
    other = replace(run, identity=replace(IDENTITY, firmware_digest="f", ldf_digest="f", bfsim_version="9.9"))
    told = "\n".join(changes(hold(other, baseline)))
    assert "Firmware tinyphoon (built in) has changed since the limits were measured." in told
    assert "The LDF thesis has changed since then." in told
    assert "measured by bfsim 0.1.0 with LLVM 20.1.8, this run by bfsim 9.9" in told
