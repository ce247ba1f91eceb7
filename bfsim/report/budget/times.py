"""From cycles to times: ms, the frame rate, and the latency of results."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from bfsim.trace import CoreFrame, FrameRecord


def milliseconds(cclk: float, cclk_hz: float) -> float:
    """Convert cycles to ms."""
    return cclk * 1000 / cclk_hz


def frame_rate_hz(frames: Sequence[FrameRecord], cclk_hz: float) -> float:
    """Frames per second from frame end to frame end, at most as many as pictures can come; of a single frame, one over its duration.

    Firmware that waits for every picture is as fast as these come, from picture to picture: in a few frames, a first one that took
    long would make it faster than its cameras.
    """
    ends = [frame.end_cclk for frame in frames]
    if len(frames) == 1:
        return cclk_hz / (ends[0] - frames[0].begin_cclk)
    if waits_for_pictures(frames):
        ends = [frame.last_line_cclk for frame in frames]
    nearest_cclk = min(later.last_line_cclk - each.last_line_cclk for each, later in pairwise(frames))
    return cclk_hz / max((ends[-1] - ends[0]) / (len(frames) - 1), nearest_cclk)


def waits_for_pictures(frames: Sequence[FrameRecord]) -> bool:
    """Say whether all cores wait for each picture but the first one, which has to come."""
    return len(frames) > 1 and all(_idles(core) for frame in frames[1:] for core in frame.cores)


def _idles(frame: CoreFrame) -> bool:
    return any(cost.idle_cclk for cost in frame.stages)


def latency_cclk(frame: FrameRecord) -> int:
    """Cycles from the last line coming in to the result going out."""
    return frame.result_cclk - frame.last_line_cclk
