"""What a board has to tell when a recording is over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from bfsim.trace import (
    AccessRecord,
    BufferRecord,
    CodeRecord,
    FrameRecord,
    KernelRecord,
    MessageRecord,
    PathRecord,
    TrafficRecord,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What a board reports when the recording is over, or the user stopped it."""

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
    interrupts: Mapping[str, int]
    events: int
