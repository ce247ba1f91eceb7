"""The field, its things and its light, and the soccer scene of the built-in recording: only numbers.

Sources: [T] the Tinyphoon thesis; [MiroSot] the rules of FIRA's league for robots of 7.5 cm, quoted from
memory; [assumed].
"""

from __future__ import annotations

from bfsim.recording.scenes import (
    Ball,
    Box,
    Colour,
    Drive,
    FieldLine,
    Floor,
    Goal,
    Lamp,
    Light,
    Robot,
    Scene,
    StereoGeometry,
)

# Focal length after rectification and baseline: [T 6.2]; height above the floor and tilt: [T 6.4].
GEOMETRY = StereoGeometry(focal_px=386.0, baseline_mm=30.47, height_mm=120.0, tilt_deg=10.0)

# Clearly different in hue as U and V, and none so saturated that it counts as black. [assumed]
YELLOW: Colour = (0.80, 0.54, 0.03)
BLUE: Colour = (0.11, 0.36, 0.66)
RED: Colour = (0.80, 0.20, 0.16)
WHITE: Colour = (0.80, 0.80, 0.80)
BLACK: Colour = (0.02, 0.02, 0.02)
GREY: Colour = (0.06, 0.06, 0.06)

# Roughness of the clear coats, [assumed]; the floor mirrors colours: [T 6.3.2].
FLOOR_ROUGHNESS = 0.25
OBJECT_ROUGHNESS = 0.30

# Field of 1500 x 1300, goal, walls and lines: [MiroSot]; height of the goal: [assumed].
GOAL = Goal(line_x_mm=750, width_mm=400, depth_mm=150, height_mm=100, panel_mm=10, colour=BLUE)

# A ball of 6 cm: [T 6.3.1].
BALL = Ball(x_mm=230, y_mm=40, radius_mm=30, colour=YELLOW)

# A cube of 7.5 cm: [MiroSot]; a mark from 7 to 12 cm above the ground, seen from all sides: [T 6.4].
ROBOT = Robot(
    x_mm=560,
    y_mm=262,
    heading_deg=215,
    side_mm=75,
    body_height_mm=70,
    body_colour=GREY,
    mark_height_mm=50,
    mark_colour=RED,
)

# Wide enough for a camera 12 cm above the floor to see a line that crosses its view. [assumed]
LINE_MM = 10.0

LINES = (
    FieldLine("centre line", (0, -650), (0, 650), LINE_MM),
    FieldLine("penalty area front", (400, -400), (400, 400), LINE_MM),
    FieldLine("penalty area left", (400, 400), (750, 400), LINE_MM),
    FieldLine("penalty area right", (400, -400), (750, -400), LINE_MM),
    FieldLine("goal area front", (600, -250), (600, 250), LINE_MM),
    FieldLine("goal area left", (600, 250), (750, 250), LINE_MM),
    FieldLine("goal area right", (600, -250), (750, -250), LINE_MM),
    FieldLine("goal line", (750, -200), (750, 200), LINE_MM),
)


# The floor reaches under the walls and the goal.
FLOOR = Floor(size_mm=(1850.0, 1400.0), colour=BLACK, roughness=FLOOR_ROUGHNESS, paint=WHITE, lines=LINES)

# The walls at the far end stop at the goal.
WALLS = {
    "wall_end_left": Box(foot_mm=(762.5, 430, 0), size_mm=(25, 440, 50), colour=WHITE),
    "wall_end_right": Box(foot_mm=(762.5, -430, 0), size_mm=(25, 440, 50), colour=WHITE),
    "wall_side_left": Box(foot_mm=(0, 662.5, 0), size_mm=(1500, 25, 50), colour=WHITE),
    "wall_side_right": Box(foot_mm=(0, -662.5, 0), size_mm=(1500, 25, 50), colour=WHITE),
}

# Two rows of office lamps, with the brighter one behind the robot; 1 just saturates the sensor. [assumed]
LAMPS = (
    Lamp((-1700, 300, 1600), (300, 1600), 48.0),
    Lamp((100, -500, 1900), (1200, 300), 16.0),
)
LIGHT = Light(lamps=LAMPS, room_radiance=0.015)

# 30 frames a second; the second camera has its own oscillator and lags by a constant phase. [assumed]
FRAME_PERIOD_NS = 33_333_333
RIGHT_PHASE_NS = 2_100_000

# Towards the ball, in a slight left turn. [assumed]
DRIVE = Drive(x_mm=-270, y_mm=0, heading_deg=2, speed_mm_per_s=600, turn_deg_per_s=17)

SOCCER = Scene(
    description=(
        "Robot soccer: a Tinyphoon robot drives at the ball (yellow, 6 cm) in a slight left turn; before it "
        "another robot (red mark) and the goal (blue)."
    ),
    things={"goal": GOAL, **WALLS, "robot": ROBOT, "ball": BALL},
    roughness=OBJECT_ROUGHNESS,
    floor=FLOOR,
    light=LIGHT,
    geometry=GEOMETRY,
    poses=DRIVE.poses(8, FRAME_PERIOD_NS),
    period_ns=FRAME_PERIOD_NS,
    right_phase_ns=RIGHT_PHASE_NS,
    samples=192,  # light paths a pixel; their noise then stays below that of the sensor
    seed=561,
)
