"""The cost of frames: cycles by core, stage and owner, and why a core did not work."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

REST = "(the rest)"
"""The row of everything that a core does outside stages."""

NO_STAGES = frozenset(
    {"frame_rate", "missed", "latency", "frame", "memory", "results", "objects", "distance_mm"}
)
"""First words of limits of `bfsim check` other than stages: a stage with such a name would be mistaken for one of them."""


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
    """The cost of one stage on one core in one frame. `stall_cclk` leaves out stalls of no cycles."""

    stage: str
    issue_cclk: int
    stall_cclk: Mapping[StallReason, int]
    idle_cclk: int

    @property
    def elapsed_cclk(self) -> int:
        """All cycles of the stage, whatever the core did in them."""
        return self.issue_cclk + sum(self.stall_cclk.values()) + self.idle_cclk


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnerCost(StageCost):
    """One owner's part of a stage's cost: a kernel without its callees, or something outside kernels.

    `symbol` is the kernel's in the machine code (`KernelRecord`). It is empty for a ring, a semaphore, an interrupt, the
    cameras ..., which `owner` then names.
    """

    owner: str
    symbol: str
    calls: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CoreFrame:
    """One frame on one core, from the end of the previous frame to its own end. The stages add up to it exactly.

    The `owners` of each stage add up to that exactly, too: issue, each reason of a stall, and idle.
    """

    core: str
    begin_cclk: int
    end_cclk: int
    stages: tuple[StageCost, ...]
    owners: Sequence[OwnerCost] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameRecord:
    """One stereo frame. `index` is its number in the recording; latency runs from `last_line_cclk` to `result_cclk`.

    `cores` begins with core A. `results` are the numbers that the firmware published for the frame (edges found ...),
    `remarks` its sentences (an order refused ...).
    """

    index: int
    last_line_cclk: int
    result_cclk: int
    cores: tuple[CoreFrame, ...]
    results: Mapping[str, int]
    remarks: tuple[str, ...] = ()

    @property
    def begin_cclk(self) -> int:
        """When the first of its cores finished the previous frame."""
        return min(core.begin_cclk for core in self.cores)

    @property
    def end_cclk(self) -> int:
        """When the last of its cores finished it."""
        return max(core.end_cclk for core in self.cores)
