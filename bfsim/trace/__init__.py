"""What a run leaves behind: flat records of facts. Every statistic is derived from them later, in `report/`.

Cycles are CCLK cycles counted from the start of the run. For each core and frame, always:
issue + stall + idle = elapsed.
"""

from __future__ import annotations

from bfsim.trace.assembly import Assembly, AssemblyInstruction, AssemblyLoop, SourceText
from bfsim.trace.explanation import (
    ExplainedCall,
    ExplainedLine,
    ExplainedOperation,
    Explanation,
    InlinedKernel,
)
from bfsim.trace.frames import REST, CoreFrame, FrameRecord, OwnerCost, StageCost, StallReason
from bfsim.trace.hardware import BufferRecord, CodeRecord, MemoryRecord, MessageRecord, TrafficRecord
from bfsim.trace.kernels import AccessRecord, KernelRecord, LineCost, PathRecord
from bfsim.trace.run import BoardRecord, BudgetRow, Identity, Reference, RunRecord, RunWarning, WarningKind

__all__ = [
    "REST",
    "AccessRecord",
    "Assembly",
    "AssemblyInstruction",
    "AssemblyLoop",
    "BoardRecord",
    "BudgetRow",
    "BufferRecord",
    "CodeRecord",
    "CoreFrame",
    "ExplainedCall",
    "ExplainedLine",
    "ExplainedOperation",
    "Explanation",
    "FrameRecord",
    "Identity",
    "InlinedKernel",
    "KernelRecord",
    "LineCost",
    "MemoryRecord",
    "MessageRecord",
    "OwnerCost",
    "PathRecord",
    "Reference",
    "RunRecord",
    "RunWarning",
    "SourceText",
    "StageCost",
    "StallReason",
    "TrafficRecord",
    "WarningKind",
]
