"""The result of a run, just made or read back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.report.budget.owners import OwnerFrames, owner_frames
from bfsim.trace import RunRecord


@dataclass(frozen=True, slots=True)
class Result:
    """A run, what was seen in each frame by index (`seen_json`; nothing without a view), and the owners of its cycles.

    If it was read from a file, its `owners` are only here, and not in the frames of the run.
    """

    run: RunRecord
    seen: Mapping[int, Mapping[str, Any]]
    owners: Sequence[OwnerFrames]


def result_of(run: RunRecord, seen: Mapping[int, Mapping[str, Any]]) -> Result:
    """Return a run that has just been made as a result."""
    return Result(run, seen, tuple(owner_frames(run)))
