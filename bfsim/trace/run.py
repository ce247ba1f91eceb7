"""A whole run: what ran on what, and all its records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from bfsim.trace.frames import FrameRecord
from bfsim.trace.hardware import BufferRecord, CodeRecord, MemoryRecord, MessageRecord, TrafficRecord
from bfsim.trace.kernels import AccessRecord, KernelRecord, PathRecord

DIGITS_SHOWN = 12
"""Digits of a digest that people are shown: enough to see that two runs are the same."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """Measurements from elsewhere that are shown beside the budget, such as those of a real board.

    `name` heads their column in the report. `about` says in one sentence what they are and where they come from.
    """

    name: str
    about: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BudgetRow:
    """A row of the budget: a stage of the firmware, and its milliseconds in the firmware's `Reference`, if known.

    `within` is the stage that this one is a part of; the row of that stage includes its parts. There is only one level.
    """

    stage: str
    reference_ms: float | None = None
    within: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Identity:
    """Everything that a result depends on. Digests are sha256 in hex, or empty.

    For a board or compiler that is not shipped, `..._numbers` say which shipped one it is most like, and how it differs.
    Absolute paths are left out on purpose: `..._files` are relative to the folder that they were imported from. A shipped board
    or compiler has none. `board` ends in --set PATH=VALUE for each changed number. `code` says which compiler's object code
    ran and which timing counted its cycles, or why there was none. It is empty if `compiler` is an estimate.
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
    code: str = ""
    code_digest: str = ""
    file_compiler: str = ""


class WarningKind(StrEnum):
    """The subject of a warning, unless it is a device; for the one on the SPI, the kind is "SPI device"."""

    GEOMETRY = "geometry"
    CLOCKS = "clocks"
    TABLES = "tables"
    MISSED = "missed frames"
    LOST = "lost"


@dataclass(frozen=True, slots=True, kw_only=True)
class RunWarning:
    """Something about a run that must not be overlooked, and the numbers in its text. It is about the published numbers `results`.

    `kind` is a `WarningKind`, or the device that it comes from.
    """

    kind: str
    text: str
    numbers: Mapping[str, int] = field(default_factory=dict)
    results: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardRecord:
    """The records of a board when the recording is over or the user stopped it.

    `missed` are the recording's frames that came while the firmware was busy. `messages` went over peripherals; `device_notes` are
    the final warnings of the devices there, by peripheral. `interrupts` are the numbers taken, by core and source.
    `object_share` is the share of object code in the kernels' issue cycles. If `interrupted` by Ctrl-C, `traffic` includes
    that of the unfinished frame, and `interrupted_at` is the line of the firmware that was at work, as ` (file:line)`, if
    one was.
    """

    frames: tuple[FrameRecord, ...]
    missed: tuple[int, ...]
    kernels: Sequence[KernelRecord]
    accesses: Sequence[AccessRecord]
    paths: Sequence[PathRecord]
    buffers: tuple[BufferRecord, ...]
    traffic: tuple[TrafficRecord, ...]
    code: tuple[CodeRecord, ...]
    messages: tuple[MessageRecord, ...]
    device_notes: Mapping[str, tuple[str, ...]]
    interrupts: Mapping[str, int]
    events: int
    object_share: float = 0.0
    interrupted: bool = False
    interrupted_at: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRecord(BoardRecord):
    """One run: the records of its board, and what ran there.

    `firmware_place` is the file of the firmware, or "built in"; `ldf_place` is the LDF's, or "shipped". `reference` explains
    the `reference_ms` of `rows`; it is None if the firmware has no reference. `geometry` says where the firmware takes the
    cameras to be, and whether the recording said so; it is empty for firmware that does not ask. `assumptions` are warnings
    of what was missing and had to be assumed, or was given and seems wrong. `losses` explain the published numbers of what
    the firmware lost.
    """

    identity: Identity
    firmware_place: str
    ldf_place: str
    rows: tuple[BudgetRow, ...]
    reference: Reference | None
    geometry: str
    assumptions: tuple[RunWarning, ...]
    losses: Mapping[str, str]
    memories: tuple[MemoryRecord, ...] = ()
