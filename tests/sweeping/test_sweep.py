"""A sweep in this process: each point once, by what it is and not by its name, whatever happens to one of them."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from bfsim.errors import ConfigError
from bfsim.report.sweep.figures import FRAME_RATE, SEEN
from bfsim.report.sweep.table import columns_of
from bfsim.result import Run
from bfsim.run import simulate
from bfsim.shipped import LDF_FOLDER
from bfsim.sweeping.rows import rows_of
from bfsim.sweeping.running import Figures, Outcome, run_point
from bfsim.sweeping.sweep import NOT_KEPT
from bfsim.sweeping.workers import Pool
from tests.eyes import FIRMWARE, record
from tests.sweeping.rig import BASE, FILE, Forgetful, Here, home_in, planned, swept

NAMES = ["nRP=2 frames=1", "nRP=2 frames=2", "nRP=4 frames=1", "nRP=4 frames=2"]

OUTSIDE = FIRMWARE.replace(
    "    found = 0\n", "    found = 0\n    if counts[0] > 700:\n        found += line[600_000]\n"
)
"""Reads far outside its line in the second frame: some 620 pixels of each are bright."""

KILLS = 6


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """The sweep of rig.py in a folder of its own."""
    return home_in(tmp_path)


def test_every_point_is_run_once(file: Path) -> None:
    """As `simulate` would run it; the second time nothing is."""
    outcomes, ran = swept(file)
    assert ran == list(outcomes) == NAMES
    recording, firmware = file.parent / "drive.mcap", f"{file.parent}/fw_eyes.py:eyes"
    alone = simulate(recording, firmware=firmware, frames=2, settings={"sdram.nRP": 4})
    assert outcomes[NAMES[3]].identity == alone.identity
    bright = sum(frame.results["bright_A"] for frame in alone.frames)
    assert outcomes[NAMES[3]].figures["results.bright_A.total"] == bright
    assert swept(file) == (outcomes, [])


@pytest.mark.exhaustive
def test_what_is_new_or_changed_is_run(file: Path) -> None:
    """More points; edited firmware; another recording under the same name. Back again, nothing is."""
    swept(file)
    file.write_text(FILE.replace("[2, 4]", "[2, 3, 4]"))
    assert swept(file)[1] == ["nRP=3 frames=1", "nRP=3 frames=2"]
    file.with_name("fw_eyes.py").write_text(FIRMWARE.replace("> 100", "> 101"))
    assert len(swept(file)[1]) == 6
    file.with_name("fw_eyes.py").write_text(FIRMWARE)
    assert swept(file)[1] == []
    record(file.with_name("drive.mcap"), 2, period_ns=50_000_000)  # its first frame is the same
    assert swept(file)[1] == ["nRP=2 frames=2", "nRP=3 frames=2", "nRP=4 frames=2"]


def test_what_points_have_in_common_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each LDF with its macros, each board, the recording; the next plan sees what was edited."""
    mine = tmp_path / "mine.ldf"
    mine.write_text((LDF_FOLDER / "l2.ldf").read_text())
    axes = '[axes]\nset.sdram.nRP = [2, 3, 4]\nldf = ["mine.ldf", "sdram"]\nframes = [1, 2]\n'
    file, calls = home_in(tmp_path, BASE + axes), Counter[str]()

    def counted(place: str) -> None:
        function = getattr(sys.modules[place.rpartition(".")[0]], name := place.rpartition(".")[2])

        def called(*args: Any, **kwargs: Any) -> Any:
            calls[name] += 1
            return function(*args, **kwargs)

        monkeypatch.setattr(place, called)

    counted("bfsim.loading.hardware.with_settings")
    for each in ("inputs.parse_ldf", "inputs.RecordingReader", "room.link"):
        counted(f"bfsim.running.{each}")
    before = {each.point.name: each.identity for each in planned(file).planned}
    assert calls == {"parse_ldf": 2, "with_settings": 3, "RecordingReader": 1, "link": 2}
    mine.write_text(f"{mine.read_text()}\n")
    after = {each.point.name: each.identity for each in planned(file).planned}
    changed = {name for name, each in before.items() if each != after[name]}
    assert changed == {name for name in before if "mine.ldf" in name}
    assert calls["parse_ldf"] == 4


def test_points_that_are_the_same_run_once(tmp_path: Path) -> None:
    """Whatever they are called; each has its row."""
    points = '[[point]]\nname = "one"\nframes = 2\n[[point]]\nname = "other"\n'
    outcomes, ran = swept(home_in(tmp_path, BASE + points))
    assert ran == ["other"]
    assert outcomes["one"] == outcomes["other"]


def test_a_failing_point_is_told_and_the_rest_goes_on(tmp_path: Path) -> None:
    """One that can never work before anything runs; one that fails in a run is not run again."""
    axes = '[axes]\nframes = [1, 2]\nldf = ["thesis", "none"]\n'
    file = home_in(tmp_path, BASE + axes)
    file.with_name("fw_eyes.py").write_text(OUTSIDE)
    outcomes, ran = swept(file)
    assert ran == ["frames=1 ldf=thesis", "frames=2 ldf=thesis"]
    assert not outcomes[ran[0]].error
    assert "index" in outcomes[ran[1]].error
    must_be = "LDF must be a file or a shipped one (cache, cm-bf533, l2, sdram, thesis)"
    assert must_be in outcomes["frames=1 ldf=none"].error
    assert swept(file) == (outcomes, [])


@pytest.mark.exhaustive
def test_firmware_that_changes_under_the_sweep_is_told_and_not_kept(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The figures are another's than the point's."""
    before = planned(file)
    monkeypatch.setattr("tests.sweeping.rig.planned", lambda _file: before)
    file.with_name("fw_eyes.py").write_text(FIRMWARE.replace("> 100", "> 101"))
    outcomes, ran = swept(file)
    assert ran == NAMES
    assert all(each.warnings == (NOT_KEPT,) for each in outcomes.values())
    monkeypatch.undo()
    assert swept(file)[1] == NAMES


def test_rows_say_what_a_point_is(tmp_path: Path) -> None:
    """All points have the same columns, in which numbers are numbers."""
    text = f'{BASE}[axes]\nset.clocks.cclk_hz = [600e6, "500e6"]\nldf = ["l2", "none"]\n'
    file = home_in(tmp_path, text)
    swept(file)
    columns = columns_of(rows_of(planned(file)))
    assert columns["set.clocks.cclk_hz"] == [6e8, 6e8, 5e8, 5e8]
    assert columns["cclk_hz"] == [6e8, None, 5e8, None]
    assert columns["ldf"] == ["l2.ldf", "none", "l2.ldf", "none"]
    assert columns["recording"] == ["drive.mcap"] * 4
    assert [bool(each) for each in columns["error"]] == [False, True, False, True]
    assert [each and each > 0 for each in columns["frame_rate Hz"]] == [True, None, True, None]


def test_what_was_seen_in_one_point_was_seen_0_times_in_others(tmp_path: Path) -> None:
    """In those that are done; of the others nobody knows."""
    sweep = planned(home_in(tmp_path, f"{BASE}[axes]\nset.clocks.cclk_hz = [600e6, 500e6, 400e6]\n"))
    ball, rate = f"{SEEN}ball", {FRAME_RATE: 5}
    figures: list[Figures] = [{**rate, ball: 2}, rate]
    for each, found in zip(sweep.planned, figures, strict=False):
        sweep.outcomes[each.key] = Outcome(figures=found)
    assert columns_of(rows_of(sweep))[ball] == [2, 0, None]


@pytest.mark.exhaustive
def test_a_sweep_that_is_killed_loses_nothing(file: Path) -> None:
    """At any moment: what was kept is never run again, and in the end it is what an undisturbed one finds."""
    file.write_text(FILE.replace("[2, 4]", "[2, 3, 4, 5, 6, 7]"))
    elsewhere = home_in(file.parent / "else", file.read_text())
    undisturbed, _ = swept(elsewhere)
    command = [sys.executable, "-m", "tests.sweeping.killed", str(file), str(KILLS)]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    kept = [set(each.split()) for each in done.stdout.splitlines()]
    assert all(earlier <= later for earlier, later in pairwise(kept))
    assert kept[0] < kept[-1]
    assert len(kept[-1]) == 12
    runs = [each.read_text() for each in file.parent.glob("began-*")]
    assert len(runs) <= 12 + KILLS
    outcomes, ran = swept(file)
    assert ran == []
    assert _figures(outcomes) == _figures(undisturbed)


def _figures(outcomes: Mapping[str, Outcome]) -> dict[str, Mapping[str, float]]:
    return {name: each.figures for name, each in outcomes.items()}


class Mortal(Here):
    """Has a process die the first `times` that a point is run."""

    deaths = (ChildProcessError,)
    tries = 2

    def __init__(self, times: int) -> None:
        self.times = times

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Call it, or die."""
        if fn is not run_point or self.times <= 0:
            return super().submit(fn, *args)
        self.times -= 1
        future: Future[Any] = Future()
        future.set_exception(ChildProcessError())
        return future


@pytest.mark.parametrize("times", [1, 5])
def test_a_point_whose_process_dies_is_tried_once_more(file: Path, times: int) -> None:
    """And then told, but not kept: it may have been the machine's fault."""
    sweep = planned(file)
    sweep.run(Mortal(times), lambda _point, _outcome: None)
    errors = [sweep.error_of(each) for each in sweep.planned]
    failed = ["the process that ran it died 2 times"] * (
        times // len(NAMES)
    )  # the fifth death is a point's second
    assert [each for each in errors if each] == failed
    assert len(swept(file)[1]) == len(failed)


@pytest.mark.parametrize("times", [1, 2])
def test_a_trial_whose_process_dies_says_nothing_of_the_time(file: Path, times: int) -> None:
    """`--dry-run` ended in a traceback where the memory of the machine did not suffice."""
    sweep, workers = planned(file), Mortal(times)
    tried = sweep.try_out(sweep.planned[0], 1, workers)
    assert (tried.frames, tried.error) == (0, "the process that tried it died")


class Gone(Here):
    """Has the scheduler go away, which cancels what was asked of it."""

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Ask, and hear nothing."""
        future: Future[Any] = Future()
        future.cancel()
        future.set_running_or_notify_cancel()
        return future


def test_a_scheduler_that_goes_away_ends_the_sweep(file: Path) -> None:
    """With what to do, and with nothing lost."""
    sweep = planned(file)
    with pytest.raises(ConfigError, match="the same command runs the rest"):
        sweep.run(Gone(), lambda _point, _outcome: None)
    assert swept(file)[1] == NAMES


def test_points_that_differ_in_the_board_are_played(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One run of each LDF is recorded; the others have the figures that they have by themselves. Nothing of it stays behind."""
    axes = '[axes]\nset.sdram.nRP = [2, 4]\nset.clocks.cclk_hz = [600e6, 300e6]\nldf = ["thesis", "l2"]\n'
    file.write_text(BASE + axes)
    runs: list[str] = []

    def simulated(*arguments: Any, **what: Any) -> Run:
        runs.append("played" if what.get("work") else "recorded" if what.get("record_work") else "run")
        return simulate(*arguments, **what)

    monkeypatch.setattr("bfsim.sweeping.running.simulate", simulated)
    played, _ = swept(file)
    assert sorted(runs) == ["played"] * 4 + ["recorded"] * 2 + ["run"] * 2
    assert not list((file.with_suffix(".sweep") / "works").iterdir())
    elsewhere = home_in(file.parent / "else", file.read_text())
    alone, _ = swept(elsewhere, Forgetful())
    assert runs[8:] == ["run"] * 8
    assert _figures(played) == _figures(alone)
    assert {name: each.identity for name, each in played.items()} == {
        name: each.identity for name, each in alone.items()
    }
    assert {name: each.warnings for name, each in played.items()} == {
        name: each.warnings for name, each in alone.items()
    }


@pytest.mark.exhaustive
def test_a_process_that_dies_takes_its_call_along_and_nothing_else() -> None:
    """The next call gets a new process; none outlives the pool."""
    pool = Pool(2)
    try:
        waiting, dying = pool.submit(time.sleep, 0.5), pool.submit(os._exit, 3)
        assert isinstance(dying.exception(), Pool.deaths)
        other = pool.submit(os.getpid).result()
        assert waiting.result() is None
        endless = pool.submit(time.sleep, 600)
    finally:
        pool.shutdown()
    assert isinstance(endless.exception(), Pool.deaths)
    with pytest.raises(ProcessLookupError):
        os.kill(other, 0)


DEAF = """
import signal
from bfsim.sweeping.workers import Pool

if __name__ == "__main__":
    with Pool(2) as pool:
        masks = [pool.submit(signal.pthread_sigmask, signal.SIG_BLOCK, ()) for _ in range(2)]
        print([signal.SIGINT in each.result() for each in masks])
"""


def test_no_process_of_a_sweep_hears_ctrl_c(tmp_path: Path) -> None:
    """The first one did, for Python starts a helper with it that lets SIGINT through again: its traceback stood in the terminal."""
    (tmp_path / "deaf.py").write_text(DEAF)
    done = subprocess.run(
        [sys.executable, "deaf.py"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout == "[True, True]\n"
