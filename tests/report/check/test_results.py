"""A run that is as fast and sees less: published numbers and objects are held against the baseline frame by frame."""

from __future__ import annotations

import json
from pathlib import Path

from bfsim.report.check.as_json import check_json
from bfsim.report.check.baseline_file import read_baseline
from bfsim.report.check.cause import explanation
from bfsim.report.check.markdown import markdown
from bfsim.report.check.sentences import broken_lines
from bfsim.report.results.result import Result, result_of
from tests.report.check_rig import (
    broken,
    hold,
    measured,
    replace_in,
    result,
    seen_object,
    with_results,
)
from tests.report.records import edge_run


def test_a_lost_ball_is_a_failure_however_fast(tmp_path: Path) -> None:
    """Results are exact, and the frame is named; within a tolerance they may differ either way."""
    path = tmp_path / "bfsim.toml"
    measured(path, with_results(edge_run(950, 1050), {"edges": 100, "balls": 1}, {"edges": 100, "balls": 1}))
    lost = with_results(edge_run(500, 500), {"edges": 103, "balls": 1}, {"edges": 97, "balls": 0})
    assert broken(hold(lost, path)) == ["results.edges", "results.balls"]
    assert "results.balls is another in frame 1" in list(explanation(hold(lost, path)))
    replace_in(path, 'name = "drive"', 'name = "drive"\nresults_tolerance_percent = 3')
    assert broken(hold(lost, path)) == ["results.balls"]


def test_a_lost_ball_is_a_failure_that_says_so(tmp_path: Path) -> None:
    """Objects are counted by kind in each frame: what is seen no longer, or was not before, breaks its limit."""
    path = tmp_path / "bfsim.toml"
    case = measured(path, result(edge_run(950, 1050), ["ball", "goal"], ["ball"]))
    assert [each for each in case.limits if "objects" in each] == [
        "objects.ball == 1*2",
        "objects.goal == 1 0",
    ]
    lost = hold(result(edge_run(500, 500), ["goal"], ["robot"]), path)
    assert broken(lost) == ["objects.ball", "distance_mm.ball", "objects.robot.max"]
    told = list(explanation(lost))
    assert "ball: seen before, not any more, in 2 frames, first in 0" in told
    assert "robot: seen now, not before, in 1 frame, first in 1" in told
    assert hold(result(edge_run(950, 1050), ["goal", "ball"], ["ball"]), path).passed
    replace_in(
        path, 'name = "drive"', 'name = "drive"\nrequire = ["objects.robot == 0", "objects.ball >= 1"]'
    )
    assert [each.requirement.text for each in hold(result(edge_run(500, 500), [], []), path).broken] == [
        "objects.ball >= 1",
        "objects.ball == 1*2",
        "distance_mm.ball == 300*2",
        "objects.goal == 1 0",
        "distance_mm.goal == 300 0",
    ]


def test_an_object_may_have_the_name_of_a_statistic(tmp_path: Path) -> None:
    """`objects.min == 1*2` was read as the least of no object at all, and `--update` refused what it had written."""
    path = tmp_path / "bfsim.toml"
    case = measured(path, result(edge_run(950, 1050), ["min", "max"], ["min"]))
    assert [each for each in case.limits if "objects" in each] == ["objects.min == 1*2", "objects.max == 1 0"]
    assert broken(hold(result(edge_run(950, 1050), ["min"], ["min"]), path)) == [
        "objects.max",
        "distance_mm.max",
    ]
    replace_in(path, 'name = "drive"', 'name = "drive"\nrequire = ["objects.min.min >= 1"]')
    assert hold(result(edge_run(950, 1050), ["min", "max"], ["min"]), path).passed


def test_a_result_is_told_of_the_frame_that_is_most_off(tmp_path: Path) -> None:
    """Not as totals, which may be the same; beside a limit of nothing stands no percentage."""
    path = tmp_path / "bfsim.toml"
    measured(path, with_results(edge_run(950, 1050), {"edges": 100, "balls": 0}, {"edges": 100, "balls": 0}))
    other = with_results(edge_run(950, 1050), {"edges": 97, "balls": 0}, {"edges": 103, "balls": 1})
    outcome = hold(other, path)
    assert list(broken_lines(outcome)) == [
        "results.edges in frame 0 must be == 100, not 97 (-3.00 %)",
        "results.balls in frame 1 must be == 0, not 1",
    ]
    assert json.loads(check_json([outcome]))["runs"][0]["verdicts"][-2]["frame"] == 0


def test_a_failure_names_no_command_that_keeps_it(tmp_path: Path) -> None:
    """The command makes all of what was measured the limits: firmware that is fast because it is blind keeps nothing."""
    path = tmp_path / "bfsim.toml"
    measured(path, with_results(edge_run(950, 1050), {"balls": 1}, {"balls": 1}))
    blind, fast = (with_results(edge_run(500, 500), {"balls": balls}, {"balls": balls}) for balls in (0, 1))
    assert hold(blind, path).better
    assert "--update" not in markdown([hold(blind, path)], path)
    assert "--update" in markdown([hold(fast, path)], path)


def test_a_ball_whose_place_is_lost_is_lost(tmp_path: Path) -> None:
    """Its direction alone, or a memory of it, is another thing; how far it is may differ within the tolerance of results."""

    def run(*balls: dict[str, object]) -> Result:
        frames = edge_run(*[500] * len(balls))
        return result_of(frames, {index: {"objects": [each]} for index, each in enumerate(balls)})

    path = tmp_path / "bfsim.toml"
    case = measured(path, run(seen_object("ball", 500), seen_object("ball", 400)))
    assert "distance_mm.ball == 500 400" in case.limits
    lost = hold(run(seen_object("ball", 0), seen_object("ball", 400) | {"age_frames": 2}), path)
    assert broken(lost)[:2] == ["objects.ball", "distance_mm.ball"]
    told = list(explanation(lost))
    assert "ball: seen before, not any more, in 2 frames, first in 0" in told
    assert "ball (direction only): seen now, not before, in 1 frame, first in 0" in told
    replace_in(path, 'name = "drive"', 'name = "drive"\nresults_tolerance_percent = 2')
    assert hold(run(seen_object("ball", 510), seen_object("ball", 392)), path).passed
    assert broken(hold(run(seen_object("ball", 511), seen_object("ball", 400)), path)) == ["distance_mm.ball"]


def test_results_that_change_often_are_kept_as_totals(tmp_path: Path) -> None:
    """A line of 21 numbers is not for people; one that says 200 times the same is."""
    path = tmp_path / "bfsim.toml"
    run = edge_run(*[100] * 30)
    counts = [{"edges": index, "balls": int(index < 20)} for index in range(30)]
    case = measured(path, with_results(run, *counts))
    assert [each for each in case.limits if "results" in each] == [
        "results.edges.min == 0",
        "results.edges.max == 29",
        "results.edges.total == 435",
        "results.balls == 1*20 0*10",
    ]
    counts[1] = {"edges": 0, "balls": 0}
    assert broken(hold(with_results(run, *counts), path)) == ["results.edges.total", "results.balls"]


def test_a_tolerance_of_both_sides_is_not_told_as_the_upper_one(tmp_path: Path) -> None:
    """29 with 10 % was told as `== 32`, of what was measured below it, too."""
    path = tmp_path / "bfsim.toml"
    run = edge_run(*[100] * 30)
    counts = [{"edges": index} for index in range(30)]
    measured(path, with_results(run, *counts), results_tolerance_percent=10)
    halved = [{"edges": each["edges"] // 2} for each in counts]
    told = list(broken_lines(hold(with_results(run, *halved), path)))
    assert told[-2:] == ["results.edges.max must be == 29, not 14 (-51.72 %)", "(1 other)"]


def test_what_is_published_may_be_negative(tmp_path: Path) -> None:
    """A tolerance is of the size of the number, whatever its sign."""
    path = tmp_path / "bfsim.toml"
    run = edge_run(950, 1050)
    measured(path, with_results(run, {"drift": -100}, {"drift": 100}), results_tolerance_percent=10)
    assert read_baseline(path).run[0].limits[-1] == "results.drift == -100 100"
    assert hold(with_results(run, {"drift": -90}, {"drift": 110}), path).passed
    outcome = hold(with_results(run, {"drift": -111}, {"drift": 100}), path)
    assert list(broken_lines(outcome)) == ["results.drift in frame 0 must be == -100, not -111 (-11.00 %)"]
