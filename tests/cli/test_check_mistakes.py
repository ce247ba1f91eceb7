"""What `bfsim check` refuses: almost all of it before anything runs."""

from __future__ import annotations

import re
import shutil
from contextlib import chdir
from pathlib import Path

import pytest

from bfsim.shipped import LDF_FOLDER
from tests.cli.check_rig import SLOWER, WHAT, call, refused
from tests.eyes import FIRMWARE, record

BOARDS = """
from dataclasses import replace
from bfsim.chip.boards import CM_BF561
mine = replace(CM_BF561, name="mine", sdram=replace(CM_BF561.sdram, nRP=3))
"""


@pytest.mark.usefixtures("idle_repository")
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*WHAT, "--frames", "2"], "--firmware fw_eyes.py', differs: frames is the default there and 2 here; --update adds"),
        ([*WHAT, "--ldf", "l2"], "ldf is the default there and 'l2' here"),
        ([*WHAT, "--ldf", "none.ldf", "--update"], "limits.toml: run 'drive --firmware fw_eyes.py --ldf none.ldf': LDF must be a file or a shipped one"),
        (["--case", "drove"], "--case must name one of its 2 runs, not 'drove'; the nearest are"),
        (["--case", "drive --firmware fw_eyes.py", "--frames", "2"], "says itself what to run: "),
        (["a\udcff.mcap", "--update"], "recording must have a name that can be written into a baseline file"),
        (["--junit", "limits.toml"], "limits.toml must be a file of its own to be written"),
        (["--json", "no/o.json"], "the folder no must exist"),
        (["--history", __file__], "test_check_mistakes.py:1 must be a line that `bfsim check --history` wrote"),
        (["--junit", "fw_eyes.py"], "fw_eyes.py must be a file of its own to be written"),
        (["--markdown", __file__], "test_check_mistakes.py must not be there yet: it holds something else than what is written there"),
        (["--benchmark", "drive.mcap"], "drive.mcap must be a file of its own to be written"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_told_before_anything_runs(arguments: list[str], message: str) -> None:
    """With the real difference."""
    assert message in refused("--baseline", "limits.toml", *arguments)


@pytest.mark.usefixtures("idle_repository")
@pytest.mark.parametrize(
    ("key", "text", "named", "advice"),
    [
        ("limits", "", "Threshold.A", "; --update --reason TEXT removes it"),
        ("require", "Threshold.max <= 9 ms", "Threshold", ""),
        ("require", "Binarize.C.max <= 9 ms", "Binarize.C", ""),
        ("require", "lateny <= 9 ms", "lateny", ""),
    ],
)
def test_a_stage_that_was_renamed_is_told_before_anything_runs(
    key: str, text: str, named: str, advice: str
) -> None:
    """The firmware says which stages and cores it has; what a person requires is told with --update, too, which leaves it alone."""
    Path("fw_eyes.py").write_text(FIRMWARE.replace('"Threshold"', '"Binarize"'))
    if text:
        limits = re.sub(
            r"^limits = \[\n(?:.*\n)*?\]\n", "", Path("limits.toml").read_text(), flags=re.MULTILINE
        )
        Path("limits.toml").write_text(limits.replace("[[run]]", f"[[run]]\nrequire = ['{text}']", 1))
    for update in [[], ["--update"]] if key == "require" else [[]]:
        message = refused("--baseline", "limits.toml", *update)
        assert f"{named} must be something that the run has; the nearest are " in message
        assert message.endswith(advice)


@pytest.mark.usefixtures("idle_repository")
def test_a_mistake_in_the_file_is_told_with_its_run() -> None:
    """What a run names and is not there is told as what the file says of it, which may have many runs."""
    text = Path("limits.toml").read_text()
    for key, other, message in (
        ("firmware", "fw_nose.py", "fw_nose.py must be a file, but there is none"),
        ("recording", "dive.mcap", "dive.mcap: recording must be a readable file"),
    ):
        edited = re.sub(rf'^{key} = "\w+\.\w+"', f'{key} = "{other}"', text, count=1, flags=re.MULTILINE)
        Path("limits.toml").write_text(edited)
        assert f"limits.toml: run 'drive --firmware fw_eyes.py': {message}" in refused(
            "--baseline", "limits.toml"
        )


def test_a_run_without_limits_is_refused_until_it_has_some(repository: Path) -> None:
    """One that somebody wrote down and nobody measured passed, whatever it cost: `all 0 limits kept`."""
    bare = '[[run]]\nname = "bare"\nrecording = "drive.mcap"\nfirmware = "fw_eyes.py"\n'
    (repository / "bare.toml").write_text(bare)
    assert refused("--baseline", "bare.toml") == (
        "bare.toml: run 'bare' must have limits or a require, but has neither; "
        "`bfsim check --baseline bare.toml --case bare --update` measures its limits"
    )
    (repository / "bare.toml").write_text(f'{bare}require = ["missed == 0"]\n')
    assert ": its limit kept, " in call("--baseline", "bare.toml").output
    (repository / "bare.toml").write_text(bare)
    assert call("--baseline", "bare.toml", "--case", "bare", "--update").exit_code == 0
    assert call("--baseline", "bare.toml").exit_code == 0


def test_an_ldf_lies_beside_the_file_and_is_none_of_the_current_folder(idle_repository: Path) -> None:
    """What a run names is sought from there alone, also where the current folder has a file of that name."""
    text = (idle_repository / "limits.toml").read_text()
    (idle_repository / "limits.toml").write_text(text.replace("[[run]]", '[[run]]\nldf = "mine.ldf"', 1))
    (idle_repository / "ci").mkdir()
    shutil.copy(LDF_FOLDER / "l2.ldf", "ci/mine.ldf")
    with chdir("ci"):
        message = refused("--baseline", "../limits.toml")
    assert "LDF must be a file or a shipped one" in message
    assert message.endswith("not '../mine.ldf'")


@pytest.mark.parametrize(
    ("frames", "message"),
    [
        (
            4,
            "recording drive.mcap must have 3 frames to run, as when the limits were measured, not 4 (the first 3 are",
        ),
        (
            2,
            "recording drive.mcap must have 3 frames to run, as when the limits were measured, not 2: so its limits",
        ),
    ],
)
def test_a_recording_of_another_length(idle_repository: Path, frames: int, message: str) -> None:
    """It is the frames that differ, and not the pictures."""
    record(idle_repository / "drive.mcap", frames)
    assert message in refused("--baseline", "limits.toml")


def test_another_recording_is_told_before_the_first_run(idle_repository: Path) -> None:
    """Of any run in the file, not when it comes to it."""
    record(idle_repository / "drive.mcap", 3, period_ns=50_000_000)
    assert "recording drive.mcap has other pictures or time stamps than" in refused(
        "--baseline", "limits.toml"
    )


def test_pictures_of_another_size_are_told_by_their_size(idle_repository: Path) -> None:
    """It is the size that differs, whatever else does; a file that does not have it yet names the pictures."""
    record(idle_repository / "drive.mcap", 2, width=64, height=32)
    limits = idle_repository / "limits.toml"
    told = refused("--baseline", "limits.toml")
    assert (
        "drive.mcap must have pictures of 32x16 px, as when the limits were measured, not of 64x32 px" in told
    )
    record(idle_repository / "drive.mcap", 3, width=64, height=32)
    limits.write_text(re.sub(r"(width|height)_px = \d+\n", "", limits.read_text()))
    assert "has other pictures or time stamps than" in refused("--baseline", "limits.toml")


def test_a_board_that_was_edited_is_refused_by_its_number(
    repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is the numbers that count, not the letters of its file; before anything runs."""
    what = (*WHAT, "--frames", "1", "--board", "boards.py:mine", "--baseline", "limits.toml")
    Path("boards.py").write_text(BOARDS)
    assert call(*what, "--update").exit_code == 0
    Path("boards.py").write_text(f"# an edit\n{BOARDS}")
    assert call(*what).exit_code == 0
    monkeypatch.setattr("bfsim.machine.board.Board.run", None)
    Path("boards.py").write_text(BOARDS.replace("nRP=3", "nRP=4"))
    assert (
        "board boards:mine had sdram.nRP = 3 when the limits were measured, and has sdram.nRP = 4"
        in refused(*what)
    )
    Path("boards.py").write_text(BOARDS.replace("nRP=3", "nRP=CM_BF561.sdram.nRP"))
    assert "and has that of cm-bf561" in refused(*what)


def test_code_of_another_gcc_is_refused(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The profile is the same; before anything runs. Another edit of the firmware is other code of the same GCC, and held."""
    what = (*WHAT, "--frames", "1", "--baseline", "limits.toml")
    assert call(*what, "--update").exit_code == 0
    Path("fw_eyes.py").write_text(SLOWER)
    assert call(*what).exit_code == 1
    text = Path("limits.toml").read_text()
    was = re.findall(r'\bcode = "(.+?)"', text)[-1]
    Path("limits.toml").write_text(text.replace(was, "GCC 3.0 -O2"))
    monkeypatch.setattr("bfsim.machine.board.Board.run", None)
    told = refused(*what)
    assert f"code was 'GCC 3.0 -O2' when the limits were measured, and is now {was!r}" in told
    assert "limits of --profile gcc-O2, an estimate, need neither" in told
