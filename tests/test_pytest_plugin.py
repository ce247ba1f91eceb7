"""The pytest plugin in test suites of its users, alone and under xdist."""

from __future__ import annotations

import importlib.metadata
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.eyes import FIRMWARE
from tests.tiers import exhaustive

ROOT = Path(__file__).parent.parent
SUITE = """
import pytest

def test_a_run(bfsim):
    assert bfsim(frames=1).frames

def test_the_same_run_is_there_already(bfsim):
    assert bfsim(frames=1) is bfsim(frames=1)

def test_another_folder_may_have_other_files_of_those_names(bfsim, tmp_path, monkeypatch):
    here = bfsim(frames=1)
    monkeypatch.chdir(tmp_path)
    assert bfsim(frames=1) is not here

@pytest.mark.frame_budget("latency <= 500 ms", min_hz=5, stages={"Edge detection": 90})
def test_kept(bfsim):
    bfsim(frames=1)

@pytest.mark.frame_budget(min_hz=15, stages={"Edge detection": 10.5})
def test_broken(bfsim):
    bfsim(frames=1)

@pytest.mark.frame_budget("latency <= 500 parsecs")
def test_misspelt(bfsim):
    bfsim(frames=1)

@pytest.mark.frame_budget(stages={"Edge detektion": 90})
def test_another_stage(bfsim):
    bfsim(frames=1)

@pytest.mark.frame_budget(min_hz="15")
def test_no_number(bfsim):
    bfsim(frames=1)

@pytest.mark.frame_budget(min_hz=10**400)
def test_no_such_number(bfsim):
    bfsim(frames=1)

@pytest.mark.frame_budget(15)
def test_no_sentence(bfsim):
    bfsim(frames=1)

@pytest.mark.frame_budget(max_ms=3)
def test_another_limit(bfsim):
    bfsim(frames=1)

@pytest.mark.frame_budget(stages={})
def test_no_limit(bfsim):
    bfsim(frames=1)

@pytest.mark.frame_budget(min_hz=5)
def test_that_runs_nothing(bfsim):
    pass

@pytest.mark.frame_budget(min_hz=5)
def test_without_the_fixture():
    pass

def test_kept_limits(bfsim_check):
    runs = bfsim_check("budget.toml", "kept")
    assert list(runs) == ["kept"] and runs["kept"].frames

def test_broken_limits(bfsim_check):
    bfsim_check()

def test_firmware_that_fails(bfsim):
    bfsim(firmware="failing.py", frames=1)

def test_no_frames(bfsim):
    bfsim(frames=0)

def test_no_such_argument(bfsim):
    bfsim(frame=1)

def test_no_baseline(bfsim_check):
    bfsim_check("limits.toml")

def test_nothing_to_keep(bfsim_check):
    bfsim_check("bare.toml")
"""
BASELINE = """
[[run]]
name = "kept"
frames = 1
require = ["missed == 0"]
[[run]]
name = "faster than light"
frames = 1
tolerance_percent = 1
limits = ["frame_rate >= 1000 Hz", '"Edge detection".max <= 1 ms']
"""


def suite(folder: Path, *options: str) -> str:
    """Run the suite in a process of its own, and return what it prints."""
    (folder / "test_budget.py").write_text(SUITE)
    (folder / "budget.toml").write_text(BASELINE)
    (folder / "failing.py").write_text(FIRMWARE.replace("bright = 0", "bright = 1 // 0"))
    (folder / "bare.toml").write_text('[[run]]\nname = "bare"\nframes = 1\n')
    (folder / "pytest.ini").write_text("[pytest]\naddopts = --strict-markers\n")
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-p",
        "bfsim.pytest_plugin",
        "-p",
        "no:cacheprovider",
        *options,
    ]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("options", [["-n0"], *exhaustive(["-n2"])])
def test_fixture_and_marker(tmp_path: Path, options: list[str]) -> None:
    """The text of the failure is what broke, stages, kernels and lines, and the screen; in one process and in two workers."""
    told = suite(tmp_path, *options)
    assert "11 failed, 5 passed, 5 errors" in told
    assert "FAILED: faster than light: " in told
    assert "FAILED: kept" not in told
    assert "frame_rate must be >= 990.00 Hz, not " in told
    assert "frame_rate must be >= 15.00 Hz, not " in told
    assert '"Edge detection".max must be <= 10.500 ms, not ' in told
    assert "Edge detection takes 1" in told
    assert re.search(
        r"  isqrt32 \(arithmetic\.py:\d+\): [\d.]+ ms\n    \d+  .* times x [\d.]+ cycles: ", told
    )
    assert "frames/s (of one frame, with the wait for its picture)" in told
    lines = " ".join(told.split())
    assert "a frame (of one frame, with the wait for its picture): bound by core A's Edge detection" in lines
    assert "the unit of latency must be cycles or s or ms or us, not 'parsecs'" in told
    assert '"Edge detektion" must be something that the run has; the nearest are "Edge detection"' in told
    assert "@pytest.mark.frame_budget: min_hz must be a number, not '15'" in told
    assert "@pytest.mark.frame_budget: min_hz must be a number, not 1000" in told
    assert '@pytest.mark.frame_budget: a limit must be a sentence such as "latency <= 200 ms", not 15' in told
    assert "@pytest.mark.frame_budget: max_ms must be min_hz or stages" in told
    assert "@pytest.mark.frame_budget must say a limit, min_hz or stages, for nothing breaks it" in told
    assert told.count("must be of a test that runs firmware by the fixture `bfsim`; this one ran none") >= 2
    assert "limits.toml must be a baseline file, but there is none" in told
    assert "bare.toml: run 'bare' must have limits or a require, but has neither" in told
    # a mistake in firmware, a marker or a baseline is told without the code that found it
    assert ">           bright = 1 // 0\n" in told
    assert told.count('>       bfsim(firmware="failing.py", frames=1)\n') == 1
    assert (
        ">       bfsim(frames=0)\nE       bfsim.errors.ConfigError: frames must be at least 1, not 0\n"
        in told
    )
    assert (
        ">       bfsim(frame=1)\nE       TypeError: simulate() got an unexpected keyword argument 'frame'\n"
        in told
    )
    assert not re.search(r"/bfsim/\w+\.py:\d+: ", told)
    assert "pytest_plugin.py:" not in told
    assert "another exception occurred" not in told


def test_who_does_not_use_it_does_not_wait_for_it() -> None:
    """The plugin is imported by every pytest where bfsim is installed: without the simulator."""
    program = "import bfsim.pytest_plugin, sys; print({'numba', 'llvmlite', 'simpy', 'pydantic', 'bfsim.run'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_it_is_an_entry_point_of_the_package() -> None:
    """Installed with bfsim, pytest finds it by itself."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    point = importlib.metadata.EntryPoint(
        "p", project["entry-points"]["pytest11"]["bfsim.pytest_plugin"], "pytest11"
    )
    assert point.load().MARK == "frame_budget"
