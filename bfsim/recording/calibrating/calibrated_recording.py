"""A recording again, with the rectification tables and the geometry of its calibrated cameras."""

from __future__ import annotations

import os
from collections.abc import Callable

from bfsim.errors import RecordingError
from bfsim.recording.calibrating.calibration import StereoCalibration, calibrate
from bfsim.recording.calibration_report import LensName
from bfsim.recording.frames import StereoGeometry
from bfsim.recording.reader import RecordingReader
from bfsim.recording.writer import RecordingWriter


def calibrate_recording(
    chessboards: str | os.PathLike[str],
    recording: str | os.PathLike[str],
    output: str | os.PathLike[str] | None = None,
    *,
    corners: tuple[int, int],
    square_mm: float,
    height_mm: float | None = None,
    tilt_deg: float | None = None,
    lens: LensName = "pinhole",
    mono: bool = False,
    resize: bool = False,
    bits: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> StereoCalibration:
    """Write `recording`, with rectification tables and the geometry of its cameras, to `output` or in its own place.

    See `calibrate` for the folder `chessboards`. The recording's focal length, height and tilt are kept, if it has them
    and no others are given, but a measured focal length is measured anew. The baseline becomes the measured one.
    Pictures, time stamps and ground truth stay as they are. Raises RecordingError.
    """
    with RecordingReader(recording) as reader:
        size, old, text = (reader.width, reader.height), reader.geometry, reader.description
        before = reader.calibration
        if output is None and reader.other_topics:
            raise RecordingError(
                f"{reader.path}: recording must hold nothing but bfsim's topics to be calibrated in place, not "
                f"{', '.join(reader.other_topics)}, which would be lost; `--output` writes another file"
            )
    calibration = calibrate(
        chessboards,
        size,
        corners=corners,
        square_mm=square_mm,
        focal_px=None if old is None or (before and before.has_measured_focal) else old.focal_px,
        lens=lens,
        mono=mono,
        resize=resize,
        bits=bits,
        progress=progress,
    )
    report = calibration.report
    writer = RecordingWriter(
        output or recording,
        width=size[0],
        height=size[1],
        geometry=StereoGeometry(
            report.focal_px,
            report.baseline_mm,
            old.height_mm if height_mm is None and old else height_mm,
            old.tilt_deg if tilt_deg is None and old else tilt_deg,
        ),
        description=text,
        rectification=calibration.tables,
        calibration=report,
        residual_plot=calibration.plot,
    )
    # The reader must close before the writer replaces its file.
    with writer, RecordingReader(recording) as reader:
        for frame in reader.frames():
            writer.add(
                frame.left, frame.right, frame.left_ns, frame.right_ns, frame.truth, frame.disparity_px
            )
    return calibration
