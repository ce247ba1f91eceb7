"""`--trace` and `--flame` from end to end: files that are there as a whole or not at all, and a report that is the same."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cli.test_main import call
from tests.report.perfetto_files import tracks_of
from tests.tiers import exhaustive

A_FRAME_BYTES = 150_000  # and some more
FILES = ("run.pftrace", "run.speedscope.json")


def options(folder: Path) -> tuple[str, ...]:
    """Return the options for both files in a folder."""
    return "--trace", str(folder / FILES[0]), "--flame", str(folder / FILES[1])


def names_in(folder: Path) -> list[str]:
    """Return what is in a folder."""
    return sorted(each.name for each in folder.iterdir())


@pytest.mark.parametrize("command", ["run", *exhaustive("profile")])
def test_both_files_are_written_and_the_report_is_the_same(command: str, tmp_path: Path) -> None:
    """Looking changes no cycle."""
    plain = call(command, "--frames", "1")
    told = call(command, "--frames", "1", *options(tmp_path))
    assert (plain.exit_code, told.exit_code) == (0, 0)
    assert told.stdout == plain.stdout
    assert names_in(tmp_path) == sorted(FILES)
    tracks = tracks_of((tmp_path / FILES[0]).read_bytes())
    assert [each.name for each in tracks["core A", "frames"].slices] == ["frame 0"]
    flame = json.loads((tmp_path / FILES[1]).read_text())
    assert [each["name"] for each in flame["profiles"]] == ["core A, cycles", "core B, cycles"]


@pytest.mark.exhaustive
def test_a_second_run_replaces_the_files(tmp_path: Path) -> None:
    """By the same bytes."""
    call("run", "--frames", "1", *options(tmp_path))
    before = [(tmp_path / each).read_bytes() for each in FILES]
    call("run", "--frames", "1", *options(tmp_path))
    assert [(tmp_path / each).read_bytes() for each in FILES] == before


@pytest.mark.parametrize("option", ["--trace", "--flame"])
@pytest.mark.parametrize("command", ["run", "profile"])
def test_a_place_that_cannot_be_is_told_before_the_run(option: str, command: str, tmp_path: Path) -> None:
    """A folder, a folder that is not there, and the recording itself."""
    recording = tmp_path / "drive.mcap"
    recording.write_bytes(b"precious")
    for path in (tmp_path, tmp_path / "nowhere" / "x"):
        result = call(command, option, str(path))
        assert result.exit_code == 2
        assert str(path) in result.stderr
    result = call(command, str(recording), option, str(recording))
    assert result.exit_code == 2
    assert "must be a file of its own" in result.stderr
    result = call(command, option, str(recording))  # the FILE is missing, and so another recording would run
    assert result.exit_code == 2
    assert "holds something else than what is written there" in result.stderr
    assert recording.read_bytes() == b"precious"
    assert names_in(tmp_path) == ["drive.mcap"]


def test_one_file_cannot_be_both(tmp_path: Path) -> None:
    """A trace and a flame graph are two files."""
    result = call("run", "--trace", str(tmp_path / "x"), "--flame", str(tmp_path / "x"))
    assert result.exit_code == 2
    assert "must be a file of its own" in result.stderr


def test_a_run_that_fails_leaves_nothing(tmp_path: Path) -> None:
    """A mistake in what was given, told after the file was begun."""
    result = call("run", "--firmware", "nowhere:nothing", *options(tmp_path))
    assert result.exit_code == 2
    assert not names_in(tmp_path)


@pytest.mark.exhaustive
def test_ctrl_c_leaves_a_whole_file_of_what_was_done(tmp_path: Path) -> None:
    """Interrupted in the middle of a run: the trace is readable to its end, and has the frames that were reported."""
    command = [sys.executable, "-m", "bfsim", "run", *options(tmp_path), "--json", str(tmp_path / "run.json")]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    written, until = 0, time.monotonic() + 300
    while written < A_FRAME_BYTES and time.monotonic() < until and process.poll() is None:
        time.sleep(0.01)
        written = sum(each.stat().st_size for each in tmp_path.glob(".bfsim-*.draft/run.pftrace"))
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 130, errors
    frames = len(json.loads((tmp_path / "run.json").read_text())["frames"])
    assert f"interrupted after {frames} frames" in errors
    tracks = tracks_of((tmp_path / FILES[0]).read_bytes())
    assert [each.name for each in tracks["core A", "frames"].slices][:frames] == [
        f"frame {number}" for number in range(frames)
    ]
    assert frames >= 1
