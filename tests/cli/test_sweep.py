"""`bfsim sweep` from the terminal, as a student and an engineer would use it."""

from __future__ import annotations

import csv
import io
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner, Result

from bfsim.cli.main import main
from bfsim.errors import ConfigError
from tests.eyes import FIRMWARE, record
from tests.sweeping.rig import BASE, FILE, Here, home_in, swept
from tests.test_ctrl_c import ENDLESS

HELD = FIRMWARE.replace(
    "def main(core):\n",
    """def main(core):
    import pathlib, time
    here = pathlib.Path(__file__).parent
    while core.name == "A" and (here / "hold").exists() and len([*here.glob("what-if.sweep/points/*/*.json")]) > 1:
        time.sleep(0.01)
""",
)
"""Firmware of which two runs come to their end, and the others wait as long as there is a file `hold`."""


def call(*arguments: object) -> Result:
    """Call the command line in this process; unexpected exceptions come through."""
    return CliRunner().invoke(
        main, ["sweep", *map(str, arguments)], catch_exceptions=False, prog_name="bfsim"
    )


@contextmanager
def pool(_processes: int) -> Iterator[Here]:
    """Stand for the worker processes."""
    yield Here()


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The sweep of tests/sweeping/rig.py in the current folder, run in this process."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setattr("bfsim.sweeping.workers.Pool", pool)
    home_in(tmp_path)
    return Path("what-if.toml")


def table(file: Path) -> list[dict[str, str]]:
    """The rows of the CSV."""
    text = (file.with_suffix(".sweep") / "what-if.csv").read_text()
    return list(csv.DictReader(io.StringIO(text)))


@pytest.mark.usefixtures("file")
def test_one_frame_is_one_frame_and_one_point_one_point() -> None:
    """It was `1 frames`."""
    Path("one.toml").write_text(
        '[base]\nfirmware = "fw_eyes.py"\nrecording = "drive.mcap"\n[axes]\nframes = [1]\n'
    )
    assert re.search(r"1 of 1 points to run, 1 frame: about", call(Path("one.toml"), "--dry-run").output)
    assert call(Path("one.toml")).output.startswith("1 point: 1 done.\n")


def test_what_came_out_is_told_although_the_table_has_no_room(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disk may fill up while points run, which takes longer than to write a table."""

    def full(path: Path, *_content: object) -> None:
        raise ConfigError(f"{path} must be writable: No space left on device")

    assert call(file).exit_code == 0
    monkeypatch.setattr("bfsim.files.save.write_bytes", full)
    done = call(file)
    assert done.exit_code == 2
    assert done.stdout.startswith("4 points: 4 done (4 of them before).\n")
    assert "All figures" not in done.stdout
    assert done.stderr.endswith("what-if.csv must be writable: No space left on device\n")


def test_the_walk_of_a_student(file: Path) -> None:
    """What there is to do, what came out, and nothing of it twice."""
    listed = call(file, "--dry-run").output
    assert "nRP=4 frames=2" in listed
    assert re.search(r"4 of 4 points to run, 6 frames: about \d+ s\.\n", listed)
    assert not (file.with_suffix(".sweep") / "points").exists()
    first = call(file)
    assert first.exit_code == 0, first.output
    assert max(map(len, first.output.splitlines())) <= 80
    assert "4 points: 4 done.\n" in first.output
    assert "* nRP=2 frames=" in first.output
    rows = table(file)
    assert [row["point"] for row in rows] == [f"nRP={n} frames={count}" for n in (2, 4) for count in (1, 2)]
    assert float(rows[0]["frame_rate Hz"]) > 1
    assert {"results.bright_A.total", "stall.B.SDRAM page miss ms", "idle.A %", "memory.L2 B", "missed"} < {
        *rows[0]
    }
    assert "4 points: 4 done (4 of them before).\n" in call(file).output
    assert table(file) == rows
    assert "0 of 4 points to run, 0 frames: about 0 s." in call(file, "--dry-run").output


def test_the_time_that_is_told_has_that_in_which_processes_start(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a small sweep that is most; checking the points, which processes do, has taken as long."""
    clock = iter((0.0, 40.0))
    monkeypatch.setattr("bfsim.cli.sweep.time", SimpleNamespace(monotonic=lambda: next(clock)))
    told = re.search(r"4 of 4 points to run, 6 frames: about (\d+) s\.\n", call(file, "--dry-run").output)
    assert told
    assert 40 <= int(told[1]) < 60


@pytest.mark.exhaustive
def test_parquet_and_plots(file: Path) -> None:
    """Numbers are numbers; any two columns, also of text; a column that is not there is told after the rest."""
    parquet = pytest.importorskip("pyarrow.parquet")
    assert call(file).exit_code == 0
    found = parquet.read_table("what-if.sweep/what-if.parquet").to_pydict()
    assert found["set.sdram.nRP"] == [2, 2, 4, 4]
    assert found["frame_rate Hz"] == [float(row["frame_rate Hz"]) for row in table(file)]
    plot = Path("what-if.sweep/what-if.svg")
    assert all(name in plot.read_text() for name in ("frame.median ms", "on_chip B", "nRP=4 frames=2"))
    assert "latency.max ms against point: " in call(file, "--plot", "x=point,y=latency.max ms").output
    assert "latency.max ms" in plot.read_text()
    missing = call(file, "--plot", "x=frame_rate,y=missed")
    assert missing.exit_code == 2
    assert "4 points: 4 done" in missing.output
    assert "there must be a column frame_rate; the nearest are frame_rate Hz" in missing.output
    wrong = call(file, "--plot", "x=3")
    assert wrong.exit_code == 2
    assert "must be x=COLUMN,y=COLUMN" in wrong.output


@pytest.mark.exhaustive
def test_many_recordings_are_a_line_for_each_setting(file: Path) -> None:
    """The least frame rate of all recordings, and how many they were; the table has each."""
    for name in ("b", "c"):
        record(Path(f"{name}.mcap"), 2, width=64)
    axes = '[axes]\nrecording = ["*.mcap"]\nset.clocks.cclk_hz = [600e6, 300e6]\n'
    file.write_text(BASE.replace('recording = "drive.mcap"\n', "") + axes)
    output = call(file).output
    assert "6 points: 6 done." in output
    rows = table(file)
    slow = [float(row["frame_rate Hz"]) for row in rows if row["cclk_hz"] == "300000000.0"]
    (line,) = [each for each in output.splitlines() if "cclk_hz=300000000" in each]
    assert f" {min(slow):.2f} " in line
    assert line.endswith(" 3")


def test_what_cannot_work_is_told_at_once(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The others go on, unless --strict says no."""
    file.write_text(FILE.replace("[axes]", '[axes]\nldf = ["thesis", "none"]'))
    listed = call(file, "--dry-run")
    assert listed.exit_code == 2
    assert "4 of 8 points can never work:" in listed.output
    done = call(file)
    assert done.exit_code == 2
    assert "4 of 8 points can never work:" in done.output
    assert "8 points: 4 done, 4 failed." in done.output
    assert [bool(row["error"]) for row in table(file)] == [False] * 4 + [True] * 4
    monkeypatch.setattr("bfsim.machine.board.Board.run", None)
    file.with_name("fw_eyes.py").write_text(FIRMWARE.replace("> 100", "> 101"))
    strict = call(file, "--strict")
    assert strict.exit_code == 2
    assert "--strict: 4 of 8 points can never work:" in strict.output


@pytest.mark.exhaustive
def test_all_processes_warn_together(tmp_path: Path) -> None:
    """Of a cache that others may write to: as every command does, and not once for each process."""
    file = home_in(tmp_path)
    cache = tmp_path / "cache"
    cache.mkdir()
    cache.chmod(0o777)
    command = [sys.executable, "-m", "bfsim", "sweep", str(file), "--workers", "2"]
    environment = os.environ | {"BFSIM_CACHE_DIR": str(cache)}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0
    assert re.fullmatch("bfsim: warning: the kernel cache .* must be private, .*\n", done.stderr)


@pytest.mark.exhaustive
@pytest.mark.parametrize(("number", "exit_code"), [(signal.SIGINT, 130), (signal.SIGHUP, 129)])
def test_ctrl_c_ends_it_cleanly(tmp_path: Path, number: int, exit_code: int) -> None:
    """What is done is reported and kept, no process is left, and the same command goes on; so it is as its terminal is closed."""
    file = home_in(tmp_path, FILE.replace("[2, 4]", "[2, 3, 4, 5, 6, 7]"))
    (tmp_path / "fw_eyes.py").write_text(HELD)
    (tmp_path / "hold").touch()
    command = [sys.executable, "-m", "bfsim", "sweep", str(file), "--workers", "1"]
    before = signal.signal(number, signal.SIG_DFL)  # the tests may be run where it is ignored, behind nohup
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        signal.signal(number, before)
        while len(list(tmp_path.glob("what-if.sweep/points/*/*.json"))) < 2:
            time.sleep(0.02)
            assert process.poll() is None
        os.killpg(process.pid, number)
        output, errors = process.communicate()
    assert process.returncode == exit_code, errors
    assert errors == "bfsim: interrupted; the same command goes on from here\n"
    assert " not yet.\n" in output
    with pytest.raises(ProcessLookupError):
        for _ in range(1000):  # Python's own helper of its processes needs a moment
            os.killpg(process.pid, 0)
            time.sleep(0.02)
    (tmp_path / "hold").unlink()
    kept = len(list(tmp_path.glob("what-if.sweep/points/*/*.json")))
    reported = sum(bool(row["frame_rate Hz"]) for row in table(file))
    assert 2 <= kept == reported < 12
    assert len(swept(file)[1]) == 12 - kept


@pytest.mark.exhaustive
def test_ctrl_c_ends_processes_whose_kernel_does_not_end(tmp_path: Path) -> None:
    """It was short before, and keeps Python: the process hears nothing, and ends when it is let go."""
    (tmp_path / "fw_endless.py").write_text(ENDLESS.replace('"begun"', repr(str(tmp_path / "begun"))))
    file = tmp_path / "endless.toml"
    file.write_text('[base]\nframes = 1\nfirmware = "fw_endless.py:fw"\n[axes]\nset.sdram.nRP = [2]\n')
    command = [sys.executable, "-m", "bfsim", "sweep", str(file), "--workers", "1"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        while process.poll() is None and not (tmp_path / "begun").exists():
            time.sleep(0.05)
        time.sleep(1)
        process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=30)
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == 130


@pytest.mark.parametrize("folder", ["", ".", "/"])
def test_a_folder_is_no_sweep(folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor is one without a name, of which the folder of results had none."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigError, match=r"^[./] must be a readable file: Is a directory$"):
        CliRunner().invoke(main, ["sweep", folder], catch_exceptions=False, standalone_mode=False)


def test_help_teaches_the_file() -> None:
    """The example in it is a sweep."""
    output = call("--help").output
    assert "[axes]" in output
    assert "set.clocks.cclk_hz = [500e6, 600e6]" in output
