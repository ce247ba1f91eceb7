"""The scenes that can be rendered, by the names that the command line knows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from bfsim.errors import RecordingError
from bfsim.recording.frames import StereoGeometry
from bfsim.recording.scenes import thesis_data as thesis
from bfsim.recording.scenes.distances import ball_at, box_at
from bfsim.recording.scenes.scene import Scene
from bfsim.recording.scenes.soccer_data import SOCCER

THESIS = "thesis"
"""Stands for all thesis scenes."""

# T Figures 5.8, 6.7, 6.8, 6.9, 6.10, 6.12, 6.13 and 6.14.
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
_SCENES = {"soccer": SOCCER, **THESIS_SCENES}
_DISTANCE_SCENES = {"box-distances": box_at, "ball-distances": ball_at}

SCENE_NAMES = (*_SCENES, *_DISTANCE_SCENES, THESIS)


def scenes_named(
    name: str, distances_mm: Sequence[float] | None = None, geometry: StereoGeometry | None = None
) -> dict[str, Scene]:
    """Return the scene of this name, or all that it stands for, by their own names.

    distances_mm are those of a scene that has some; geometry is another than the scene's own. Raises
    RecordingError.
    """
    if distances_mm is not None and name not in _DISTANCE_SCENES:
        raise RecordingError(f"distances must be given for {' or '.join(_DISTANCE_SCENES)}, not for {name}")
    if distances_mm is not None and not all(0 < distance < math.inf for distance in distances_mm or (0,)):
        listed = ", ".join(f"{distance:g}" for distance in distances_mm) or "none"
        raise RecordingError(f"distances must be at least one and above 0 mm, not {listed}")
    if name in _DISTANCE_SCENES:
        return {name: _DISTANCE_SCENES[name](distances_mm, geometry)}
    chosen = THESIS_SCENES if name == THESIS else {name: _SCENES[name]}
    if geometry is None:
        return chosen
    return {each: replace(scene, geometry=geometry) for each, scene in chosen.items()}
