"""Small sweeps for the tests: the firmware of tests/test_run.py on a few rows of noise, run in this process."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

from bfsim.sweeping.running import Outcome, run_point
from bfsim.sweeping.store import Store
from bfsim.sweeping.sweep import Sweep, Workers
from tests.eyes import FIRMWARE, record

EYES = 'firmware = "fw_eyes.py:eyes"\n'

BASE = f"""\
[base]
{EYES}recording = "drive.mcap"
"""

FILE = f"""\
{BASE}
[axes]
set.sdram.nRP = [2, 4]
frames = [1, 2]
"""


class Here:
    """Calls functions at once, in this process."""

    deaths: tuple[type[Exception], ...] = ()
    tries = 1

    def room(self) -> int:
        """One at a time."""
        return 1

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Call it now."""
        future: Future[Any] = Future()
        future.set_result(fn(*args))
        return future

    def run_point(self, *what: Any) -> Future[Outcome]:
        """Run it now."""
        return self.submit(run_point, *what)


class Forgetful(Here):
    """Never records, and never plays."""

    def run_point(self, configuration: Any, folder: Path, code: str, work: object) -> Future[Outcome]:
        """Run it now."""
        return self.submit(run_point, configuration, folder, code)


def home_in(folder: Path, text: str = FILE) -> Path:
    """Write firmware, a recording of two frames, and a sweep into a folder; return the sweep."""
    folder.mkdir(exist_ok=True)
    (folder / "fw_eyes.py").write_text(FIRMWARE)
    record(folder / "drive.mcap", 2)
    (folder / "what-if.toml").write_text(text)
    return folder / "what-if.toml"


def swept(file: Path, workers: Workers | None = None) -> tuple[dict[str, Outcome], list[str]]:
    """Sweep, in this process if by no others, and return what became of each point by its name, and which ran now."""
    sweep = planned(file)
    ran: list[str] = []
    sweep.run(workers or Here(), lambda each, _outcome: ran.append(each.point.name))
    outcomes = {
        each.point.name: sweep.outcomes[each.key] if each.key else Outcome(error=each.error)
        for each in sweep.planned
    }
    return outcomes, ran


def planned(file: Path) -> Sweep:
    """Check the points of a sweep; its store is beside it."""
    sweep = Sweep(file, Store(file.with_suffix(".sweep")))
    sweep.plan(Here(), lambda _done, _all: None)
    return sweep
