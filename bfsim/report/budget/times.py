"""From cycles to times: ms, the frame rate, and the latency of results."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from bfsim.trace import CoreFrame, FrameRecord


def milliseconds(cclk: float, cclk_hz: float) -> float:
    """Convert cycles to ms."""
    return cclk * 1000 / cclk_hz


def frame_rate_hz(frames: Sequence[FrameRecord], cclk_hz: float) -> float:
    """Return frames per second from frame end to frame end, but no more than pictures can come.

    For a single frame, it is one over the frame's duration. Firmware that waits for every picture is as fast as the
    pictures come, so it is timed from picture to picture: among a few frames, a slow first one would make it seem
    faster than its cameras.
    """
    ends = [frame.end_cclk for frame in frames]
    if len(frames) == 1:
        return cclk_hz / (ends[0] - frames[0].begin_cclk)
    if waits_for_pictures(frames):
        ends = [frame.last_line_cclk for frame in frames]
    nearest_cclk = min(later.last_line_cclk - each.last_line_cclk for each, later in pairwise(frames))
    return cclk_hz / max((ends[-1] - ends[0]) / (len(frames) - 1), nearest_cclk)


def waits_for_pictures(frames: Sequence[FrameRecord]) -> bool:
    """Whether all cores wait for every picture after the first one, for which they must wait anyway."""
    return len(frames) > 1 and all(_idles(core) for frame in frames[1:] for core in frame.cores)


def _idles(frame: CoreFrame) -> bool:
    return any(cost.idle_cclk for cost in frame.stages)


def latency_cclk(frame: FrameRecord) -> int:
    """Return the cycles from the arrival of the last line until the result leaves."""
    return frame.result_cclk - frame.last_line_cclk
