"""The frames that every core of a run has finished, one record for each."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from bfsim.machine.calls.call_cache import CallCache
from bfsim.machine.main_loop import MainLoop
from bfsim.process.signals import uninterrupted
from bfsim.seen import Seen
from bfsim.trace import FrameRecord


class FinishedFrames:
    """`records` of the finished frames, and what was `seen` in each, by index, until that has been told."""

    def __init__(
        self,
        loops: Mapping[str, MainLoop],
        calls: Mapping[str, CallCache],
        on_frame: Callable[[FrameRecord], None] | None,
    ) -> None:
        """`loops` and `calls` are by core. `on_frame` is called with each record."""
        self.records: list[FrameRecord] = []
        self.seen: list[tuple[int, tuple[Seen, ...]]] = []
        self._loops = loops
        self._calls = calls
        self._on_frame = on_frame

    def collect(self) -> None:
        """Make one record of a frame as soon as every core has finished it."""
        finished = [each.pictures.finished for each in self._loops.values()]
        if not all(finished):
            return
        parts = [each.pop(0) for each in finished]
        for calls, part in zip(self._calls.values(), parts, strict=True):
            calls.report(part.counts)
            calls.end_first_frame()
        record = FrameRecord(
            index=parts[0].index,
            last_line_cclk=parts[0].full_at_cclk,
            result_cclk=max(each.cycles.end_cclk for each in parts),
            cores=tuple(each.cycles for each in parts),
            results={name: value for each in parts for name, value in each.results.items()},
            remarks=tuple(text for each in parts for text in each.remarks),
        )
        with uninterrupted():
            self.records.append(record)
            if seen := tuple(each.seen for each in parts if each.seen):
                self.seen.append((record.index, seen))
        if self._on_frame:
            self._on_frame(record)
