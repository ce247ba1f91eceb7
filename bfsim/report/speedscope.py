"""Where the cycles went as a flame graph that https://www.speedscope.app opens: a profile for each core, its weights in cycles.

A stack is the stage, within the one that it is a part of, and the kernel; beside the kernels stand the waits of the stage by
reason, its other work and its idle time, so that each stage is as wide as its row of the budget.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator

from bfsim import __version__
from bfsim.report.budget import budget_rows
from bfsim.trace import RunRecord, StageCost

SCHEMA = "https://www.speedscope.app/file-format-schema.json"
OTHER_WORK, IDLE = "other work", "idle"

Stack = tuple[str, ...]


def stacks_of(run: RunRecord, core: str) -> dict[Stack, int]:
    """Return the cycles of one core over all frames, by stage and what it did there."""
    within = {row.stage: row.within for row in budget_rows(run) if row.within}
    sums: Counter[Stack] = Counter()
    issued: Counter[str] = Counter()
    for record in run.kernels:
        if record.core == core and record.issue_cclk:
            sums[record.stage, record.kernel] += record.issue_cclk
            issued[record.stage] += record.issue_cclk
    for cost in _costs(run, core):
        sums[cost.stage, OTHER_WORK] += cost.issue_cclk
        sums[cost.stage, IDLE] += cost.idle_cclk
        for reason, cclk in cost.stall_cclk.items():
            sums[cost.stage, reason.value] += cclk
    for stage, cclk in issued.items():
        sums[stage, OTHER_WORK] -= cclk
    return {
        (*((within[stage],) if stage in within else ()), stage, what): cclk
        for (stage, what), cclk in sums.items()
        if cclk > 0
    }


def _costs(run: RunRecord, core: str) -> Iterator[StageCost]:
    for frame in run.frames:
        for each in frame.cores:
            if each.core == core:
                yield from each.stages


def speedscope_json(run: RunRecord) -> str:
    """Return the file's text."""
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
    places = {record.kernel: {"file": record.file, "line": record.first_line} for record in run.kernels}
    identity = run.identity
    content = {
        "$schema": SCHEMA,
        "exporter": f"bfsim {__version__}",
        "name": f"{identity.firmware} on {identity.recording}",
        "shared": {"frames": [{"name": name, **places.get(name, {})} for name in frames]},
        "profiles": profiles,
    }
    return json.dumps(content, ensure_ascii=False, separators=(",", ":")) + "\n"
