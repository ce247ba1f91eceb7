"""The scenes of the thesis's figures, rebuilt from the descriptions in its text: only numbers.

The pictures themselves are not reproduced: positions, and all colours and lights, are [assumed]; what the text
gives is marked [T] with its section. Each scene shows the effect that the text reports, as strongly as it
occurs.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.recording.scenes import Ball, Box, Colour, Drive, FieldArc, Lamp, Scene
from tinyphoon.scenes.soccer import (
    BALL,
    BLACK,
    BLUE,
    FLOOR,
    FRAME_PERIOD_NS,
    GOAL,
    LAMPS,
    LIGHT,
    RED,
    ROBOT,
    SOCCER,
    WALLS,
    WHITE,
    YELLOW,
)

ORANGE: Colour = (0.80, 0.30, 0.05)
GREEN: Colour = (0.12, 0.50, 0.20)
CYAN: Colour = (0.10, 0.55, 0.60)
MAGENTA: Colour = (0.65, 0.15, 0.50)
WOOD: Colour = (0.30, 0.20, 0.12)
LIGHT_GREY: Colour = (0.45, 0.45, 0.45)

YELLOW_GOAL = replace(GOAL, colour=YELLOW)

FRAMES = 3
SAMPLES = 64  # light paths a pixel; in low light, their noise is that of a gain turned up


def _still(x_mm: float, y_mm: float, heading_deg: float, speed_mm_per_s: float = 0.0) -> Drive:
    """Return a robot that looks and drives straight ahead."""
    return Drive(
        x_mm=x_mm, y_mm=y_mm, heading_deg=heading_deg, speed_mm_per_s=speed_mm_per_s, turn_deg_per_s=0
    )


# The ball lies next to the goal; half of a circular landmark is in view; on the left above the goal, off the field, is
# a blob whose shape and dimension fit no model, so it has a model's colour. [T 6.4, Figure 6.7]
BALL_BESIDE_GOAL = replace(
    SOCCER,
    description="T Figure 6.7: the ball beside the goal, a circular landmark half in view, a thing off the field.",
    things={
        "goal": GOAL,
        **WALLS,
        "ball": replace(BALL, x_mm=705, y_mm=-255),
        "background": Box(foot_mm=(1150, 330, 120), size_mm=(60, 60, 110), colour=RED),
    },
    floor=replace(FLOOR, arcs=(FieldArc((260, 170), 120, 0, 360, 10),)),
    poses=_still(-140, 0, 0, 300).poses(FRAMES, FRAME_PERIOD_NS),
    samples=SAMPLES,
    seed=607,
)

# The first pictures after the settings were sent have a yellow cast; five to ten pictures pass before the camera
# responds. The goal is yellow. [T 6.4, Figure 6.8]
_YELLOW_DRIFT: Colour = (1.5, 1.35, 0.30)  # [assumed]
_SETTLING_FRAMES = 8


def _settling(frame: int) -> Colour:
    """Return the gains of a frame on a linear way from the drift to 1."""
    rest = 1 - frame / _SETTLING_FRAMES
    red, green, blue = (1 + rest * (gain - 1) for gain in _YELLOW_DRIFT)
    return red, green, blue


CAMERA_INITIALISED = replace(
    SOCCER,
    description="T Figure 6.8: the first pictures after the camera was set up drift toward yellow.",
    things={"goal": YELLOW_GOAL, **WALLS, "ball": replace(BALL, x_mm=380, y_mm=70)},
    light=replace(LIGHT, room_radiance=0.03),
    floor=replace(FLOOR, colour=(0.10, 0.10, 0.10)),
    poses=_still(0, 0, 3).poses(_SETTLING_FRAMES + 1, FRAME_PERIOD_NS),
    gains=tuple(_settling(frame) for frame in range(_SETTLING_FRAMES + 1)),
    samples=SAMPLES,
    seed=608,
)

# The mark is seen from 7 to 12 cm above the ground; things behind the field make the left border line of the mark
# longer than the mark. [T 6.4, Figure 6.9]
ROBOT_MARKER = replace(
    SOCCER,
    description="T Figure 6.9: a robot by its mark; a post behind the field carries its left border on upwards.",
    things={
        "goal": GOAL,
        **WALLS,
        "robot": replace(ROBOT, x_mm=330, y_mm=25, heading_deg=0),
        "post": Box(foot_mm=(1000, 144.3, 0), size_mm=(30, 60, 400), colour=LIGHT_GREY),
        "cupboard": Box(foot_mm=(1000, -250, 0), size_mm=(40, 300, 260), colour=WOOD),
    },
    poses=_still(0, 0, 0).poses(FRAMES, FRAME_PERIOD_NS),
    samples=SAMPLES,
    seed=609,
)

# Two robots, the right one with a red mark before yellow that is just as bright at the right border of the mark, on the
# side of the window. In the top row the ball is detected correctly, in the bottom row a robot hides more than half of
# it. [T 6.4, Figures 6.10 and 6.11]
BALL_BESIDE_ROBOT = replace(
    SOCCER,
    description="T Figure 6.10, top row: the ball in view beside robots; a red mark before yellow of the same brightness.",
    things={
        "goal": replace(GOAL, colour=(0.68, 0.46, 0.026)),  # as bright there as the mark before it
        **WALLS,
        "ball": replace(BALL, x_mm=300, y_mm=-45),
        "robot_left": replace(ROBOT, x_mm=350, y_mm=100, heading_deg=12, mark_colour=CYAN),
        "robot_right": replace(ROBOT, x_mm=480, y_mm=-50, heading_deg=350),
    },
    light=replace(LIGHT, lamps=(*LAMPS, Lamp((200, -1300, 1100), (1400, 300), 30.0))),
    poses=_still(0, 0, 0, 200).poses(FRAMES, FRAME_PERIOD_NS),
    samples=SAMPLES,
    seed=610,
)

HIDDEN_BALL = replace(
    BALL_BESIDE_ROBOT,
    description="T Figure 6.10, bottom row: a robot hides more than half of the ball; else as the top row.",
    things={**BALL_BESIDE_ROBOT.things, "ball": replace(BALL, x_mm=455, y_mm=94)},
)

# A yellow tennis ball, divided in two by its seam; white field lines have an edge on each side. The whole ball is in
# view, so any failure is due to the seam. [T 6.4, Figure 6.12]
BALL_WITH_SEAM = replace(
    SOCCER,
    description="T Figure 6.12: field lines, and a tennis ball whose seam cuts its yellow in two.",
    things={
        "goal": GOAL,
        **WALLS,
        "ball": replace(BALL, x_mm=380, y_mm=15, seam_colour=WHITE, seam_turn_deg=100),
    },
    poses=_still(100, 40, 0, 200).poses(FRAMES, FRAME_PERIOD_NS),
    samples=SAMPLES,
    seed=612,
)

# Too close to the camera: the top of the ball is too bright to be detected, the rest is a blob, and the ball is only
# partly in the picture. [T 6.4, Figure 6.13]
BALL_TOO_CLOSE = replace(
    SOCCER,
    description="T Figure 6.13: the ball too close, only a part of it in view, its top over-exposed.",
    things={"goal": GOAL, **WALLS, "ball": replace(BALL, x_mm=148, y_mm=15)},
    light=replace(LIGHT, lamps=(*LAMPS, Lamp((230, 15, 400), (100, 100), 64.0))),
    poses=_still(0, 0, 0).poses(FRAMES, FRAME_PERIOD_NS),
    samples=SAMPLES,
    seed=613,
)

# The goal, a box open on two sides, seen from a sharp angle. [T 6.4, Figure 6.14]
GOAL_SHARP_ANGLE = replace(
    SOCCER,
    description="T Figure 6.14: the goal seen from a sharp angle.",
    things={"goal": YELLOW_GOAL, **WALLS},
    poses=_still(440, -440, 58, 200).poses(FRAMES, FRAME_PERIOD_NS),
    samples=SAMPLES,
    seed=614,
)

# A computer-generated picture to test the detection of circles; some get their size, others only a direction. [T 5.2.6,
# Figure 5.8]
_CIRCLES: tuple[tuple[float, float, float, Colour], ...] = (
    (250, 60, 22, YELLOW), (260, -15, 30, BLUE), (270, -85, 16, ORANGE),
    (360, 110, 30, GREEN), (370, 30, 20, MAGENTA), (390, -55, 30, YELLOW), (380, -125, 24, CYAN),
    (520, 170, 30, ORANGE), (540, 85, 40, BLUE), (520, 10, 26, GREEN), (540, -90, 34, MAGENTA), (560, -185, 30, BLUE),
    (720, 180, 45, YELLOW), (730, 40, 38, CYAN), (740, -80, 30, ORANGE), (725, -220, 45, GREEN),
)  # fmt: skip

FIELD_OF_CIRCLES = replace(
    SOCCER,
    description="T Figure 5.8: a field of balls of many sizes and colours, to try the detection of circles with.",
    things={
        f"ball_{index}": Ball(x_mm=x_mm, y_mm=y_mm, radius_mm=radius_mm, colour=colour)
        for index, (x_mm, y_mm, radius_mm, colour) in enumerate(_CIRCLES)
    },
    floor=replace(FLOOR, lines=(), colour=BLACK),
    poses=_still(0, 0, 0, 200).poses(FRAMES, FRAME_PERIOD_NS),
    samples=4 * SAMPLES,  # the thesis's picture was computer-generated: little noise
    seed=508,
)

FIGURES: dict[str, Scene] = {
    "field-of-circles": FIELD_OF_CIRCLES,
    "ball-beside-goal": BALL_BESIDE_GOAL,
    "camera-initialised": CAMERA_INITIALISED,
    "robot-marker": ROBOT_MARKER,
    "ball-beside-robot": BALL_BESIDE_ROBOT,
    "hidden-ball": HIDDEN_BALL,
    "ball-with-seam": BALL_WITH_SEAM,
    "ball-too-close": BALL_TOO_CLOSE,
    "goal-sharp-angle": GOAL_SHARP_ANGLE,
}
"""T Figures 5.8, 6.7, 6.8, 6.9, 6.10, 6.12, 6.13 and 6.14."""
