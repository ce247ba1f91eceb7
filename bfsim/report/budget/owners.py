"""The owners of a run's cycles, frame by frame."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.trace import RunRecord, StallReason
from bfsim.trace.owner_costs import CALLS, COLUMN_OF, IDLE, Owner, OwnerCosts, OwnerNumbers

WAITING = [IDLE, COLUMN_OF[StallReason.SEMAPHORE]]
"""Columns of cycles in which a core only waited (`waits.waiting_cclk`)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnerFrames:
    """An owner of cycles in a stage of a core, named as in `OwnerCost`, with a number for each frame of the run.

    `waiting_cclk` are the elapsed cycles in which the core only waited for the other core or for the cameras.
    """

    core: str
    stage: str
    owner: str
    symbol: str
    calls: tuple[int, ...]
    elapsed_cclk: tuple[int, ...]
    waiting_cclk: tuple[int, ...]


class _CoreOwners:
    """The owners of one core, and their numbers frame by frame."""

    def __init__(self) -> None:
        self._numbers = OwnerNumbers()
        self._parts: list[tuple[NDArray[Any], ...]] = []  # owner, frame, column and amount

    def add(self, place: int, costs: OwnerCosts) -> list[Owner]:
        """Add a frame; return its new owners."""
        known = len(self._numbers.owners)
        owners = self._numbers.of(costs)
        _, columns, amounts = costs.numbers()
        self._parts.append((owners, np.full(len(owners), place), columns, amounts))
        return list(islice(self._numbers.owners, known, None))

    def in_frames(self, frames: int) -> dict[Owner, tuple[list[int], ...]]:
        """Return calls, elapsed and waiting cycles of each owner in each of `frames` frames."""
        owners, places, columns, amounts = map(np.concatenate, zip(*self._parts, strict=True))
        tables = []
        for kind in (columns == CALLS, columns != CALLS, np.isin(columns, WAITING)):
            table = np.zeros((len(self._numbers.owners), frames), np.int64)
            np.add.at(table, (owners[kind], places[kind]), amounts[kind])
            tables.append(table.tolist())
        return dict(zip(self._numbers.owners, zip(*tables, strict=True), strict=True))


def owner_frames(run: RunRecord) -> Iterator[OwnerFrames]:
    """Yield all owners of a run in order of appearance, core by core in each frame."""
    cores = {core.core: _CoreOwners() for frame in run.frames for core in frame.cores}
    found = [
        (core.core, owner)
        for place, frame in enumerate(run.frames)
        for core in frame.cores
        for owner in cores[core.core].add(place, OwnerCosts.of(core.owners))
    ]
    in_frames = {name: core.in_frames(len(run.frames)) for name, core in cores.items()}
    for core_name, owner in found:
        calls, elapsed_cclk, waiting_cclk = map(tuple, in_frames[core_name][owner])
        yield OwnerFrames(
            core=core_name,
            stage=owner.stage,
            owner=owner.name,
            symbol=owner.symbol,
            calls=calls,
            elapsed_cclk=elapsed_cclk,
            waiting_cclk=waiting_cclk,
        )
