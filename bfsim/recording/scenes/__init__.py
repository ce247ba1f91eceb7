"""Synthetic stereo scenes: rendered with mitsuba to recordings with exact ground truth.

The optional extra `scenes` installs the renderer; nothing here is needed to run a recording.
World frame of every scene: millimetres, x towards the far goal, y to the left, z up, origin on the floor.
Pixels are counted as array indices: (0.0, 0.0) is the centre of the first pixel.
"""

from __future__ import annotations

from bfsim.recording.scenes.catalog import SCENE_NAMES
from bfsim.recording.scenes.lens import Lens, Misfit
from bfsim.recording.scenes.rendering import render

__all__ = ["SCENE_NAMES", "Lens", "Misfit", "render"]
