"""Baseline files and what a run is told when it is held against one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from bfsim.errors import ConfigError
from bfsim.report.baseline import read_baseline, write_baseline
from bfsim.report.budget import budget_of
from bfsim.report.check import Check, Verdict, check
from bfsim.trace import REST, BudgetRow, RunRecord
from tests.report.records import IDENTITY, edge_run


@pytest.fixture
def baseline(tmp_path: Path) -> Path:
    """A baseline of frames of 1000 and 1100 cycles (edge detection 950 and 1050 on core A)."""
    path = tmp_path / "bfsim.toml"
    write(path, edge_run(950, 1050))
    return path


def write(path: Path, run: RunRecord) -> None:
    """Make the numbers of a run the limits."""
    write_baseline(path, run, budget_of(run))


def hold(run: RunRecord, path: Path) -> Check:
    """Hold a run against a baseline file."""
    return check(run, budget_of(run), read_baseline(path), path)


def broken(outcome: Check) -> list[tuple[str, str, str]]:
    """Where and what the broken limits are."""
    return [(each.core, each.row, each.quantity) for each in outcome.verdicts if each.broken]


def replace_in(path: Path, old: str, new: str) -> None:
    """Edit a file as its owner would; what is to be replaced must be there."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def test_same_run_passes(baseline: Path) -> None:
    """Equal numbers break nothing and beat nothing, the frame rate included."""
    outcome = hold(edge_run(950, 1050), baseline)
    assert outcome.passed
    assert not any(verdict.better for verdict in outcome.verdicts)
    assert outcome.notes == ()


def test_one_cycle_more_breaks_every_limit_it_touches(baseline: Path) -> None:
    """With no tolerance, one cycle in the longest frame shows in the maxima of stage and frame, and in the rate."""
    assert broken(hold(edge_run(950, 1051), baseline)) == [
        ("", "", "frames/s"),
        ("A", "Edge detection", "max"),
        ("A", "Frame", "max"),
        ("B", REST, "max"),
        ("B", "Frame", "max"),
    ]


def test_less_is_better_and_passes(baseline: Path) -> None:
    """An improvement passes and is told."""
    outcome = hold(edge_run(949, 1050), baseline)
    assert outcome.passed
    better = [(each.core, each.row, each.quantity) for each in outcome.verdicts if each.better]
    assert better[0] == ("A", "Edge detection", "median")


def test_tolerance_is_exact_at_its_edge(baseline: Path) -> None:
    """Ten percent over 1050 allow 1155 and not 1156; the verdict says what was allowed."""
    replace_in(baseline, "tolerance_percent = 0", "tolerance_percent = 10")
    assert hold(edge_run(950, 1155), baseline).passed
    outcome = hold(edge_run(950, 1156), baseline)
    verdict = next(each for each in outcome.verdicts if each.broken)
    assert verdict == Verdict(
        core="A", row="Edge detection", quantity=verdict.quantity, baseline=1050, limit=1155, measured=1156
    )


def test_decimal_tolerance_is_taken_as_written(baseline: Path) -> None:
    """0.1 % over 1000 allow 1001, although 1000 · 1.001 is a little less than that in binary."""
    write(baseline, edge_run(1000, 1000))
    replace_in(baseline, "tolerance_percent = 0", "tolerance_percent = 0.1")
    assert ("A", "Edge detection", "max") not in broken(hold(edge_run(1000, 1001), baseline))


def test_row_may_have_a_tolerance_of_its_own(baseline: Path) -> None:
    """The tolerance of a row counts for it alone."""
    replace_in(baseline, "max_cclk = 1_050", "max_cclk = 1_050\ntolerance_percent = 5")
    assert ("A", "Edge detection", "max") not in broken(hold(edge_run(950, 1100), baseline))
    assert ("A", "Frame", "max") in broken(hold(edge_run(950, 1100), baseline))


def test_missed_frame_breaks_the_limit_on_missed_frames(baseline: Path) -> None:
    """Two frames done and one missed are held against three done."""
    write(baseline, edge_run(950, 950, 950))
    outcome = hold(replace(edge_run(950, 950), missed=(2,)), baseline)
    assert broken(outcome) == [("", "", "missed frames")]


def test_update_keeps_comments_and_tolerances(baseline: Path) -> None:
    """What the owner wrote stays; only numbers move."""
    replace_in(baseline, "tolerance_percent = 0", "tolerance_percent = 2.5  # the robot can live with that")
    replace_in(baseline, "[core.B.", "# core B idles anyway\n[core.B.")
    replace_in(baseline, "max_cclk = 1_050", "max_cclk = 1_050  # goal in sight\ntolerance_percent = 7")
    write(baseline, edge_run(800, 2000))
    text = baseline.read_text()
    assert "tolerance_percent = 2.5  # the robot can live with that" in text
    assert "# core B idles anyway\n[core.B." in text
    assert "max_cclk = 2_000  # goal in sight\ntolerance_percent = 7" in text
    assert read_baseline(baseline).core["A"]["Edge detection"].median_cclk == 800


def test_update_removes_rows_that_are_gone(baseline: Path) -> None:
    """A stage that the firmware no longer has loses its limits; before that, a check refuses to guess."""
    run = replace(edge_run(950, 1050), rows=(BudgetRow(stage="Edge detection", reference_ms=87.0),))
    with pytest.raises(ConfigError, match=r'core\.A\."Open & closing" must be a row of the run, .*--update'):
        hold(run, baseline)
    write(baseline, run)
    assert list(read_baseline(baseline).core["B"]) == ["Edge detection", REST, "Frame"]


def test_new_row_passes_with_a_note(baseline: Path) -> None:
    """A stage without a limit is named; its cost still shows in the frame."""
    run = edge_run(950, 1050)
    outcome = hold(
        replace(run, rows=(*run.rows, BudgetRow(stage="Blob detection", reference_ms=68.0))), baseline
    )
    assert outcome.passed
    assert outcome.notes == (
        "Rows without a limit: Blob detection on core A, Blob detection on core B; --update gives them one.",
    )


def test_other_recording_is_refused(baseline: Path) -> None:
    """Limits of one recording say nothing about another; both are named."""
    run = replace(
        edge_run(950, 1050), identity=replace(IDENTITY, recording="hall", recording_digest="f" * 64)
    )
    with pytest.raises(
        ConfigError, match=r": recording must be soccer \(sha256 1{64}\), not hall \(sha256 f{64}\)"
    ):
        hold(run, baseline)


def test_renamed_recording_is_the_same(baseline: Path) -> None:
    """The digest decides, not the name."""
    run = replace(edge_run(950, 1050), identity=replace(IDENTITY, recording="renamed"))
    assert hold(run, baseline).passed


@pytest.mark.parametrize("key", ["firmware", "board", "ldf", "compiler", "feed", "fidelity"])
def test_other_set_up_is_refused(baseline: Path, key: str) -> None:
    """Apples are not compared with pears: the message names the key and both values."""
    change: dict[str, Any] = {key: "other"}
    run = replace(edge_run(950, 1050), identity=replace(IDENTITY, **change))
    with pytest.raises(
        ConfigError, match=rf"bfsim\.toml: {key} must be {getattr(IDENTITY, key)}, not other: the limits"
    ):
        hold(run, baseline)


def test_other_number_of_frames_is_refused(baseline: Path) -> None:
    """A maximum over two frames is no limit for three."""
    with pytest.raises(ConfigError, match="toml: frames must be 2, not 3: the limits"):
        hold(edge_run(950, 1050, 950), baseline)


def test_other_version_is_noted(baseline: Path) -> None:
    """Another bfsim may count differently; the check says so and goes on."""
    outcome = hold(replace(edge_run(950, 1050), identity=replace(IDENTITY, bfsim_version="9.9")), baseline)
    assert outcome.passed
    assert "measured by bfsim 0.1.0 with LLVM 20.1.8, this run by bfsim 9.9" in outcome.notes[0]


def test_missing_file_is_told_how_to_make_one(tmp_path: Path) -> None:
    """The first check of a new repository."""
    with pytest.raises(
        ConfigError, match=r"none\.toml must be a baseline file, but there is none: .* --update"
    ):
        read_baseline(tmp_path / "none.toml")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "tolerance_percent = 0",
            "tolerance_percent = -1",
            "tolerance_percent must be greater than or equal to 0, not -1",
        ),
        (
            "tolerance_percent = 0",
            "tolerance_percent = nan",
            "tolerance_percent must be a finite number, not nan",
        ),
        ("board = ", "plank = ", r"the key measured_on\.board must be there; --update writes it"),
        (
            "max_cclk = 1_050",
            "max_cclk = '1050'",
            r"core\.A\.Edge detection\.max_cclk must be a valid integer, not '1050'",
        ),
        ("max_cclk = 1_050", "max_ms = 2", r"core\.A\.Edge detection\.max_cclk must be there"),
        ("\n[run]", "\n[run]\nfps = 4", r"run\.fps must not be there: a baseline has no such key"),
        ("\n[run]", "\n[run", r"must be TOML: .* at line \d+"),
    ],
)
def test_faulty_file_names_key_and_cure(baseline: Path, old: str, new: str, message: str) -> None:
    """Every mistake in the file is told with the file, the key and what must be there."""
    replace_in(baseline, old, new)
    with pytest.raises(ConfigError, match=rf"bfsim\.toml:? .*{message}"):
        read_baseline(baseline)


def test_update_leaves_a_file_alone_that_is_no_baseline(tmp_path: Path) -> None:
    """A slip of the finger (--baseline pyproject.toml) overwrites nothing."""
    path = tmp_path / "pyproject.toml"
    path.write_text('[project]\nname = "robot"\n')
    with pytest.raises(ConfigError, match=r"pyproject\.toml: "):
        write(path, edge_run(950))
    assert path.read_text() == '[project]\nname = "robot"\n'
    assert list(tmp_path.iterdir()) == [path]
