"""Synthetic stereo scenes: rendered with mitsuba to recordings with exact ground truth.

The optional extra `scenes` installs the renderer; running a recording needs none of this. The content of a scene comes
from outside as data: a `Scene`, several by name, or one that is made for given distances. The world frame of every
scene: millimetres, x ahead (towards the far goal), y to the left, z up, origin on the floor. Pixels are counted as
array indices: (0.0, 0.0) is the centre of the first pixel.
"""

from __future__ import annotations

from bfsim.recording.frames import StereoGeometry
from bfsim.recording.scenes.drive import Drive, Pose
from bfsim.recording.scenes.lens import Lens, Misfit
from bfsim.recording.scenes.objects import Ball, Box, Colour, FieldArc, FieldLine, Goal, Lamp, Robot, Thing
from bfsim.recording.scenes.rendering import render
from bfsim.recording.scenes.scene import Floor, Light, Scene, SceneAtDistances, Scenes

__all__ = [
    "Ball", "Box", "Colour", "Drive", "FieldArc", "FieldLine", "Floor", "Goal", "Lamp", "Lens", "Light", "Misfit", "Pose",
    "Robot", "Scene", "SceneAtDistances", "Scenes", "StereoGeometry", "Thing", "render",
]  # fmt: skip
