"""Recorded stereo frames: MCAP files in and out, and the importers that make them. Knows no simulator.

What every run needs stands here; what writes, imports, calibrates, describes and renders is imported from its own module, because it
takes its time.
"""

from __future__ import annotations

from bfsim.recording.frames import (
    DisparityImage,
    RectificationTables,
    StereoFrame,
    StereoGeometry,
    UyvyImage,
)
from bfsim.recording.reader import RecordingReader

__all__ = [
    "DisparityImage",
    "RecordingReader",
    "RectificationTables",
    "StereoFrame",
    "StereoGeometry",
    "UyvyImage",
]
