"""`bfsim check` from the terminal: the whole walk in one small repository."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from contextlib import chdir
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from click.testing import CliRunner

from bfsim.cli.main import main
from bfsim.errors import ConfigError
from tests.cli.check_rig import SLOWER, WHAT, call, refused
from tests.eyes import FIRMWARE

BLIND = FIRMWARE.replace("line[x] > 100", "line[x] > 200")


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
    assert "has changed since the limits were measured" in " ".join(result.output.split())
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
    updated = call("--baseline", "limits.toml", "--update", "--reason", "for a test")
    assert updated.exit_code == 0
    assert "limits kept" in updated.output
    assert "when the limits were measured" not in " ".join(updated.output.split())
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


def test_a_file_is_the_same_by_any_way_to_it(repository: Path) -> None:
    """By its whole path in the baseline, and by a relative one here."""
    limits = repository / "limits.toml"
    limits.write_text(limits.read_text().replace('"drive.mcap"', f'"{repository}/drive.mcap"'))
    (repository / "ci").mkdir()
    with chdir("ci"):
        result = call("../drive.mcap", "--firmware", "../fw_eyes.py", "--baseline", "../limits.toml")
    assert result.exit_code == 0, result.output


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


@pytest.mark.parametrize("option", ["--junit", "--json", "--history"])
def test_the_verdict_is_told_although_a_file_cannot_be_written(
    repository: Path, monkeypatch: pytest.MonkeyPatch, option: str
) -> None:
    """A disk may fill up while it runs."""

    def full(path: Path, content: object) -> None:
        raise ConfigError(f"{path} must be writable: No space left on device")

    monkeypatch.setattr("bfsim.files.save.write_bytes", full)
    monkeypatch.setattr("bfsim.report.check.history.write_bytes", full, raising=False)
    (repository / "fw_eyes.py").write_text(SLOWER)
    result = call("--baseline", "limits.toml", option, "out.json")
    assert result.exit_code == 2
    assert result.stdout.startswith("FAILED: ")
    assert result.stderr == "bfsim: error: out.json must be writable: No space left on device\n"


def test_who_stops_reading_gets_the_files_all_the_same(repository: Path) -> None:
    """`bfsim check ... | head -1`: outputs and history are written before anything is printed."""
    command = f"{sys.executable} -m bfsim check --case 'drive --firmware fw_eyes.py' --baseline limits.toml --json o.json | true"
    done = subprocess.run(
        ["bash", "-c", f"{command}; exit ${{PIPESTATUS[0]}}"], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (141, "")
    assert json.loads(Path("o.json").read_text())["passed"]
