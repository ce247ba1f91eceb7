"""The rows of each table of a run: their cells by the names of their columns. A row of traffic is a `TrafficRecord`.

Cycles are CCLK cycles; each column has one unit, which is in its name.
"""

from __future__ import annotations

from typing import NamedTuple


class FrameCells(NamedTuple):
    """One stereo frame, from the end of the one before to the end of its last core."""

    frame: int
    begin_cclk: int
    end_cclk: int
    elapsed_ms: float
    latency_ms: float
    remarks: str


class ResultCells(NamedTuple):
    """A number that the firmware published for a frame."""

    frame: int
    result: str
    value: int


class StageCells(NamedTuple):
    """What a stage cost a core in a frame: issue + stall + idle = elapsed."""

    frame: int
    core: str
    stage: str
    issue_cclk: int
    stall_cclk: int
    idle_cclk: int
    elapsed_cclk: int
    elapsed_ms: float


class StallCells(NamedTuple):
    """How long a core stalled in a stage of a frame, for one reason."""

    frame: int
    core: str
    stage: str
    reason: str
    stall_cclk: int


class KernelCells(NamedTuple):
    """All calls of a kernel by a core in a stage, without the kernels that it calls."""

    core: str
    stage: str
    kernel: str
    file: str
    first_line: int
    calls: int
    issue_cclk: int
    stall_cclk: int


class OwnerCells(NamedTuple):
    """What an owner cost a core in a stage of a frame: a kernel without its callees, or something else (no `symbol`)."""

    frame: int
    core: str
    stage: str
    owner: str
    symbol: str
    calls: int
    issue_cclk: int
    stall_cclk: int
    idle_cclk: int


class AccessCells(NamedTuple):
    """What a line of a kernel accessed in a buffer, and how long it waited for the buffer."""

    core: str
    stage: str
    kernel: str
    line: int
    buffer: str
    memory: str
    reads: int
    writes: int
    fills: int
    stall_cclk: int


class PathCells(NamedTuple):
    """What a kernel cost when called through others, outermost first, without its own callees."""

    core: str
    stage: str
    path: str
    calls: int
    issue_cclk: int
    stall_cclk: int


class LineCells(NamedTuple):
    """A source line of a kernel; its stalls are added up."""

    core: str
    stage: str
    kernel: str
    file: str
    line: int
    text: str
    executions: int
    issue_cclk: int
    stall_cclk: int


class BufferCells(NamedTuple):
    """A buffer that was used: accesses by kernels, bytes and SDRAM pages of all masters on its bus, and waits for it."""

    buffer: str
    memory: str
    nbytes: int
    reads: int
    writes: int
    fills: int
    core_bytes: int
    dma_bytes: int
    page_hits: int
    page_misses: int
    page_conflicts: int
    stall_cclk: int


class SpanCells(NamedTuple):
    """A span of the timeline (`bfsim.spans`), its stalls added up."""

    kind: str
    where: str
    name: str
    stage: str
    begin_cclk: int
    end_cclk: int
    issue_cclk: int
    stall_cclk: int
    value: int
    flow: int
    first_row: int | None
    last_row: int | None
    first_column: int | None
    last_column: int | None
