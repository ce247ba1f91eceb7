"""The timeline of a run: flat records of what each core and device did, and from which cycle to which.

They are handed out during the run (`bfsim.run.simulate(..., on_spans=...)`), so a long run takes no more memory. Cycles
are CCLK cycles from the start of the run. What devices do between two CCLK edges begins and ends at the next edge.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from types import MappingProxyType
from typing import NamedTuple

from bfsim.trace import StallReason


class SpanKind(StrEnum):
    """What was going on. CALL, WORK, STALL and IDLE fill the time of a core exactly, and so do its STAGEs."""

    FRAME = "frame"
    STAGE = "stage"
    CALL = "kernel"
    WORK = "other work"
    STALL = "stall"
    IDLE = "idle"
    INTERRUPT = "interrupt"
    TRANSFER = "transfer"
    LINE = "camera line"
    MESSAGE = "message"
    LOCK = "lock"
    LEVEL = "level"


TRACKS = {
    SpanKind.FRAME: "frames", SpanKind.STAGE: "stages", SpanKind.CALL: "work", SpanKind.WORK: "work", SpanKind.STALL: "work",
    SpanKind.IDLE: "work", SpanKind.INTERRUPT: "interrupts", SpanKind.TRANSFER: "transfers", SpanKind.LINE: "lines",
    SpanKind.MESSAGE: "messages", SpanKind.LOCK: "locks",
}  # fmt: skip
"""The track of a core or device for each kind of span. Each LEVEL has a track of its own."""


NO_STALLS: Mapping[StallReason, int] = MappingProxyType({})


class Place(NamedTuple):
    """A part of a picture: its rows and columns, counted from 0, as a range, as single ones in order, or all.

    Single `rows` belong to single pixels: each goes with the column at the same position.
    """

    rows: range | tuple[int, ...]
    columns: range | tuple[int, ...] | None = None


class Span(NamedTuple):
    """Something that went on from `begin_cclk` to `end_cclk` at `where`: a core, a DMA channel, a camera, a semaphore.

    Spans of one track come in the order of time and never overlap. For a core, issue + stall + idle = elapsed, and `stage`
    is its row of the budget; where in a call its stalls were is not known. `value` is the number of bytes moved, the level,
    or the index of the frame. `flow` is the same number in a transfer and in the wait that it ended, otherwise 0. `place` is
    the part of the core's picture that it belongs to, if known.
    """

    kind: SpanKind
    where: str
    name: str
    begin_cclk: int
    end_cclk: int
    stage: str = ""
    issue_cclk: int = 0
    stall_cclk: Mapping[StallReason, int] = NO_STALLS
    value: int = 0
    flow: int = 0
    place: Place | None = None

    @property
    def elapsed_cclk(self) -> int:
        """Cycles from begin to end."""
        return self.end_cclk - self.begin_cclk

    @property
    def track(self) -> tuple[str, str]:
        """The track of the span: `where`, and its name there."""
        return self.where, self.name if self.kind is SpanKind.LEVEL else TRACKS[self.kind]
