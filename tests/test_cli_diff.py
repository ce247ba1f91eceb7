"""`bfsim diff` from the terminal's side: results and runs on the spot, all outputs, and mistakes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from bfsim.cli import main
from bfsim.recording import RecordingWriter

FIRMWARE = """
from bfsim.api import Buffer, BudgetRow, Firmware, i32, kernel, u8

@kernel
def brighten(row: u8[:], by: i32) -> None:
    for x in range(len(row)):
        row[x] = row[x] + by

def main(core):
    while (frame := (yield from core.next_frame())) is not None:
        core.publish(rows=len(frame.rows))
        with core.stage("Brighten"):
            for row in frame.rows[:4]:
                yield core.run(brighten, row, 3)

def buffers(size):
    return {core: [Buffer("camera", u8, 2 * size.width_px, f"sdram_bank{n}", rows=size.height_px)]
            for n, core in enumerate("AB")}

firmware = Firmware(mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=(BudgetRow(stage="Brighten"),))
"""


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with firmware and a recording of two grey frames, where the user is."""
    picture = np.full((16, 64), 128, np.uint8)
    with RecordingWriter(tmp_path / "drive.mcap", width=32, height=16) as writer:
        for number in range(2):
            writer.add(picture, picture, number * 33_000_000, number * 33_000_000)
    (tmp_path / "slow.py").write_text(FIRMWARE)
    (tmp_path / "fast.py").write_text(FIRMWARE.replace("frame.rows[:4]", "frame.rows[:2]"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def bfsim(*arguments: object) -> Result:
    """Call the command line in this process."""
    return CliRunner(env={"COLUMNS": "80"}).invoke(main, [str(each) for each in arguments])


def keep(name: str, *arguments: object) -> None:
    """Run firmware and keep the result."""
    done = bfsim("run", "drive.mcap", *arguments, "--json", name)
    assert done.exit_code == 0, done.output


def test_results_and_runs_on_the_spot_differ_alike(home: Path) -> None:
    """Half the calls: the cause is named, also where the cameras bound the frame; a side that is run is as good as one that is read."""
    keep("slow.json", "--firmware", "slow.py:firmware")
    keep("fast.json", "--firmware", "fast.py:firmware")
    read = bfsim("diff", "slow.json", "fast.json")
    assert read.exit_code == 0, read.output
    for words in ("as fast as before", "What differs in the configuration", "brighten (fast.py:", "All"):
        assert words in read.output
    on_the_spot = bfsim("diff", "slow.json", "drive.mcap --firmware fast.py:firmware")
    assert on_the_spot.output == read.output
    markdown = bfsim("diff", "slow.json", "fast.json", "--markdown")
    assert markdown.output.startswith("**")
    assert "| --- |" in markdown.output


def test_the_json_has_the_whole_tree(home: Path) -> None:
    """Stages sum to the difference, and the kernel's name and lines are the same in both files."""
    keep("before.json", "--firmware", "slow.py:firmware")
    keep("after.json", "--firmware", "slow.py:firmware", "--ldf", "l2")
    found = json.loads(bfsim("diff", "before.json", "after.json", "--json").output)
    assert found["schema"] == "bfsim.diff/1"
    assert sum(each["cclk"] for each in found["stages"]) == found["cclk"]
    assert found["cclk"] == found["after_cclk"] - found["before_cclk"]


def test_a_run_does_not_differ_from_itself(home: Path) -> None:
    """Read back, nothing is lost."""
    keep("once.json", "--firmware", "slow.py:firmware")
    same = bfsim("diff", "once.json", "drive.mcap --firmware slow.py:firmware")
    assert same.output.startswith("No difference")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "must be JSON as `bfsim run --json` writes it"),
        ("[]", "must be a result of `bfsim run --json`, not []"),
        ('{"schema": "bfsim.run/1"}', "must be a result of this version of bfsim"),
        ('{"schema": "SCHEMA"}', "identity must be there"),
        ('{"schema": "SCHEMA", "identity": 3}', "identity must"),
    ],
)
def test_a_file_that_is_no_result_is_refused(home: Path, text: str, told: str) -> None:
    """Before anything runs, with the file's name."""
    from bfsim.report.as_json import SCHEMA

    (home / "wrong.json").write_text(text.replace("SCHEMA", SCHEMA))
    refused = bfsim("diff", "wrong.json", "no-such-recording.mcap")
    assert refused.exit_code == 2
    assert "wrong.json" in refused.stderr
    assert told in " ".join(refused.stderr.split())


@pytest.mark.parametrize(
    ("side", "told"),
    [
        ("missing.json", "there is no such file"),
        ("drive.mcap --no-such-option", "No such option"),
        ("drive.mcap 'open", "words as a shell takes them"),
    ],
)
def test_a_side_that_cannot_be_is_refused(home: Path, side: str, told: str) -> None:
    """As `bfsim run` would refuse it."""
    refused = bfsim("diff", "drive.mcap --firmware slow.py:firmware", side)
    assert refused.exit_code == 2
    assert told in " ".join(refused.stderr.split())
