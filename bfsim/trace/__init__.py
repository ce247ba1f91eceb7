"""The results of a run: flat records of facts. Every statistic is derived from them later, in `report/`.

Cycles are CCLK cycles counted from the start of the run. For each core and frame, always:
issue + stall + idle = elapsed. The findings of `explain` about a kernel are in `explanation` and `assembly`, which no run needs.
"""

from __future__ import annotations

from bfsim.trace.frames import NO_STAGES, REST, CoreFrame, FrameRecord, OwnerCost, StageCost, StallReason
from bfsim.trace.hardware import BufferRecord, CodeRecord, MemoryRecord, MessageRecord, TrafficRecord
from bfsim.trace.kernels import AccessRecord, KernelRecord, LineCost, PathRecord
from bfsim.trace.later import Later
from bfsim.trace.run import (
    DIGITS_SHOWN,
    BoardRecord,
    BudgetRow,
    Identity,
    Reference,
    RunRecord,
    RunWarning,
    WarningKind,
)

__all__ = [
    "DIGITS_SHOWN",
    "NO_STAGES",
    "REST",
    "AccessRecord",
    "BoardRecord",
    "BudgetRow",
    "BufferRecord",
    "CodeRecord",
    "CoreFrame",
    "FrameRecord",
    "Identity",
    "KernelRecord",
    "Later",
    "LineCost",
    "MemoryRecord",
    "MessageRecord",
    "OwnerCost",
    "PathRecord",
    "Reference",
    "RunRecord",
    "RunWarning",
    "StageCost",
    "StallReason",
    "TrafficRecord",
    "WarningKind",
]
