"""Describe a recording by reading all of it, which also verifies every checksum."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from bfsim.recording.calibration_report import CalibrationReport
from bfsim.recording.frames import RectificationTables, StereoGeometry
from bfsim.recording.importing.importer import Progress
from bfsim.recording.reader import RecordingReader


@dataclass(frozen=True, slots=True)
class CameraTiming:
    """When one camera took its pictures. rate_hz and the intervals are None for a single picture."""

    first_ns: int
    last_ns: int
    rate_hz: float | None
    shortest_interval_ns: int | None
    longest_interval_ns: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingInfo:
    """The content of `bfsim record info`.

    skew_ns: the least and the greatest difference of a frame's right and left time stamp. rectified_shares: the shares
    (0 to 1) of the left and right rectified pixels that the camera saw; None without rectification tables.
    """

    path: Path
    width: int
    height: int
    frame_count: int
    duration_ns: int
    left: CameraTiming
    right: CameraTiming
    skew_ns: tuple[int, int]
    geometry: StereoGeometry | None
    rectified_shares: tuple[float, float] | None
    calibration: CalibrationReport | None
    truth_count: int
    disparity_count: int
    description: str
    compression: str
    size_bytes: int
    library: str


def describe_recording(reader: RecordingReader, progress: Progress | None = None) -> RecordingInfo:
    """Read every frame of the recording and summarise it. Raises RecordingError if it is damaged."""
    left_ns: list[int] = []
    right_ns: list[int] = []
    for frame in reader.frames():
        left_ns.append(frame.left_ns)
        right_ns.append(frame.right_ns)
        if progress is not None:
            progress(len(left_ns), reader.frame_count)
    skews_ns = [right - left for left, right in zip(left_ns, right_ns, strict=True)]
    return RecordingInfo(
        path=reader.path,
        width=reader.width,
        height=reader.height,
        frame_count=reader.frame_count,
        duration_ns=max(left_ns[-1], right_ns[-1]) - min(left_ns[0], right_ns[0]),
        left=_timing(left_ns),
        right=_timing(right_ns),
        skew_ns=(min(skews_ns), max(skews_ns)),
        geometry=reader.geometry,
        rectified_shares=_rectified_shares(reader.rectification),
        calibration=reader.calibration,
        truth_count=reader.truth_count,
        disparity_count=reader.disparity_count,
        description=reader.description,
        compression=" and ".join(name or "none" for name in reader.compressions),
        size_bytes=reader.size_bytes,
        library=reader.library,
    )


def _timing(stamps_ns: list[int]) -> CameraTiming:
    intervals_ns = [after - before for before, after in pairwise(stamps_ns)]
    if not intervals_ns:
        return CameraTiming(stamps_ns[0], stamps_ns[-1], None, None, None)
    rate_hz = len(intervals_ns) * 1e9 / (stamps_ns[-1] - stamps_ns[0])
    return CameraTiming(stamps_ns[0], stamps_ns[-1], rate_hz, min(intervals_ns), max(intervals_ns))


def _rectified_shares(tables: RectificationTables | None) -> tuple[float, float] | None:
    if tables is None:
        return None
    return float((tables.left[0] >= 0).mean()), float((tables.right[0] >= 0).mean())
