"""Baselines for the tests of `bfsim check`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from bfsim.report.check.baseline import Case
from bfsim.report.check.baseline_file import read_baseline
from bfsim.report.check.judge import judge
from bfsim.report.check.update import updated, write_cases
from bfsim.report.check.verdicts import Outcome
from bfsim.report.results.result import Result, result_of
from bfsim.trace import MemoryRecord, RunRecord


def result(run: RunRecord, *objects: Sequence[str]) -> Result:
    """Give a run what is seen in each of its frames, if anything is said of it."""
    seen = {
        each.index: {"objects": [seen_object(name) for name in names]}
        for each, names in zip(run.frames, objects, strict=False)
    }
    return result_of(run, seen)


def seen_object(name: str, distance_mm: int = 300) -> dict[str, object]:
    """What `seen_json` has of an object; one at no distance is known by its direction alone."""
    return {"name": name, "is_direction": not distance_mm, "age_frames": 0, "place_mm": [0, 0, distance_mm]}


def measured(path: Path, run: RunRecord | Result, reason: str = "because", **changes: object) -> Case:
    """Make the numbers of a run the limits of "drive" in a file; `changes` are of what a person writes there."""
    before = {case.name: case for case in read_baseline(path).run} if path.exists() else {}
    case = before.get("drive", Case(name="drive")).model_copy(update=changes)
    write_cases(path, {"drive": updated(case, _result(run), reason, path)})
    return read_baseline(path).run[0]


def hold(run: RunRecord | Result, path: Path) -> Outcome:
    """Hold a run against "drive" in a file."""
    return judge(read_baseline(path).run[0], _result(run), path)


def _result(run: RunRecord | Result) -> Result:
    return run if isinstance(run, Result) else result(run)


def broken(outcome: Outcome) -> list[str]:
    """The sentences that are broken, without their numbers."""
    return [each.requirement.text.partition("=")[0].rstrip("< >=") for each in outcome.broken]


def with_results(run: RunRecord, *results: Mapping[str, int]) -> RunRecord:
    """Give each frame of a run its results."""
    frames = (replace(frame, results=each) for frame, each in zip(run.frames, results, strict=True))
    return replace(run, frames=tuple(frames))


def with_memory(run: RunRecord, used_bytes: int) -> RunRecord:
    """Say how much of 128 KB of L2 a run takes."""
    return replace(run, memories=(MemoryRecord(memory="L2", nbytes=131_072, used_bytes=used_bytes),))


def replace_in(path: Path, old: str, new: str) -> None:
    """Edit a file as its owner would; what is to be replaced must be there."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
