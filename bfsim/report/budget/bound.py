"""What bounds the frame rate: where the core that waits least spends most of its time."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

from bfsim.report.budget.budget import Budget, CoreBudget, StageRow
from bfsim.report.budget.waits import busy_cclk, other_core_cclk


class Cause(Enum):
    """What a core spends its time on."""

    STAGE = auto()
    PICTURES = auto()
    OTHER_CORE = auto()


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """The `cause` that takes most of `core`: `cclk` over all frames. `row` is the stage, if the cause is one."""

    core: CoreBudget
    cause: Cause
    cclk: int
    row: StageRow | None = None


def bound_of(budget: Budget) -> Bound:
    """Return what bounds the frame rate of a run.

    The core that waits least for pictures and for the other core decides; its longest stage or wait is the bound. Waits
    for memory and DMA belong to the stage in which they occur.
    """
    core = max(budget.cores, key=lambda each: busy_cclk([each.frame]))
    found = [
        Bound(core=core, cause=Cause.STAGE, row=row, cclk=busy_cclk([row]))
        for row in core.rows
        if row.within is None
    ]
    frame = core.frame
    found += [
        Bound(core=core, cause=Cause.PICTURES, cclk=frame.idle_cclk),
        Bound(core=core, cause=Cause.OTHER_CORE, cclk=other_core_cclk(frame)),
    ]
    return max(found, key=lambda each: each.cclk)
