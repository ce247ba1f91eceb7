"""What a run leaves behind: flat records of facts. Every statistic is derived from them later, in `report/`.

Cycles are CCLK cycles counted from the start of the run. For each core and frame, always:
issue + stall + idle = elapsed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

REST = "(the rest)"
"""The row of everything that a core does outside of a stage."""


class StallReason(StrEnum):
    """Why a core did not retire work although it had work to do."""

    L1_CONFLICT = "L1 conflict"
    L2_LATENCY = "L2 latency"
    L2_PORT = "L2 port"
    SDRAM_PAGE_HIT = "SDRAM page hit"
    SDRAM_PAGE_MISS = "SDRAM page miss"
    SDRAM_PAGE_CONFLICT = "SDRAM page conflict"
    SDRAM_REFRESH = "SDRAM refresh"
    EBIU_ARBITRATION = "EBIU arbitration"
    STORE_BUFFER = "store buffer full"
    CACHE_FILL = "cache fill"
    CODE_FETCH = "code fetch"
    DMA_SETUP = "DMA set-up"
    INTERRUPT = "interrupt"
    RING_EMPTY = "ring empty"
    RING_FULL = "ring full"
    SEMAPHORE = "semaphore"
    INTERLOCK = "interlocks"


@dataclass(frozen=True, slots=True, kw_only=True)
class StageCost:
    """What one stage cost one core in one frame. A stall of no cycles is left out of `stall_cclk`."""

    stage: str
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]
    idle_cclk: int

    @property
    def elapsed_cclk(self) -> int:
        """Cycles from first to last, whatever the core did in them."""
        return self.issue_cclk + sum(self.stall_cclk.values()) + self.idle_cclk


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnerCost:
    """What one owner cost one core in one stage of one frame: a kernel without its callees, or something that no kernel does.

    `symbol` is the kernel's in the machine code (`KernelRecord`); it is empty for a ring, a semaphore, an interrupt, the
    cameras ..., which `owner` then names. A stall of no cycles is left out of `stall_cclk`.
    """

    stage: str
    owner: str
    symbol: str
    calls: int
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]
    idle_cclk: int

    @property
    def elapsed_cclk(self) -> int:
        """Cycles from first to last, whatever the core did in them."""
        return self.issue_cclk + sum(self.stall_cclk.values()) + self.idle_cclk


@dataclass(frozen=True, slots=True, kw_only=True)
class CoreFrame:
    """One frame on one core, from the end of the frame before to its own end; the stages fill it exactly.

    The `owners` of each stage fill that exactly: issue, each reason of a stall, and idle.
    """

    core: str
    begin_cclk: int
    end_cclk: int
    stages: tuple[StageCost, ...]
    owners: Sequence[OwnerCost] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameRecord:
    """One stereo frame. `index` counts in the recording; latency runs from `last_line_cclk` to `result_cclk`.

    `cores` holds core A first. `results` are numbers that the firmware published for the frame (edges found ...),
    `remarks` its sentences (an order refused ...).
    """

    index: int
    last_line_cclk: int
    result_cclk: int
    cores: tuple[CoreFrame, ...]
    results: Mapping[str, int]
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class LineCost:
    """One source line of a kernel: how often its first operation ran, and the cycles of all of them.

    `operations` are how often each ran and its issue cycles, which add up to `issue_cclk`; those of a routine of the run-time
    library have the routine's name.
    """

    line: int
    executions: int
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]
    operations: Mapping[str, tuple[int, int]] = field(default_factory=dict)

    @property
    def elapsed_cclk(self) -> int:
        """Cycles of the line, its stalls included."""
        return self.issue_cclk + sum(self.stall_cclk.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class KernelRecord:
    """All calls of one kernel (or of a kernel called by it) by one core in one stage, over all frames, without its callees.

    `symbol` tells kernels of one name apart. `file` and `LineCost.line` say where the source is; `text` holds its lines, the
    first one being `first_line`. The `lines` add up to `issue_cclk` and `stall_cclk`; where code lies outside L1, the kernel's
    first line has the waits for it.
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

    @property
    def elapsed_cclk(self) -> int:
        """Cycles of its calls, their stalls included, without its callees."""
        return self.issue_cclk + sum(self.stall_cclk.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class AccessRecord:
    """What one line of a kernel accessed in one buffer, over all frames: elements that it read and wrote, and what it waited for them.

    `fills` are lines that the data cache fetched for it. `buffer` is empty where the kernel's own code was waited for.
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
    """One path of calls: what the last kernel of `path` (symbols) cost when called through the others, without its own callees."""

    core: str
    stage: str
    path: tuple[str, ...]
    calls: int
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class BufferRecord:
    """A buffer of the firmware, and where it lies. `core` is that which declares it, or "shared".

    `buffer` is the name that other records have for it: its own, and that of the core behind it where both declare one.
    """

    buffer: str
    core: str
    memory: str
    address: int
    nbytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class TrafficRecord:
    """What one master moved to and from one buffer over the whole run, over a bus; a core's accesses of L1 are not among it.

    `memory` is where the buffer lies; `buffer` is empty for what is in no buffer, such as code and semaphores. `master` is a core,
    an MDMA stream or a PPI; a DMA transfer counts for the buffers that it begins in. The page counts are zero for memories
    without pages. `busy_cclk` is how long it held the memory's bus, in CCLK cycles.
    """

    memory: str
    buffer: str
    master: str
    read_bytes: int
    written_bytes: int
    page_hits: int
    page_misses: int
    page_conflicts: int
    busy_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """Measurements from elsewhere that the budget stands beside, such as those of a real board.

    `name` heads their column in the report, `about` says in one sentence what they are and where they come from.
    """

    name: str
    about: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BudgetRow:
    """A row of the budget: a stage of the firmware, and its milliseconds in the firmware's `Reference`, if they are known.

    `within` is the stage that this one is a part of; its row holds the cycles of its parts too. One level is all.
    """

    stage: str
    reference_ms: float | None = None
    within: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Identity:
    """All that a result depends on. Digests are sha256 in hex, or empty.

    `..._numbers` say of a board or compiler that is not shipped which shipped one it is like, and what it has otherwise.
    Paths are left out on purpose: `..._files` are relative to the folder that they were imported from; a shipped board or
    compiler has none. `board` ends in --set PATH=VALUE for each number that was changed.
    """

    recording: str
    recording_digest: str
    firmware: str
    firmware_digest: str
    firmware_files: tuple[str, ...]
    board: str
    board_digest: str
    ldf: str
    ldf_digest: str
    compiler: str
    feed: str
    script_digest: str
    fidelity: str
    bfsim_version: str
    llvm_version: str
    cclk_hz: float
    sclk_hz: float
    width_px: int
    height_px: int
    compiler_digest: str = ""
    board_files: tuple[str, ...] = ()
    compiler_files: tuple[str, ...] = ()
    board_numbers: tuple[str, ...] = ()
    compiler_numbers: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeRecord:
    """Code of one core's kernels in one segment of the LDF: how many kernels, their bytes, and what the segment has left.

    Without `in_l1`, fetches take cycles that are not in the kernels' costs.
    """

    core: str
    segment: str
    in_l1: bool
    kernels: int
    nbytes: int
    free_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MemoryRecord:
    """One memory of the chip, such as L2 or COREA_L1_DATA_A: its size, and what code, buffers and reserves take of it."""

    memory: str
    nbytes: int
    used_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageRecord:
    """One message over SPI: `direction` is out or in, seen from the board; the cycles are of core A's clock.

    `type` is what the device calls it. Where the firmware's buffer had no room for all of it, "(cut short)" follows.
    """

    direction: str
    type: str
    nbytes: int
    begin_cclk: int
    end_cclk: int


class WarningKind(StrEnum):
    """What a warning is about."""

    GEOMETRY = "geometry"
    CLOCKS = "clocks"
    MISSED = "missed frames"
    DEVICE = "SPI device"
    LOST = "lost"


@dataclass(frozen=True, slots=True, kw_only=True)
class RunWarning:
    """Something about a run that must not be overlooked, and the numbers in its text. `result` is the published number, if it is of one."""

    kind: WarningKind
    text: str
    numbers: Mapping[str, int] = field(default_factory=dict)
    result: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRecord:
    """One run. `messages` went over SPI; `interrupts` were taken, by core and source. `missed` are the recording's frames that came while the firmware was busy.

    `firmware_place` is the file that was named as firmware, or "built in"; `ldf_place` is the LDF's, or "shipped".
    `device_notes` are what the device on the SPI had to say when the run was over.
    `reference` says what the `reference_ms` of `rows` are, None where the firmware has no reference.
    `geometry` says where the firmware takes the cameras to be, and whether the recording said so; it is empty for firmware
    that does not ask. `assumptions` are warnings of what was not given and had to be assumed; `losses` say in words what those published
    numbers count that the firmware lost.
    When `interrupted` by Ctrl-C, `traffic` also holds what was moved of the frame that was not finished.
    """

    identity: Identity
    firmware_place: str
    ldf_place: str
    rows: tuple[BudgetRow, ...]
    reference: Reference | None
    frames: tuple[FrameRecord, ...]
    missed: tuple[int, ...]
    interrupted: bool
    kernels: tuple[KernelRecord, ...]
    accesses: tuple[AccessRecord, ...]
    paths: tuple[PathRecord, ...]
    buffers: tuple[BufferRecord, ...]
    traffic: tuple[TrafficRecord, ...]
    code: tuple[CodeRecord, ...]
    messages: tuple[MessageRecord, ...]
    device_notes: tuple[str, ...]
    geometry: str
    assumptions: tuple[RunWarning, ...]
    losses: Mapping[str, str]
    interrupts: Mapping[str, int]
    events: int
    memories: tuple[MemoryRecord, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainedOperation:
    """An operation of a source line: `count` of them, `cclk` issue cycles each; `conditional`: one way of a branch."""

    operation: str
    mnemonic: str
    count: int
    cclk: int
    conditional: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainedLine:
    """The part of one source line that stands in `depth` loops, and its cycles per execution, interlocks included.

    `stall_cclk` are the interlocks alone. `executions` and `total_cclk` are those of a run, at all depths together, and
    stand in the line's last row; None without a run.
    """

    line: int
    text: str
    depth: int
    operations: tuple[ExplainedOperation, ...]
    least_cclk: int
    most_cclk: int
    stall_cclk: int
    executions: int | None
    total_cclk: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainedCall:
    """Calls of `callee` in one line: whether its code takes their place, and why or why not.

    `growth` is by how many statements, as the compiler counts them, the caller's code grows or would grow for each.
    """

    caller: str
    file: str
    line: int
    callee: str
    inlined: bool
    why: str
    growth: int


@dataclass(frozen=True, slots=True, kw_only=True)
class InlinedKernel:
    """A kernel whose code stands in that of another one: its lines there, at all its calls together."""

    kernel: str
    file: str
    lines: tuple[ExplainedLine, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Explanation:
    """One kernel as one compiler profile sees it. `calls` are those of a run, None without one.

    `lines` are its own; `kernel_calls` says what became of its calls of other kernels.
    """

    kernel: str
    file: str
    first_line: int
    profile: str
    code_bytes: int
    calls: int | None
    lines: tuple[ExplainedLine, ...]
    kernel_calls: tuple[ExplainedCall, ...]
    inlined: tuple[InlinedKernel, ...]
