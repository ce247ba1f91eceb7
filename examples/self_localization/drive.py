"""The drive: `bfsim record render examples/self_localization/drive.py:DRIVE drive.mcap` (some minutes; needs mitsuba).

A robot drives from its own half to the blue goal in an S, at the speed of the thesis's game (0.15 m/s, T §7.1) and at
the rate that it had (5 pictures a second): 40 stereo frames, 8 seconds. It turns so far that it sees the goal, then a
post of it, then none, and then the goal again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from bfsim.recording.scenes import Drive, Pose
from tinyphoon.scenes.soccer import SOCCER

PERIOD_NS = 200_000_000
SPEED_MM_PER_S = 150.0
TURNS_DEG_PER_S = ((10, 2.0), (8, 22.0), (14, -20.0), (8, 13.0))
"""For so many frames it turns so fast."""


def poses(x_mm: float, y_mm: float, heading_deg: float) -> Sequence[Pose]:
    """Return the poses of the drive from a first one."""
    found: list[Pose] = []
    at = Pose(x_mm=x_mm, y_mm=y_mm, heading_deg=heading_deg)
    for frames, turn_deg_per_s in TURNS_DEG_PER_S:
        arc = Drive(
            x_mm=at.x_mm,
            y_mm=at.y_mm,
            heading_deg=at.heading_deg,
            speed_mm_per_s=SPEED_MM_PER_S,
            turn_deg_per_s=turn_deg_per_s,
        )
        found += arc.poses(frames, PERIOD_NS)
        at = arc.pose(frames * PERIOD_NS / 1e9)
    return found


DRIVE = replace(
    SOCCER,
    description="A drive in an S towards the blue goal, 8 seconds at 5 pictures a second, to localize a robot on.",
    things={name: thing for name, thing in SOCCER.things.items() if name not in ("robot", "ball")},
    poses=tuple(poses(-560.0, -260.0, 8.0)),
    period_ns=PERIOD_NS,
    samples=64,
    seed=615,
)
