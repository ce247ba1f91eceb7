"""Why a run breaks its limits, by the baseline alone: the lines that grew, what was too small to be kept, what changed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from bfsim.report.check.as_json import check_json
from bfsim.report.check.baseline import Case
from bfsim.report.check.cause import difference_of_outcome, explanation
from bfsim.report.check.judge import judge
from bfsim.report.check.sentences import verdict_line
from bfsim.report.diff.sentences import verdict
from bfsim.trace import LineCost, OwnerCost, RunRecord
from tests.report.check_rig import (
    hold,
    measured,
    result,
    with_results,
)
from tests.report.records import core_frame, cost, edge_run, frame, kernel, run_of


def owned(edges: int, **lines: LineCost) -> RunRecord:
    """A run of one frame in which a kernel of `edges` cycles is all that core A does."""
    record = kernel("Edge detection", "gauss", *lines.values())
    owner = OwnerCost(
        stage="Edge detection", owner="gauss", symbol=record.symbol, calls=1, issue_cclk=edges, stall_cclk={}, idle_cclk=0
    )  # fmt: skip
    core = replace(core_frame("A", 0, cost("Edge detection", edges)), owners=(owner,))
    return replace(run_of([frame(0, core)]), kernels=(record,))


def test_a_failure_is_explained_by_the_baseline_alone(tmp_path: Path) -> None:
    """Stage, kernel, line and cause of what grew, read from the file; they sum to the difference."""

    def run(divisions: int) -> RunRecord:
        operations = {"alu": (100, 100), "division": (100 * divisions, 4700 * divisions)}
        line = LineCost(
            line=10, executions=100, issue_cclk=100 + 4700 * divisions, stall_cclk={}, operations=operations
        )
        return owned(line.issue_cclk, line=line)

    path = tmp_path / "bfsim.toml"
    measured(path, run(0))
    outcome = hold(run(2), path)
    found = difference_of_outcome(outcome)
    assert found is not None
    assert (found.cclk, sum(each.cclk for each in found.stages)) == (9400, 9400)
    assert any("library division: +2 x 100 x 47 cycles: +9,400" in each for each in explanation(outcome))
    assert verdict_line(outcome).startswith("FAILED: drive: 5 of 8 limits broken, ")
    (told,) = json.loads(check_json([outcome]))["runs"]
    assert sum(each["broken"] for each in told["verdicts"]) == 5
    assert difference_of_outcome(hold(run(0), path)).cclk == 0


def test_what_is_small_is_kept_together(tmp_path: Path) -> None:
    """Below a thousandth of the work an owner or a line has no entry; the sum is the same, and it is told when it grows."""

    def run(small: int) -> RunRecord:
        big = LineCost(line=10, executions=1, issue_cclk=100_000, stall_cclk={})
        return owned(
            100_000 + small, big=big, small=LineCost(line=11, executions=1, issue_cclk=small, stall_cclk={})
        )

    path = tmp_path / "bfsim.toml"
    case = measured(path, run(60))
    assert [len(each.lines) for each in case.costs.of] == [1]
    found = difference_of_outcome(hold(run(5060), path))
    assert found.cclk == 5000
    [gauss] = found.stages[0].parts
    assert [(each.name, each.cclk) for each in gauss.parts] == [
        ("total += row[x]", 5060),
        ("what is too small to be kept", -60),
    ]


def test_what_was_too_small_to_be_kept_is_no_reason(tmp_path: Path) -> None:
    """It has no name: the whole that it is in is told."""

    def run(big: int, small: int) -> RunRecord:
        lines = (
            LineCost(line=10, executions=1, issue_cclk=big, stall_cclk={}),
            LineCost(line=11, executions=1, issue_cclk=small, stall_cclk={}),
        )
        return owned(big + small, big=lines[0], small=lines[1])

    path = tmp_path / "bfsim.toml"
    measured(path, run(100_000, 90))
    told = " ".join(explanation(hold(run(100_050, 0), path)))
    assert "what is too small to be kept: -90" in told
    assert "in it line 10 +50" in told


def test_without_limits_measured_what_takes_most_is_told() -> None:
    """A person's sentence breaks: the stage that it is about, its kernels and lines."""
    line = LineCost(line=10, executions=50, issue_cclk=1000, stall_cclk={}, operations={"mul32": (50, 1000)})
    case = Case(name="drive", require=['"Edge detection".max <= 1 us'])
    told = list(explanation(judge(case, result(owned(1000, line=line)), Path("bfsim.toml"))))
    assert told[0] == "Edge detection takes 1.000 ms a frame, all cores together:"
    assert told[2].endswith("1.000 ms, 50 times x 20 cycles: multiplication of 32 bits 20")


def test_a_run_does_not_differ_from_its_baseline(tmp_path: Path) -> None:
    """Which has the time of a frame to six digits."""
    path = tmp_path / "bfsim.toml"
    run = edge_run(950, 1051, 1000)
    run = replace(run, identity=replace(run.identity, cclk_hz=7_000_003.0))
    measured(path, run)
    assert verdict(difference_of_outcome(hold(run, path))).startswith("No difference")


def test_frames_that_were_missed_make_no_run_cheaper(tmp_path: Path) -> None:
    """Slower firmware misses one of two frames: it is compared with half of what the two took, and that is said."""

    def run(count: int, edges: int) -> RunRecord:
        one = owned(edges, line=LineCost(line=10, executions=1, issue_cclk=edges, stall_cclk={}))
        kernels = [
            replace(
                each,
                issue_cclk=count * edges,
                lines=(LineCost(line=10, executions=count, issue_cclk=count * edges, stall_cclk={}),),
            )
            for each in one.kernels
        ]
        [core] = one.frames[0].cores
        ends = [(index + 1) * edges for index in range(count)]
        cores = [replace(core, begin_cclk=end - edges, end_cclk=end) for end in ends]
        frames = tuple(replace(one.frames[0], index=index, cores=(each,)) for index, each in enumerate(cores))
        published = [{"edges": edges}] * count
        return with_results(
            replace(one, frames=frames, kernels=tuple(kernels), missed=(1,) * (count == 1)), *published
        )

    path = tmp_path / "bfsim.toml"
    measured(path, run(2, 1000))
    outcome = hold(run(1, 1500), path)
    found = difference_of_outcome(outcome)
    assert (found.before_cclk, found.after_cclk, found.cclk) == (1000, 1500, 500)
    assert found.results == ()  # in total they would be other ones, and frame by frame they are judged
    assert any("The first side is of 2 frames, the second of 1" in each for each in explanation(outcome))
