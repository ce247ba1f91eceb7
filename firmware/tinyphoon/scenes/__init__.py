"""Scenes for recordings: robot soccer as the robot sees it, and what the thesis shows and measures."""

from __future__ import annotations

from bfsim.recording.scenes import Scenes
from tinyphoon.scenes.distances import BALL_DISTANCES, BOX_DISTANCES
from tinyphoon.scenes.soccer import SOCCER
from tinyphoon.scenes.thesis import FIGURES

SCENES: dict[str, Scenes] = {
    "soccer": SOCCER,
    **FIGURES,
    "thesis": FIGURES,
    "box-distances": BOX_DISTANCES,
    "ball-distances": BALL_DISTANCES,
}
"""The scenes by the names that `bfsim record render` takes."""
