"""What a run is told when it is held against a baseline file."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from threading import Event, Thread
from time import sleep

import pytest

from bfsim.errors import ConfigError
from bfsim.report.check.baseline import Case, read_baseline
from bfsim.report.check.cause import difference_of_outcome, explanation
from bfsim.report.check.judge import judge
from bfsim.report.check.kept import kept_side
from bfsim.report.check.outputs import broken_lines, check_json, markdown
from bfsim.report.check.tables import changes, verdict_line
from bfsim.report.check.update import loosened, write_cases
from bfsim.report.diff.sentences import verdict
from bfsim.report.result_file import Result, result_of
from bfsim.report.save import write_text
from bfsim.trace import REST, LineCost, OwnerCost, RunRecord, StallReason
from tests.report.check_rig import (
    broken,
    hold,
    measured,
    replace_in,
    result,
    seen_object,
    with_memory,
    with_results,
)
from tests.report.records import IDENTITY, core_frame, cost, edge_run, frame, kernel, run_of


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A baseline of frames with 950 and 1050 cycles of edge detection on core A, half of it on core B, and no tolerance."""
    path = tmp_path / "bfsim.toml"
    measured(path, edge_run(950, 1050))
    return path


def required(run: RunRecord, *sentences: str) -> list[str]:
    """Which of a person's sentences a run breaks."""
    outcome = judge(Case(name="drive", require=list(sentences)), result(run), Path("bfsim.toml"))
    return [each.requirement.text for each in outcome.broken]


def test_same_run_passes(path: Path) -> None:
    """Equal numbers break nothing and beat nothing, the frame rate included."""
    outcome = hold(edge_run(950, 1050), path)
    assert outcome.passed
    assert outcome.better == ()
    assert len(outcome.verdicts) == 1 + 1 + 2 + 2 + 4  # rate, missed; latency, frame and a stage on two cores


def test_one_cycle_more_breaks_every_limit_it_touches(path: Path) -> None:
    """With no tolerance, one cycle in the longest frame shows in the maxima of stage and frame, and in the rate."""
    assert broken(hold(edge_run(950, 1051), path)) == ["frame_rate", "frame.max", '"Edge detection".A.max']


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


def test_tolerance_is_exact_at_its_edge(path: Path) -> None:
    """Ten percent over 1050 allow 1155 and not 1156."""
    replace_in(path, 'name = "drive"', 'name = "drive"\ntolerance_percent = 10')
    assert hold(edge_run(950, 1155, rest_cclk=0), path).passed
    assert broken(hold(edge_run(950, 1156), path)) == [
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


def test_missed_frames(path: Path) -> None:
    """None were missed when the limits were measured."""
    assert "missed" in broken(hold(replace(edge_run(950, 1050), missed=(2,)), path))


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
    assert told[-1] == "results.edges.max must be == 29, not 14 (-51.72 %)"


def test_a_fraction_of_a_count_is_told_as_one(tmp_path: Path) -> None:
    """`missed == 0.5` was told as `must be == 0, not 0`."""
    path = tmp_path / "bfsim.toml"
    measured(path, edge_run(950, 1050))
    replace_in(path, 'name = "drive"', 'name = "drive"\nrequire = ["missed == 0.5"]')
    assert list(broken_lines(hold(edge_run(950, 1050), path))) == ["missed must be == 0.5, not 0 (-100.00 %)"]


def test_what_is_published_may_be_negative(tmp_path: Path) -> None:
    """A tolerance is of the size of the number, whatever its sign."""
    path = tmp_path / "bfsim.toml"
    run = edge_run(950, 1050)
    measured(path, with_results(run, {"drift": -100}, {"drift": 100}), results_tolerance_percent=10)
    assert read_baseline(path).run[0].limits[-1] == "results.drift == -100 100"
    assert hold(with_results(run, {"drift": -90}, {"drift": 110}), path).passed
    outcome = hold(with_results(run, {"drift": -111}, {"drift": 100}), path)
    assert list(broken_lines(outcome)) == ["results.drift in frame 0 must be == -100, not -111 (-11.00 %)"]


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
    assert told[0] == "Edge detection takes 1.000 ms a frame, both cores together:"
    assert told[2].endswith("1.000 ms, 50 times x 20 cycles: multiplication of 32 bits 20")


def test_what_changed_beside_the_limits(path: Path) -> None:
    """Firmware that was edited and never loaded is told to be the same."""
    run = edge_run(950, 1050)
    assert list(changes(hold(run, path))) == [
        "Firmware tinyphoon (built in) is the same as when the limits were measured."
    ]
    other = replace(run, identity=replace(IDENTITY, firmware_digest="f", ldf_digest="f", bfsim_version="9.9"))
    told = "\n".join(changes(hold(other, path)))
    assert "Firmware tinyphoon (built in) is another than when the limits were measured." in told
    assert "The LDF thesis is another than then." in told
    assert "measured by bfsim 0.1.0 with LLVM 20.1.8, this run by bfsim 9.9" in told


def test_update_keeps_what_a_person_wrote(path: Path) -> None:
    """Comments, tolerances, requirements and their order stay."""
    replace_in(path, 'name = "drive"', '# the long one\nname = "drive"\nrequire = ["missed == 0"]  # always')
    measured(path, edge_run(800, 900))
    text = path.read_text()
    assert '# the long one\nname = "drive"\nrequire = ["missed == 0"]  # always' in text
    assert '"Edge detection".A.max <= 0.900000 ms' in text


def test_update_with_the_same_run_changes_no_letter(path: Path) -> None:
    """A diff shows what moved."""
    before = path.read_text()
    measured(path, edge_run(950, 1050))
    assert path.read_text() == before


def test_update_leaves_limits_that_are_kept_within_their_tolerance(tmp_path: Path) -> None:
    """No creeping upwards, percent by percent; what became better tightens its limit."""
    path = tmp_path / "bfsim.toml"
    measured(path, edge_run(1000, 1000), tolerance_percent=5)
    assert loosened(read_baseline(path).run[0], result(edge_run(1040, 1040)), path) == []
    assert '"Edge detection".A.max <= 1.000000 ms' in measured(path, edge_run(1040, 1040)).limits
    assert '"Edge detection".A.max <= 0.900000 ms' in measured(path, edge_run(900, 900)).limits


def test_update_says_what_loosens_and_keeps_the_reason(path: Path) -> None:
    """One sentence a reason, with the limits that went."""
    case = read_baseline(path).run[0]
    assert '"Edge detection".A.max <= 1.050000 ms, measured 1.060000 ms' in loosened(
        case, result(edge_run(950, 1060)), path
    )
    assert (
        measured(path, edge_run(950, 1060), reason="a second ball")
        .loosened[0]
        .startswith("a second ball: frame_rate >= ")
    )


def test_update_for_another_recording_begins_anew(path: Path) -> None:
    """Limits of one say nothing about the other: nothing loosens."""
    other = replace(edge_run(2000), identity=replace(IDENTITY, recording_digest="f" * 64))
    assert loosened(read_baseline(path).run[0], result(other), path) == []
    assert "frame.max <= 2.000000 ms" in measured(path, other).limits


def test_update_for_code_of_another_gcc_begins_anew(tmp_path: Path) -> None:
    """As for another recording; the diff of a failure would name it. A baseline that does not know its code is held as it was."""
    path = tmp_path / "bfsim.toml"

    def by(code: str) -> RunRecord:
        return replace(edge_run(2000 if code else 1000), identity=replace(IDENTITY, code=code))

    old = measured(path, by("GCC 12.2.0 -O2"))
    assert old.measured_on is not None
    assert old.measured_on.code == "GCC 12.2.0 -O2"
    assert loosened(old, result(edge_run(3000)), path)
    assert loosened(old, result(replace(by("GCC 14.1.0 -O2"), frames=edge_run(3000).frames)), path) == []
    assert kept_side(old).configuration["code"] == "GCC 12.2.0 -O2"


def test_a_stage_that_is_gone(path: Path) -> None:
    """A check refuses to guess; --update removes its limits, and asks for a reason: nothing holds what was one."""
    run = run_of(
        [
            frame(0, core_frame("A", 0, cost("Thinning", 900))),
            frame(1, core_frame("A", 900, cost("Thinning", 1))),
        ]
    )
    with pytest.raises(
        ConfigError,
        match=r'"Edge detection"\.A must be something that the run has; the nearest are .*--update',
    ):
        hold(run, path)
    old = read_baseline(path).run[0]
    gone = '"Edge detection".A.max <= 1.050000 ms, which the run has no more'
    assert gone in loosened(old, result(run), path)
    new = measured(path, run, reason="it is called Thinning now")
    assert gone in new.loosened[0]
    assert not any("Edge" in each for each in new.limits)


def test_a_run_does_not_differ_from_its_baseline(tmp_path: Path) -> None:
    """Which has the time of a frame to six digits."""
    path = tmp_path / "bfsim.toml"
    run = edge_run(950, 1051, 1000)
    run = replace(run, identity=replace(run.identity, cclk_hz=7_000_003.0))
    measured(path, run)
    assert verdict(difference_of_outcome(hold(run, path))).startswith("No difference")


def test_two_updates_at_once_are_both_in_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second one waits for the first to be done, and then reads the file."""
    path, is_slow = tmp_path / "bfsim.toml", Event()

    def slow_text(place: Path, text: str) -> None:
        is_slow.set()
        sleep(0.2)
        write_text(place, text)

    monkeypatch.setattr("bfsim.report.check.update.write_text", slow_text)
    first = Thread(target=write_cases, args=(path, {"one": Case(name="one")}))
    first.start()
    is_slow.wait()
    write_cases(path, {"two": Case(name="two")})
    first.join()
    assert [case.name for case in read_baseline(path).run] == ["one", "two"]


def test_update_leaves_a_file_alone_that_is_no_baseline(tmp_path: Path) -> None:
    """A slip of the finger (--baseline pyproject.toml) overwrites nothing."""
    path = tmp_path / "pyproject.toml"
    path.write_text('[project]\nname = "robot"\n')
    with pytest.raises(ConfigError, match=r"pyproject\.toml: project must not be there"):
        write_cases(path, {"drive": Case(name="drive")})
    assert path.read_text() == '[project]\nname = "robot"\n'
    assert list(tmp_path.iterdir()) == [path]


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
