"""`bfsim check` from the terminal: the whole walk in one small repository."""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import subprocess
import sys
from contextlib import chdir
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from click.testing import CliRunner, Result

from bfsim.cli.main import main
from bfsim.errors import BfsimError, ConfigError
from bfsim.report.check.history import append_history
from bfsim.shipped import LDF_FOLDER
from tests.eyes import FIRMWARE, record

SLOWER = FIRMWARE.replace(
    "        out[x] = 0\n",
    "        out[x] = 0\n        if x * 7919 // (line[x] + 1) == 123456:\n            found += 1\n",
)
BLIND = FIRMWARE.replace("line[x] > 100", "line[x] > 200")
WHAT = ("drive.mcap", "--firmware", "fw_eyes.py")


def call(*arguments: object) -> Result:
    """Call the command line in this process; unexpected exceptions come through."""
    return CliRunner().invoke(
        main, ["check", *map(str, arguments)], catch_exceptions=False, prog_name="bfsim"
    )


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with firmware, a recording, and limits for two runs of it."""
    folder = tmp_path_factory.mktemp("measured")
    (folder / "fw_eyes.py").write_text(FIRMWARE)
    record(folder / "drive.mcap", 3)
    with chdir(folder):
        for more in ([], ["--frames", "1", "--set", "sdram.nRP=3"]):
            assert call(*WHAT, *more, "--baseline", "limits.toml", "--update").exit_code == 0
    return folder


@pytest.fixture
def repository(measured: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same, to be changed; the current folder."""
    shutil.copytree(measured, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    return tmp_path


@pytest.fixture
def idle_repository(repository: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same, where nothing may run any more."""
    monkeypatch.setattr("bfsim.machine.board.Board.run", None)
    return repository


def test_all_runs_of_a_file_pass_from_any_folder(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Paths in the file are relative to it; without further words all runs in it are checked."""
    (repository / "ci").mkdir()
    monkeypatch.chdir(repository / "ci")
    result = call("--baseline", "../limits.toml")
    assert result.exit_code == 0, result.output
    for name in ("drive --firmware fw_eyes.py", "drive --firmware fw_eyes.py --set sdram.nRP=3 --frames 1"):
        assert f"Passed: {name}: all " in result.output
    assert "2 of 2 runs passed, 0 FAILED." in result.output
    assert " ".join(result.output.split()).count("is the same as when the limits were measured") == 2


def test_slower_firmware_fails_with_the_line_that_grew_and_why(repository: Path) -> None:
    """Exit code 1, and stage, kernel, line and cause in the terminal and in all forms; `bfsim diff` says the same."""
    Path("fw_eyes.py").write_text(SLOWER)
    forms = {"json": "o.json", "junit": "o.xml", "markdown": "o.md", "benchmark": "b.json"}
    options = [word for name, file in forms.items() for word in (f"--{name}", file)]
    result = call(*WHAT, "--baseline", "limits.toml", *options)
    assert result.exit_code == 1, result.output
    reason = "in it threshold (fw_eyes.py:"
    cause = ": library division "
    for words in (reason, cause, "if x * 7919 // (line[x] + 1) == 123456:"):
        assert words in " ".join(result.output.split())
    assert "is another than when the limits were measured" in " ".join(result.output.split())
    told = json.loads(Path("o.json").read_text())
    assert told["passed"] is False
    broken = [each["requirement"] for each in told["runs"][0]["verdicts"] if each["broken"]]
    assert any(each.startswith("Threshold.A.median <= ") for each in broken)
    assert not any(each.startswith("results.") for each in broken)
    failure = ET.parse("o.xml").getroot().find("testsuite/testcase/failure")
    assert failure is not None
    assert reason in (failure.text or "")
    assert cause in (failure.text or "")
    assert "| Threshold.A" in Path("o.md").read_text()
    assert cause in Path("o.md").read_text()
    assert sum(each["cclk"] for each in told["runs"][0]["difference"]["stages"]) > 0
    name = "limits.toml:drive --firmware fw_eyes.py"
    diff = CliRunner().invoke(main, ["diff", name, "drive.mcap --firmware fw_eyes.py", "--json"])
    assert json.loads(diff.output) == told["runs"][0]["difference"]
    benchmark = json.loads(Path("b.json").read_text())
    assert {"name", "unit", "value"} == set(benchmark[0])
    assert {each["unit"] for each in benchmark} == {"ms", "B"}


def test_faster_firmware_passes_and_update_tightens(repository: Path) -> None:
    """The command that is printed does it; the firmware as it was then fails, and loosening asks for a reason."""
    Path("fw_eyes.py").write_text(SLOWER)
    assert call("--baseline", "limits.toml", "--update", "--reason", "for a test").exit_code == 0
    assert "for a test: " in Path("limits.toml").read_text()
    Path("fw_eyes.py").write_text(FIRMWARE)
    result = call("--baseline", "limits.toml")
    assert result.exit_code == 0
    command = "bfsim check --baseline limits.toml --case 'drive --firmware fw_eyes.py' --update"
    assert command in result.output
    assert call("--baseline", "limits.toml", "--update").exit_code == 0
    Path("fw_eyes.py").write_text(SLOWER)
    before = Path("limits.toml").read_text()
    assert call("--baseline", "limits.toml").exit_code == 1
    told = refused("--baseline", "limits.toml", "--update")
    assert "--update must come with --reason TEXT where limits loosen:\n  run 'drive" in told
    runs = told.split("\n  run 'drive")[1:]
    assert [each.count("latency.m") for each in runs] == [1, 1], "a line a run, and a limit a figure"
    assert Path("limits.toml").read_text() == before


def test_what_it_saw_is_a_limit(repository: Path) -> None:
    """Firmware that finds less is told in which frames, with the numbers of the one that is most off; there is nothing to keep."""
    Path("fw_eyes.py").write_text(BLIND)
    result = call(*WHAT, "--baseline", "limits.toml")
    assert result.exit_code == 1
    assert "results.bright_A, results.bright_B are others in frames 0, 1, 2" in result.output
    assert re.search(r"results.bright_A in frame \d +== \d+ +\d+ +-\d+", result.output)
    assert "To keep it" not in result.output


def refused(*arguments: object) -> str:
    """What is said of a mistake, in this process."""
    with pytest.raises(BfsimError) as caught:
        CliRunner().invoke(
            main, ["check", *map(str, arguments)], catch_exceptions=False, standalone_mode=False
        )
    return str(caught.value)


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
        (["--history", __file__], "test_check.py:1 must be a line that `bfsim check --history` wrote"),
        (["--junit", "fw_eyes.py"], "fw_eyes.py must be a file of its own to be written"),
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


def test_a_file_is_the_same_by_any_way_to_it(repository: Path) -> None:
    """By its whole path in the baseline, and by a relative one here."""
    limits = repository / "limits.toml"
    limits.write_text(limits.read_text().replace('"drive.mcap"', f'"{repository}/drive.mcap"'))
    (repository / "ci").mkdir()
    with chdir("ci"):
        result = call("../drive.mcap", "--firmware", "../fw_eyes.py", "--baseline", "../limits.toml")
    assert result.exit_code == 0, result.output


@pytest.mark.parametrize(
    ("frames", "message"),
    [
        (
            4,
            "recording drive.mcap must have 3 frames to run, as when the limits were measured, not 4 (the first 3 are",
        ),
        (
            2,
            "recording drive.mcap must have 3 frames to run, as when the limits were measured, not 2: limits of",
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


def test_history_has_a_line_a_run_and_draws_the_trend(repository: Path) -> None:
    """Slower and then as before; an editor may have put its mark before the lines, and left out the end of the last one."""
    for text in (FIRMWARE, SLOWER, FIRMWARE):
        Path("fw_eyes.py").write_text(text)
        result = call(*WHAT, "--baseline", "limits.toml", "--history", "history.jsonl")
        written = Path("history.jsonl").read_text(encoding="utf-8-sig")
        Path("history.jsonl").write_text(written.removesuffix("\n"), encoding="utf-8-sig")
    lines = [json.loads(line) for line in written.splitlines()]
    assert [each["passed"] for each in lines] == [True, False, True]
    assert lines[0]["configuration"] == {"recording": "drive.mcap", "firmware": "fw_eyes.py"}
    assert lines[0]["figures"] == lines[2]["figures"] != lines[1]["figures"]
    assert "▁█▁" in result.output


@pytest.mark.usefixtures("idle_repository")
@pytest.mark.parametrize("median", ['"3.99"', "NaN", "-Infinity", "1e999", "null", "9" * 400])
def test_a_history_whose_figures_cannot_be_drawn_is_told_before_anything_runs(median: str) -> None:
    """A median that is no number, or none that has a place in a trend."""
    Path("odd.jsonl").write_text(f'\n{{"run": "drive", "figures": {{"frame.median ms": {median}}}}}\n')
    message = refused("--baseline", "limits.toml", "--history", "odd.jsonl")
    assert "odd.jsonl:2 must be a line that `bfsim check --history` wrote" in message


def test_a_history_that_has_no_room_is_named_and_stays_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As every other file that cannot be written: half a line would be one that the next check cannot read."""
    path = tmp_path / "history.jsonl"
    path.write_text("{}\n")
    monkeypatch.setattr("bfsim.report.check.history._lines", lambda *_: "a line" * 1000)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(ConfigError, match=r"history\.jsonl must be writable: File too large"):
            append_history(path, [], "")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert path.read_text() == "{}\n"


def test_a_baseline_that_is_only_read_may_lie_where_nothing_can_be_written(
    repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in a container that mounts the repository to be read; --update must write."""
    access = os.access
    monkeypatch.setattr("os.access", lambda path, *mode: Path(path) != repository and access(path, *mode))
    assert call("--baseline", "limits.toml", "--case", "drive --firmware fw_eyes.py").exit_code == 0
    assert "limits.toml: the folder . must be writable" in refused("--baseline", "limits.toml", "--update")


def test_a_person_requires_more(repository: Path) -> None:
    """A sentence that does not hold breaks, and --update does not touch it."""
    text = Path("limits.toml").read_text()
    sentence = 'require = ["frame_rate >= 1000000 Hz"]'
    Path("limits.toml").write_text(text.replace("frames = 1", f"frames = 1\n{sentence}", 1))
    result = call("--baseline", "limits.toml", "--update")
    assert result.exit_code == 1
    assert ">= 1000000.00 Hz" in result.output
    assert sentence in Path("limits.toml").read_text()


BOARDS = """
from dataclasses import replace
from bfsim.chip.boards import CM_BF561
mine = replace(CM_BF561, name="mine", sdram=replace(CM_BF561.sdram, nRP=3))
"""


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
    assert f"code was 'GCC 3.0 -O2' when the limits were measured, and is {was!r}" in told
    assert "limits of --profile gcc-O2, an estimate, need none" in told


def test_who_stops_reading_gets_the_files_all_the_same(repository: Path) -> None:
    """`bfsim check ... | head -1`: outputs and history are written before anything is printed."""
    command = f"{sys.executable} -m bfsim check --case 'drive --firmware fw_eyes.py' --baseline limits.toml --json o.json | true"
    done = subprocess.run(
        ["bash", "-c", f"{command}; exit ${{PIPESTATUS[0]}}"], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (141, "")
    assert json.loads(Path("o.json").read_text())["passed"]
