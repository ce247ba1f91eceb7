"""The result of a run, just made or read back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.report.budget.owners import OwnerFrames, owner_frames
from bfsim.trace import RunRecord


@dataclass(frozen=True, slots=True)
class Result:
    """A run; by the frame's index what was seen in it (`seen_json`), nothing where the firmware has no view; and whose the cycles were.

    What was read from a file has its `owners` here alone, and not in the frames of the run.
    """

    run: RunRecord
    seen: Mapping[int, Mapping[str, Any]]
    owners: Sequence[OwnerFrames]


def result_of(run: RunRecord, seen: Mapping[int, Mapping[str, Any]]) -> Result:
    """Return a run that has just been made as a result."""
    return Result(run, seen, tuple(owner_frames(run)))
