"""Measurements of runs: how often each core accesses each buffer, and how long it waits for it there."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field

from bfsim.placing.stretches import LEVELS, Level
from bfsim.report.budget.budget import budget_of
from bfsim.report.budget.times import frame_rate_hz
from bfsim.report.budget.waits import busy_cclk
from bfsim.trace import RunRecord

CODE = ""
"""Stands for the buffer when a kernel waits for its own code."""


@dataclass(slots=True)
class Accesses:
    """What one core does with one buffer in a frame."""

    reads: float = 0
    writes: float = 0


Use = tuple[str, str]
"""A core, and the buffer by its name in the records or the kernel by its symbol."""


@dataclass(slots=True)
class Measured:
    """Of the last run: `accesses`, issue cycles of kernels, `streamed` buffers, each core's cycles without stalls.

    `stalls`: cycles a frame that a core waited for a buffer in a memory, from the last run that had the buffer there;
    `fetches`: the same for a kernel's code.
    """

    accesses: dict[Use, Accesses] = field(default_factory=dict)
    issue_cclk: dict[Use, float] = field(default_factory=dict)
    streamed: frozenset[str] = frozenset()
    busy_cclk: dict[str, float] = field(default_factory=dict)
    stalls: dict[tuple[Use, Level], float] = field(default_factory=dict)
    fetches: dict[tuple[Use, Level], float] = field(default_factory=dict)

    def add(self, run: RunRecord, code_levels: Mapping[Use, Level]) -> None:
        """Add the measurements of a run. `code_levels`: where the code of each kernel lay."""
        frames = len(run.frames)
        level_of = {each.buffer: _level(each.memory) for each in run.buffers}
        accesses: dict[Use, Accesses] = defaultdict(Accesses)
        stalls, fetches, issue = (defaultdict[Use, float](float) for _ in range(3))
        for each in run.accesses:
            cclk = sum(each.stall_cclk.values()) / frames
            if each.buffer == CODE:
                fetches[each.core, each.symbol] += cclk
                continue
            use = each.core, each.buffer
            accesses[use].reads += each.reads / frames
            accesses[use].writes += each.writes / frames
            stalls[use] += cclk
        for kernel in run.kernels:
            issue[kernel.core, kernel.symbol] += kernel.issue_cclk / frames
        self.accesses, self.issue_cclk = dict(accesses), dict(issue)
        self.streamed = frozenset(each.buffer for each in run.traffic if not each.master.startswith("core"))
        self.stalls |= {(use, level_of[use[1]]): stalls[use] for use in accesses}
        self.fetches |= {(use, level): fetches[use] for use, level in code_levels.items()}
        self.busy_cclk = busy_of(run)
        for use, cclk in (*stalls.items(), *fetches.items()):
            self.busy_cclk[use[0]] -= cclk


def busy_of(run: RunRecord) -> dict[str, float]:
    """Return each core's cycles a frame without its waits for pictures and for the other core."""
    return {each.core: busy_cclk([each.frame]) / len(run.frames) for each in budget_of(run).cores}


def frame_cclk(run: RunRecord) -> float:
    """Return the mean number of cycles from the end of one frame to the end of the next."""
    return run.identity.cclk_hz / frame_rate_hz(run.frames, run.identity.cclk_hz)


def _level(memory: str) -> Level:
    """Return the level of a memory by its full name, such as COREA_L1_DATA_A."""
    return LEVELS[memory if memory in LEVELS else memory.partition("_")[2]]
