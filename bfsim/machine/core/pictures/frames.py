"""A frame as firmware gets it, and what a core reports about it at its end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bfsim.machine.calls.ledger import FrameCounts
from bfsim.machine.memories import Row
from bfsim.seen import Seen
from bfsim.trace import CoreFrame


@dataclass(frozen=True, slots=True)
class Frame:
    """One picture of this core's camera. `rows` are its lines in memory, 2 · `width` bytes of UYVY each."""

    index: int
    rows: Sequence[Row]
    width: int
    height: int

    def __repr__(self) -> str:
        """Return a short text for printing: a frame has hundreds of rows."""
        return f"<frame {self.index}, {self.width}x{self.height}>"


@dataclass(frozen=True, slots=True, kw_only=True)
class FinishedFrame:
    """What one core reports at the end of a frame. `counts` are the counters of its kernels in that frame."""

    index: int
    full_at_cclk: int
    cycles: CoreFrame
    counts: FrameCounts
    results: Mapping[str, int]
    remarks: tuple[str, ...]
    seen: Seen | None
