"""The drawn chessboards that calibration is tried on: the cameras that see them, and what of the boards is told."""

from __future__ import annotations

from bfsim.recording import StereoGeometry
from bfsim.recording.scenes.lens import Lens, Misfit

GEOMETRY = StereoGeometry(focal_px=386.0, baseline_mm=30.47, height_mm=120.0, tilt_deg=10.0)


MISFIT = Misfit(Lens(-0.25, 0.08, 0.001, -0.0008), (0.8, -1.2, 0.6), (0.3, 0.5, -0.4))
SIZE, CORNERS, SQUARE_MM = (320, 240), (9, 6), 20.0
