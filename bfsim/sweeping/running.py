"""Run one point of a sweep. These functions are called in worker processes, here and on other machines."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event, Lock
from time import perf_counter
from typing import Any

from bfsim.checking import arguments_of
from bfsim.errors import BfsimError, ConfigError, RecordingError, WorkError
from bfsim.loading.firmware import load_firmware
from bfsim.planning import planned
from bfsim.process.once import Known, remembering
from bfsim.report.check.baseline import Configuration
from bfsim.report.results.result import Result
from bfsim.report.results.seen_json import SeenStore
from bfsim.report.run.warnings import warnings_of
from bfsim.report.sweep.figures import sweep_figures
from bfsim.result import Run
from bfsim.run import simulate
from bfsim.running.digested_frames import recording_digest
from bfsim.trace import Identity, StallReason

PACKAGE = Path(__file__).parent.parent
"""The folder of bfsim."""

TRIED_FRAMES = 2
"""Frames of a trial."""

MOST_WAITS = 0.02
"""The greatest share of time waiting for memory outside L1, whose accesses are written, read and played word by word.

At 1.5 % (the default LDF and profile) playing pays, as above; at 45 % (l2.ldf, 4 and 12 frames, when runs were slower)
recording another frame took 1.6 times as long as running it, and playing it 0.6 times, which gains little, if anything.
Values between are not measured [assumed]: a wrong guess makes a sweep slower, but does not change its figures.
"""

Figures = Mapping[str, int | float]

_plans: dict[str, Known] = {}
"""What the points of a plan have in common, by the plan's name: only the latest plan in this process."""

_one_run = Lock()
"""Firmware is imported under names of the process, so only one of its threads may run firmware."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """The outcome of a point: the figures of its run by name, or an error in words.

    `is_final`: a new run would give the same. `frames` were done, and took `seconds`. `waits`: the share of time that
    kernels waited for memory outside L1.
    """

    identity: Identity | None = None
    frames: int = 0
    seconds: float = 0
    figures: Figures = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    error: str = ""
    is_final: bool = True
    waits: float = 0


@dataclass(frozen=True, slots=True)
class Work:
    """The place of a recorded run: it is played if it is known what was `seen` in it, and recorded otherwise.

    `is_tried`: record it only if that pays, according to a trial of the first frames.
    """

    path: Path
    seen: Figures | None = None
    is_tried: bool = False


def run_point(configuration: Configuration, folder: Path, code: str, work: Work | None = None) -> Outcome:
    """Simulate a point with paths relative to `folder`, if this bfsim's `code_digest` is `code`. Raises nothing.

    `work` comes from the same run on another board. If it can be neither recorded nor played, the point is run.
    """
    if code != code_digest():
        return Outcome(
            error="the worker must have the same bfsim as the sweep, but has another", is_final=False
        )
    began, has_begun = perf_counter(), Event()
    try:
        with _one_run:
            _plans.clear()
            arguments = {**arguments_of(configuration, folder), "before": lambda *_: has_begun.set()}
            run, figures = _played(arguments, work) or _recorded(arguments, work) or _simulated(arguments)
    except BfsimError as error:
        is_final = has_begun.is_set() and not isinstance(
            error, RecordingError
        )  # else the reason is in this machine's files
        return Outcome(error=str(error), seconds=perf_counter() - began, is_final=is_final)
    except Exception as error:  # noqa: BLE001 - one point must not end the sweep
        return Outcome(error=f"{type(error).__name__}: {error}", is_final=False)
    if run.interrupted:
        return Outcome(error="the run was interrupted", is_final=False)
    if not run.frames:
        return Outcome(error="a run must have at least one frame to report on, and this one finished none")
    return Outcome(
        identity=run.identity,
        frames=len(run.frames) + len(run.missed),
        seconds=perf_counter() - began,
        figures=figures,
        warnings=tuple(f"{each.kind}: {each.text}" for each in warnings_of(run)),
        waits=_waits(run),
    )


def run_point_there(
    configuration: Configuration, folder: Path, code: str, work: Work | None, played: bytes | None
) -> tuple[Outcome, bytes]:
    """Do the same as `run_point` on a machine without the path of `work`: get its content, or return the recorded one."""
    with TemporaryDirectory() as own:
        if work:
            work = replace(work, path=Path(own) / "run.work")
            if played is not None:
                work.path.write_bytes(played)
        outcome = run_point(configuration, folder, code, work)
        recorded = work.path.read_bytes() if work and played is None and work.path.exists() else b""
        return outcome, recorded


Arguments = Mapping[str, Any]


def _played(arguments: Arguments, work: Work | None) -> tuple[Run, Figures] | None:
    """Play a recorded run; None if there is none, or if it cannot be played. It saw the same as the recorded run."""
    if work and work.seen is not None:
        with suppress(WorkError):
            run = simulate(**arguments, work=work.path)
            return run, {**(sweep_figures(Result(run, {}, ())) if run.frames else {}), **work.seen}
    return None


def _recorded(arguments: Arguments, work: Work | None) -> tuple[Run, Figures] | None:
    """Run the firmware and record it; None if that is not wanted, or fails, for example because the disk is full."""
    if work and work.seen is None:
        trial = simulate(**{**arguments, "frames": TRIED_FRAMES}) if work.is_tried else None
        if trial and trial.interrupted:
            return trial, {}
        if trial is None or _waits(trial) <= MOST_WAITS:
            with suppress(ConfigError):
                return _simulated({**arguments, "record_work": work.path})
    return None


def _simulated(arguments: Arguments) -> tuple[Run, Figures]:
    """Run the firmware."""
    with SeenStore(with_features=False) as store:
        telling = store.add if load_firmware(arguments["firmware"]).firmware.view else None
        run = simulate(**arguments, on_seen=telling)
        return run, sweep_figures(Result(run, store, ())) if run.frames else {}


OF_MEMORY = frozenset(StallReason) - {
    StallReason.L1_CONFLICT,
    StallReason.DMA_SETUP,
    StallReason.INTERRUPT,
    StallReason.RING_EMPTY,
    StallReason.RING_FULL,
    StallReason.SEMAPHORE,
    StallReason.INTERLOCK,
}
"""The memories outside L1 that kernels wait for."""


def _waits(run: Run) -> float:
    """Return the share of time that kernels waited for memory outside L1."""
    costs = [cost for frame in run.frames for core in frame.cores for cost in core.stages]
    waits = sum(cclk for cost in costs for reason, cclk in cost.stall_cclk.items() if reason in OF_MEMORY)
    elapsed = sum(each.elapsed_cclk for each in costs)
    return waits / elapsed if elapsed else 1


def plan_point(configuration: Configuration, folder: Path, plan: str) -> tuple[Identity, int] | str:
    """Return what a point will run, without its recording's digest, and the number of frames; or why it cannot run.

    What points of the same `plan` have in common is read once per process: files must not change until all are planned.
    """
    try:
        with _one_run:
            if plan not in _plans:
                _plans.clear()
            with remembering(_plans.setdefault(plan, {})):
                return planned(**arguments_of(configuration, folder))
    except BfsimError as error:
        return str(error)
    except OSError as error:
        return f"{error.filename or 'a file'} must be accessible: {error.strerror or error}"


def digest_recording(recording: Path | None, frames: int) -> str:
    """Return the digest of a recording, as in the identity of a run; "" if it cannot be read."""
    try:
        return recording_digest(recording, frames)
    except (BfsimError, OSError):
        return ""


@cache
def code_digest(package: Path = PACKAGE) -> str:
    """Return the digest of bfsim's own code without its commands: cycles and figures depend on it."""
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*")):
        if path.suffix in {".py", ".lark"} and not path.is_relative_to(package / "cli"):
            digest.update(f"{path.relative_to(package).as_posix()}\0".encode() + path.read_bytes())
    return digest.hexdigest()
