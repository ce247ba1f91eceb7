"""Recorded work in a sweep: one point of those that differ in the board alone records it, if that pays, and nothing stays behind."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from bfsim.sweeping import running
from bfsim.sweeping.running import MOST_WAITS, Outcome, Work, code_digest, run_point
from bfsim.sweeping.sweep import Sweep
from bfsim.sweeping.works import LEAST_FRAMES, LEAST_LEFT, MANY_LEFT, WORKS, Works
from tests.sweeping.rig import BASE, home_in, planned
from tests.sweeping.test_store import CLAIM

BOARDS = "[axes]\nset.sdram.nRP = [2, 3, 4, 5, 6]\nset.sdram.nRCD = [2, 3]\n"
RUN = Outcome(frames=1, figures={"objects.ball.total": 3, "frame_rate Hz": 10.0})


@pytest.fixture
def sweep(tmp_path: Path) -> Sweep:
    """Ten points that differ in the board."""
    return planned(home_in(tmp_path, BASE + BOARDS))


def test_one_records_while_others_run_and_the_rest_is_played(sweep: Sweep) -> None:
    """Whoever is asked: what has begun before the recording was whole runs."""
    first, second, third, *rest = (each.key for each in sweep.todo)
    with Works(sweep.store, sweep.todo) as works:
        assert works.order(first) is None  # nothing is known yet
        works.done(first, RUN)
        order = works.order(second)
        assert order is not None
        assert order.seen is None
        assert works.order(third) is None  # the other one records
        order.path.write_text("whole")
        works.done(second, RUN)
        works.done(third, RUN)
        for key in rest:
            assert works.order(key) == Work(order.path, {"objects.ball.total": 3})
            works.done(key, RUN)
        assert not order.path.exists()
    assert not list((sweep.store.folder / WORKS).iterdir())


def test_points_wait_for_what_they_can_be_played_from(sweep: Sweep) -> None:
    """While the first one of them runs, and while one is recorded: not before, between or afterwards."""
    first, second, third, *_ = (each.key for each in sweep.todo)
    with Works(sweep.store, sweep.todo) as works:
        assert not works.is_expected(third)
        works.order(first)
        assert works.is_expected(third)
        works.done(first, RUN)
        assert not works.is_expected(third)
        order = works.order(second)
        assert order is not None
        assert works.is_expected(third)
        order.path.write_text("whole")
        works.done(second, RUN)
        assert not works.is_expected(third)


def test_of_many_long_points_the_first_one_records_if_a_trial_says_that_it_pays(sweep: Sweep) -> None:
    """The others run until it is done, and are played then; few or short points are worth no trial."""
    points = [replace(each, frames=LEAST_FRAMES) for each in sweep.todo]
    first, second, third, *_ = (each.key for each in points)
    with Works(sweep.store, points) as works:
        order = works.order(first)
        assert order is not None
        assert order == Work(order.path, is_tried=True)
        assert works.order(second) is None
        assert works.is_expected(third)
        order.path.write_text("whole")
        works.done(first, RUN)
        assert works.order(third) == Work(order.path, {"objects.ball.total": 3})
    for few_or_short in (points[: MANY_LEFT - 1], sweep.todo):
        with Works(sweep.store, few_or_short) as works:
            assert works.order(first) is None


@pytest.mark.parametrize(("waits", "is_recorded"), [(MOST_WAITS, True), (MOST_WAITS + 0.01, False)])
def test_a_point_is_recorded_if_its_trial_waits_little(
    sweep: Sweep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, waits: float, is_recorded: bool
) -> None:
    """Else it is run."""
    monkeypatch.setattr(running, "_waits", lambda _: waits)
    (point, *_), path = sweep.points, tmp_path / "run.work"
    outcome = run_point(point.configuration, tmp_path, code_digest(), Work(path, is_tried=True))
    assert not outcome.error
    assert outcome.frames == 2
    assert path.exists() == is_recorded


@pytest.mark.parametrize(("left", "waits"), [(LEAST_LEFT + 1, MOST_WAITS + 0.01), (LEAST_LEFT, 0)])
def test_what_does_not_pay_is_not_recorded(sweep: Sweep, left: int, waits: float) -> None:
    """With many waits for memory playing takes as long as running; and of few points recording one takes longer than it saves."""
    points = sweep.todo[:left]
    with Works(sweep.store, points) as works:
        for each in points:
            assert works.order(each.key) is None
            works.done(each.key, replace(RUN, waits=waits))


def test_a_point_that_dies_as_it_records_is_run(sweep: Sweep) -> None:
    """It may have been the recording that took the memory; the others are run, too."""
    first, second, *rest = (each.key for each in sweep.todo)
    with Works(sweep.store, sweep.todo) as works:
        works.order(first)
        works.done(first, RUN)
        assert works.order(second) is not None
        assert all(works.order(each) is None for each in (second, *rest))


@pytest.mark.exhaustive
def test_works_of_a_killed_sweep_are_removed_and_those_of_another_one_stay(sweep: Sweep) -> None:
    """Whoever runs has a claim on its folder, which ends with the process."""
    folder = sweep.store.folder / WORKS
    killed, running, other = folder / ("a" * 32), folder / ("b" * 32), folder / "notes"
    for each in (killed, running, other):
        each.mkdir(parents=True)
        (each / "some.work").touch()
    command = [sys.executable, "-c", CLAIM, str(sweep.store.folder), running.name]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout
        assert process.stdout.readline() == "True\n"
        with Works(sweep.store, sweep.todo):
            assert not killed.exists()
            assert (running / "some.work").exists()
            assert (other / "some.work").exists()
        process.kill()


def test_a_full_disk_costs_only_the_recording(
    sweep: Sweep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The point is run without."""

    def full(*_: Any, **__: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(zipfile.ZipFile, "writestr", full)
    (point, *_), path = sweep.points, tmp_path / "run.work"
    outcome = run_point(point.configuration, tmp_path, code_digest(), Work(path))
    assert not outcome.error
    assert outcome.frames == 2
    assert not path.exists()


@pytest.mark.parametrize("content", [None, b"", b"no zip"])
def test_work_that_cannot_be_read_is_run(sweep: Sweep, tmp_path: Path, content: bytes | None) -> None:
    """Somebody has removed it, or cut it."""
    path = tmp_path / "run.work"
    if content is not None:
        path.write_bytes(content)
    outcome = run_point(sweep.points[0].configuration, tmp_path, code_digest(), Work(path, {}))
    assert not outcome.error
    assert outcome.frames == 2


def test_a_change_of_a_command_leaves_the_code_as_it_is(tmp_path: Path) -> None:
    """Points that are done stay done; a change of anything else does them again."""
    (tmp_path / "cli").mkdir()
    (tmp_path / "machine").mkdir()
    command, bus, grammar = (tmp_path / name for name in ("cli/run.py", "machine/bus.py", "ldf.lark"))
    for path in (command, bus, grammar):
        path.write_text("then")

    def digest() -> str:
        code_digest.cache_clear()
        return code_digest(tmp_path)

    then = digest()
    command.write_text("now")
    assert digest() == then
    for path in (bus, grammar):
        path.write_text("now")
        assert digest() != then
        path.write_text("then")
    code_digest.cache_clear()
