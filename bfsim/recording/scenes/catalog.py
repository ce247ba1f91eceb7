"""The scenes that can be rendered, by the names that the command line knows."""

from __future__ import annotations

from bfsim.recording.scenes import thesis_data as thesis
from bfsim.recording.scenes.distances import ball_at, box_at
from bfsim.recording.scenes.scene import Scene
from bfsim.recording.scenes.soccer_data import SOCCER

THESIS_SCENES: dict[str, Scene] = {
    "field-of-circles": thesis.FIELD_OF_CIRCLES,
    "ball-beside-goal": thesis.BALL_BESIDE_GOAL,
    "camera-initialised": thesis.CAMERA_INITIALISED,
    "robot-marker": thesis.ROBOT_MARKER,
    "hidden-ball": thesis.HIDDEN_BALL,
    "ball-with-seam": thesis.BALL_WITH_SEAM,
    "ball-too-close": thesis.BALL_TOO_CLOSE,
    "goal-sharp-angle": thesis.GOAL_SHARP_ANGLE,
}
"""T Figures 5.8, 6.7, 6.8, 6.9, 6.10, 6.12, 6.13 and 6.14."""

DISTANCE_SCENES = {"box-distances": box_at, "ball-distances": ball_at}
"""T Tables 6.2 and 6.3: functions of the distances and the geometry."""

SCENES: dict[str, Scene] = {
    "soccer": SOCCER,
    **THESIS_SCENES,
    **{name: scene_of() for name, scene_of in DISTANCE_SCENES.items()},
}
