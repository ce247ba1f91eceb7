"""A box from all sides and at many distances: `bfsim record render tinyphoon.scenes.boxes:BOXES boxes.mcap`."""

from __future__ import annotations

import math
from dataclasses import replace

from bfsim.recording.scenes import Box, Pose
from tinyphoon.scenes.soccer import FLOOR, SOCCER
from tinyphoon.scenes.thesis import GREEN

# Longer than deep, so that its faces differ, and lower than the cameras. [assumed]
BOX = Box(foot_mm=(300, 0, 0), size_mm=(80, 120, 70), colour=GREEN)
"""The side facing -x is 120 mm wide; seen from there, the box is 80 mm deep."""

DISTANCES_MM = (350, 500, 700, 900)  # to its middle
ANGLES_DEG = (0, 20, 45, 70, 90)  # from the view 120 mm wide to the view 80 mm wide
ASIDE_DEG = 4  # the robot looks a little past it

BOXES = replace(
    SOCCER,
    description="A green box of 120 x 80 x 70 mm on the floor, from the front to the side, 350 to 900 mm away.",
    things={"box": BOX},
    floor=replace(FLOOR, lines=()),
    poses=tuple(
        Pose(
            x_mm=BOX.foot_mm[0] - distance * math.cos(math.radians(angle)),
            y_mm=BOX.foot_mm[1] - distance * math.sin(math.radians(angle)),
            heading_deg=angle + ASIDE_DEG,
        )
        for distance in DISTANCES_MM
        for angle in ANGLES_DEG
    ),
    samples=64,
    seed=702,
)
