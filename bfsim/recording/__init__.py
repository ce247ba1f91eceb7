"""Recorded stereo frames: MCAP files in and out, and the importers that make them. Independent of the simulator.

This package has what every run needs. The modules that write, import, calibrate, describe and render are imported
separately, because they take time to load.
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
