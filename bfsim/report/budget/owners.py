"""Whose cycles those of a run are, frame by frame."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from bfsim.report.budget.waits import waiting_cclk
from bfsim.trace import OwnerCost, RunRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnerFrames:
    """An owner of cycles in a stage of a core, named as in `OwnerCost`, with a number for each frame of the run.

    `waiting_cclk` are those of the elapsed cycles in which the core only waited for the other core or for the cameras.
    """

    core: str
    stage: str
    owner: str
    symbol: str
    calls: tuple[int, ...]
    elapsed_cclk: tuple[int, ...]
    waiting_cclk: tuple[int, ...]


def owner_frames(run: RunRecord) -> Iterator[OwnerFrames]:
    """Yield all owners of a run, core by core."""
    found: dict[tuple[str, str, str, str], dict[int, OwnerCost]] = {}
    for number, frame in enumerate(run.frames):
        for core in frame.cores:
            for each in core.owners:
                found.setdefault((core.core, each.stage, each.owner, each.symbol), {})[number] = each
    for (core_name, stage, owner, symbol), costs in found.items():
        in_frames = [costs.get(number) for number in range(len(run.frames))]
        yield OwnerFrames(
            core=core_name,
            stage=stage,
            owner=owner,
            symbol=symbol,
            calls=tuple(each.calls if each else 0 for each in in_frames),
            elapsed_cclk=tuple(each.elapsed_cclk if each else 0 for each in in_frames),
            waiting_cclk=tuple(waiting_cclk(each) if each else 0 for each in in_frames),
        )
