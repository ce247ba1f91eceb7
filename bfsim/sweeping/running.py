"""What becomes of one point, wherever it runs. These functions are called in worker processes, here and on other machines."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from threading import Event, Lock
from time import perf_counter
from typing import Any

from bfsim.checking import arguments_of
from bfsim.errors import BfsimError, RecordingError, WorkError
from bfsim.identifying import recording_digest
from bfsim.report.check.baseline import Configuration
from bfsim.report.result_file import Result
from bfsim.report.save import write_text
from bfsim.report.seen_json import SeenStore
from bfsim.report.sweep.figures import SEEN, sweep_figures
from bfsim.report.warnings import warnings_of
from bfsim.result import Run
from bfsim.run import has_view, planned, simulate
from bfsim.trace import Identity, StallReason

Figures = Mapping[str, int | float]

_one_run = Lock()
"""Firmware is imported under names of the process: of a process's threads only one may run it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What became of a point: the figures of its run by name, or in words why there are none.

    `is_final`: it would become the same again. `frames` are those that were done, and `seconds` what that took.
    """

    identity: Identity | None = None
    frames: int = 0
    seconds: float = 0
    figures: Figures = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    error: str = ""
    is_final: bool = True


def run_point(configuration: Configuration, folder: Path, code: str, work: Path | None = None) -> Outcome:
    """Simulate a point whose paths are relative to `folder`, by a bfsim whose `code_digest` is `code`. Raises nothing.

    `work` is the place of a recorded run of the same on another board: it is played if it is there, or made if that pays.
    """
    if code != code_digest():
        return Outcome(
            error="the worker must have the same bfsim as the sweep, but has another", is_final=False
        )
    began, has_begun = perf_counter(), Event()
    try:
        with _one_run:
            arguments = {**arguments_of(configuration, folder), "before": lambda *_: has_begun.set()}
            run, figures = _played(arguments, work) or _simulated(arguments, work)
    except BfsimError as error:
        is_final = has_begun.is_set() and not isinstance(
            error, RecordingError
        )  # else it is this machine's files
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
    )


def _played(arguments: Mapping[str, Any], work: Path | None) -> tuple[Run, Figures] | None:
    """Play a recorded run; None if there is none, or it cannot be played. What was seen is what the recorded run saw."""
    seen = _seen_with(work) if work and work.exists() else None
    if seen is not None:
        with suppress(WorkError):
            run = simulate(**arguments, work=work)
            return run, {**(sweep_figures(Result(run, {}, ())) if run.frames else {}), **seen}
    return None


def _simulated(arguments: Mapping[str, Any], work: Path | None) -> tuple[Run, Figures]:
    """Run the firmware. The first run with a place for its work tells whether recording pays, and the next one is recorded."""
    record_work = work if work and _seen_with(work) is not None and not work.exists() else None
    with SeenStore(with_features=False) as store:
        telling = store.add if has_view(arguments["firmware"]) else None
        run = simulate(**arguments, on_seen=telling, record_work=record_work)
        figures = sweep_figures(Result(run, store, ())) if run.frames else {}
    if work and not record_work:
        seen = {name: value for name, value in figures.items() if name.startswith(SEEN)}
        write_text(_beside(work), json.dumps(seen if _pays(run) else None))
    return run, figures


MOST_WAITS = 0.02
"""Of the time [assumed]: measured, playing is 2.8 times as fast as running with 0.6 %, and half as fast with 45 %."""

OF_MEMORY = frozenset(StallReason) - {
    StallReason.L1_CONFLICT,
    StallReason.DMA_SETUP,
    StallReason.INTERRUPT,
    StallReason.RING_EMPTY,
    StallReason.RING_FULL,
    StallReason.SEMAPHORE,
    StallReason.INTERLOCK,
}
"""What kernels wait for outside of L1."""


def _pays(run: Run) -> bool:
    """Whether playing is sooner than running: not where kernels read much outside of L1, where each access is recorded."""
    costs = [cost for frame in run.frames for core in frame.cores for cost in core.stages]
    waits = sum(cclk for cost in costs for reason, cclk in cost.stall_cclk.items() if reason in OF_MEMORY)
    return all(each.in_l1 for each in run.code) and waits <= MOST_WAITS * sum(
        each.elapsed_cclk for each in costs
    )


def _seen_with(work: Path) -> Figures | None:
    """Return what a run of this work saw; None if there was none yet, or recording does not pay."""
    try:
        seen = json.loads(_beside(work).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return seen if isinstance(seen, dict) else None


def _beside(work: Path) -> Path:
    return work.with_suffix(".json")


def plan_point(configuration: Configuration, folder: Path) -> tuple[Identity, int] | str:
    """Return what a point will run, without the digest of its recording, and how many frames; or in words why it cannot."""
    try:
        with _one_run:
            return planned(**arguments_of(configuration, folder))
    except BfsimError as error:
        return str(error)
    except OSError as error:
        return f"{error.filename or 'a file'} must be accessible: {error.strerror or error}"


def digest_recording(recording: Path | None, frames: int) -> str:
    """Return the digest of a recording, as in the identity of a run; empty where it cannot be read."""
    try:
        return recording_digest(recording, frames)
    except (BfsimError, OSError):
        return ""


@cache
def code_digest() -> str:
    """Return the digest of bfsim's own code, without that of its commands: cycles and figures depend on it."""
    package = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*")):
        if path.suffix in {".py", ".lark"} and not path.name.startswith("cli"):
            digest.update(f"{path.relative_to(package).as_posix()}\0".encode() + path.read_bytes())
    return digest.hexdigest()
