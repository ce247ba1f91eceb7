"""The costs of kernels over a run: by source line, by buffer, and by caller."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from bfsim.trace.frames import StallReason


@dataclass(frozen=True, slots=True, kw_only=True)
class LineCost:
    """One source line of a kernel: how often its first operation ran, and the cycles of all of them.

    `operations` tells how often each ran and its issue cycles, which add up to `issue_cclk`. A routine of the run-time
    library counts as one operation with the routine's name.
    """

    line: int
    executions: int
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]
    operations: Mapping[str, tuple[int, int]] = field(default_factory=dict)

    @property
    def elapsed_cclk(self) -> int:
        """Cycles of the line, including its stalls."""
        return self.issue_cclk + sum(self.stall_cclk.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class KernelRecord:
    """All calls of one kernel, direct or by another kernel, on one core in one stage, over all frames, without its callees.

    `symbol` distinguishes kernels of the same name. `file` and `LineCost.line` say where the source is; `text` has its lines,
    beginning with `first_line`. The `lines` add up to `issue_cclk` and `stall_cclk`; if code lies outside L1, the kernel's
    first line has the waits for it. `object_cclk` are the issue cycles of object code; the others are estimated.
    """

    core: str
    stage: str
    kernel: str
    symbol: str
    file: str
    first_line: int
    text: tuple[str, ...]
    calls: int
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]
    lines: tuple[LineCost, ...]
    object_cclk: int = 0

    @property
    def elapsed_cclk(self) -> int:
        """Cycles of its calls, including their stalls, without its callees."""
        return self.issue_cclk + sum(self.stall_cclk.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class AccessRecord:
    """The accesses of one line of a kernel to one buffer, over all frames: elements read and written, and the waits for them.

    `fills` are lines that the data cache fetched for it. `buffer` is empty for waits for the kernel's own code.
    """

    core: str
    stage: str
    symbol: str
    line: int
    buffer: str
    reads: int
    writes: int
    fills: int
    stall_cclk: Mapping[StallReason, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class PathRecord:
    """One path of calls: the cost of the last kernel of `path` (symbols) when called through the others, without its callees."""

    core: str
    stage: str
    path: tuple[str, ...]
    calls: int
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]
