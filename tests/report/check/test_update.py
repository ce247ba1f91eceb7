"""`bfsim check --update`: what it writes, what it leaves, and what it says of limits that loosen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from threading import Event, Thread
from time import sleep

import pytest

from bfsim.errors import ConfigError
from bfsim.files.save import write_text
from bfsim.report.check.baseline import Case
from bfsim.report.check.baseline_file import read_baseline
from bfsim.report.check.judge import judge
from bfsim.report.check.kept import kept_side
from bfsim.report.check.sentences import changes
from bfsim.report.check.update import loosened, write_cases
from bfsim.report.diff.compare import difference_between
from bfsim.report.diff.result_side import result_side
from bfsim.trace import RunRecord
from tests.report.check_rig import (
    hold,
    measured,
    replace_in,
    result,
)
from tests.report.records import IDENTITY, core_frame, cost, edge_run, frame, run_of


def test_update_keeps_what_a_person_wrote(baseline: Path) -> None:
    """Comments, tolerances, requirements and their order stay."""
    replace_in(
        baseline, 'name = "drive"', '# the long one\nname = "drive"\nrequire = ["missed == 0"]  # always'
    )
    measured(baseline, edge_run(800, 900))
    text = baseline.read_text()
    assert '# the long one\nname = "drive"\nrequire = ["missed == 0"]  # always' in text
    assert '"Edge detection".A.max <= 0.900000 ms' in text


def test_update_with_the_same_run_changes_no_letter(baseline: Path) -> None:
    """A diff shows what moved."""
    before = baseline.read_text()
    measured(baseline, edge_run(950, 1050))
    assert baseline.read_text() == before


def test_update_leaves_limits_that_are_kept_within_their_tolerance(tmp_path: Path) -> None:
    """No creeping upwards, percent by percent; what became better tightens its limit."""
    path = tmp_path / "bfsim.toml"
    measured(path, edge_run(1000, 1000), tolerance_percent=5)
    assert loosened(read_baseline(path).run[0], result(edge_run(1040, 1040)), path) == []
    assert '"Edge detection".A.max <= 1.000000 ms' in measured(path, edge_run(1040, 1040)).limits
    assert '"Edge detection".A.max <= 0.900000 ms' in measured(path, edge_run(900, 900)).limits


def test_update_says_what_loosens_and_keeps_the_reason(baseline: Path) -> None:
    """One sentence a reason, with the limits that went."""
    case = read_baseline(baseline).run[0]
    assert '"Edge detection".A.max <= 1.050000 ms, measured 1.060000 ms' in loosened(
        case, result(edge_run(950, 1060)), baseline
    )
    in_short = loosened(case, result(edge_run(950, 1060)), baseline, in_short=True)
    assert sum('Edge detection".A' in each for each in in_short) == 1, "its maximum, or its median"
    assert (
        measured(baseline, edge_run(950, 1060), reason="a second ball")
        .loosened[0]
        .startswith("a second ball: frame_rate >= ")
    )


def test_update_for_another_recording_begins_anew(baseline: Path) -> None:
    """Limits of one say nothing about the other: nothing loosens."""
    other = replace(edge_run(2000), identity=replace(IDENTITY, recording_digest="f" * 64))
    assert loosened(read_baseline(baseline).run[0], result(other), baseline) == []
    assert "frame.max <= 2.000000 ms" in measured(baseline, other).limits


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


def test_the_name_of_a_recording_is_kept_for_a_comparison(tmp_path: Path) -> None:
    """Pictures of runs of other lengths have other digests: `bfsim diff` said of two recordings that nothing but `frames` differs."""
    kept = kept_side(measured(tmp_path / "bfsim.toml", edge_run(1000, 1000), recording="drives/night.mcap"))
    now = result_side(result(edge_run(1000)), {0})
    assert ("recording", "night.mcap", IDENTITY.recording) in [
        (each.what, each.before, each.after) for each in difference_between(kept, now).configuration
    ]


def test_limits_that_say_no_more_what_they_are_of(baseline: Path) -> None:
    """Somebody removed `measured_on`: all limits were kept, and it was said that none had been measured."""
    case = read_baseline(baseline).run[0].model_copy(update={"measured_on": None})
    (told,) = changes(judge(case, result(edge_run(1000)), baseline))
    assert told.startswith("The file no longer says what the limits were measured on")
    (told,) = changes(judge(case.model_copy(update={"limits": []}), result(edge_run(1000)), baseline))
    assert told == "No limits were measured yet: --update does that."


def test_a_stage_that_is_gone(baseline: Path) -> None:
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
        hold(run, baseline)
    old = read_baseline(baseline).run[0]
    gone = '"Edge detection".A.max <= 1.050000 ms, which the run has no more'
    assert gone in loosened(old, result(run), baseline)
    new = measured(baseline, run, reason="it is called Thinning now")
    assert gone in new.loosened[0]
    assert not any("Edge" in each for each in new.limits)


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
