"""Where the cycles went as a flame graph for https://www.speedscope.app: a profile for each core, weighted by cycles.

A stack is the stage, within the one that it is part of, then the kernel and its callees, or other work of the core: a
ring, a semaphore, an interrupt. Waits stand below their owner, by reason. Each stage is as wide as its row of the
budget.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping

from bfsim import __version__
from bfsim.report.budget.rows import budget_rows
from bfsim.trace import OwnerCost, RunRecord, StallReason

SCHEMA = "https://www.speedscope.app/file-format-schema.json"
IDLE = "idle"

Stack = tuple[str, ...]


def stacks_of(run: RunRecord, core: str) -> dict[Stack, int]:
    """Return the cycles of one core over all frames, by stage and activity; kernels are named by their symbols."""
    within = {row.stage: (row.within,) for row in budget_rows(run) if row.within}
    sums: Counter[Stack] = Counter()

    def add(stack: Stack, issue_cclk: int, stall_cclk: Mapping[StallReason, int], idle_cclk: int = 0) -> None:
        sums[stack] += issue_cclk
        sums[*stack, IDLE] += idle_cclk
        for reason, cclk in stall_cclk.items():
            sums[*stack, reason.value] += cclk

    for path in run.paths:
        if path.core == core:
            add((*within.get(path.stage, ()), path.stage, *path.path), path.issue_cclk, path.stall_cclk)
    for cost in _of_no_kernel(run, core):
        stack = (*within.get(cost.stage, ()), cost.stage, cost.owner)
        add(stack, cost.issue_cclk, cost.stall_cclk, cost.idle_cclk)
    return +sums


def _of_no_kernel(run: RunRecord, core: str) -> Iterator[OwnerCost]:
    for frame in run.frames:
        for each in frame.cores:
            if each.core == core:
                yield from (cost for cost in each.owners if not cost.symbol)


def speedscope_json(run: RunRecord) -> str:
    """Return the text of the file."""
    frames: dict[str, int] = {}
    profiles = []
    for core in (each.core for each in run.frames[0].cores):
        stacks = stacks_of(run, core)
        profiles.append(
            {
                "type": "sampled",
                "name": f"core {core}, cycles",
                "unit": "none",
                "startValue": 0,
                "endValue": sum(stacks.values()),
                "samples": [[frames.setdefault(each, len(frames)) for each in stack] for stack in stacks],
                "weights": list(stacks.values()),
            }
        )
    kernels = {
        record.symbol: {"name": record.kernel, "file": record.file, "line": record.first_line}
        for record in run.kernels
    }
    identity = run.identity
    content = {
        "$schema": SCHEMA,
        "exporter": f"bfsim {__version__}",
        "name": f"{identity.firmware} on {identity.recording}",
        "shared": {"frames": [kernels.get(each, {"name": each}) for each in frames]},
        "profiles": profiles,
    }
    return json.dumps(content, ensure_ascii=False, separators=(",", ":")) + "\n"
