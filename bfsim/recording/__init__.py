"""Recorded stereo frames: MCAP files in and out, and the importers that make them. Knows no simulator."""

from __future__ import annotations

from bfsim.recording.calibration import StereoCalibration, calibrate_recording
from bfsim.recording.calibration_report import CalibrationReport, ViewError
from bfsim.recording.frames import (
    DisparityImage,
    RectificationTables,
    StereoFrame,
    StereoGeometry,
    UyvyImage,
)
from bfsim.recording.images import picture_of_file
from bfsim.recording.importer import ImportSummary, import_recording, load_rectification
from bfsim.recording.info import CameraTiming, RecordingInfo, describe_recording
from bfsim.recording.reader import RecordingReader
from bfsim.recording.seen_writer import SeenWriter
from bfsim.recording.sources import SOURCE_FORMATS, SourceFormat
from bfsim.recording.writer import RecordingWriter

__all__ = [
    "SOURCE_FORMATS",
    "CalibrationReport",
    "CameraTiming",
    "DisparityImage",
    "ImportSummary",
    "RecordingInfo",
    "RecordingReader",
    "RecordingWriter",
    "RectificationTables",
    "SeenWriter",
    "SourceFormat",
    "StereoCalibration",
    "StereoFrame",
    "StereoGeometry",
    "UyvyImage",
    "ViewError",
    "calibrate_recording",
    "describe_recording",
    "import_recording",
    "load_rectification",
    "picture_of_file",
]
