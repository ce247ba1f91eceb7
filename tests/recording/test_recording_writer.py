"""The writer refuses what could not be read back, and leaves nothing behind."""

from __future__ import annotations

import resource
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from bfsim.errors import RecordingError
from bfsim.recording import RectificationTables, StereoGeometry, UyvyImage
from bfsim.recording.writer import RecordingWriter

WIDTH, HEIGHT = 16, 8


def picture(seed: int, width: int = WIDTH) -> UyvyImage:
    """Return a picture of noise, other for every seed."""
    return np.random.default_rng(seed).integers(0, 256, (HEIGHT, 2 * width), dtype=np.uint8)


def write(path: Path) -> Path:
    """Write a recording of one frame."""
    with RecordingWriter(path, width=WIDTH, height=HEIGHT) as writer:
        writer.add(picture(0), picture(1), 0, 0)
    return path


def test_a_recording_that_is_replaced_keeps_its_permissions(tmp_path: Path) -> None:
    """As every other file that is written over."""
    path = write(tmp_path / "a.mcap")
    path.chmod(0o640)
    write(path)
    assert path.stat().st_mode & 0o777 == 0o640


def test_error_leaves_nothing(tmp_path: Path) -> None:
    """After an error or Ctrl-C in the middle the folder is as it was, the older recording untouched."""
    path = write(tmp_path / "a.mcap")
    before = path.read_bytes()
    for stop in (KeyboardInterrupt, ValueError):
        with pytest.raises(stop), RecordingWriter(path, width=WIDTH, height=HEIGHT) as writer:
            writer.add(picture(0), picture(1), 0, 0)
            raise stop
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == before


def nothing(writer: RecordingWriter) -> None:
    """Add no frame at all."""


@pytest.mark.parametrize(
    ("add", "message"),
    [
        (nothing, "at least one stereo frame, not 0"),
        (
            lambda w: w.add(picture(0, 18), picture(1), 0, 0),
            r"shape \(8, 32\), UYVY, not uint8 .*frame 0, /camera/left",
        ),
        (
            lambda w: w.add(picture(0), picture(1).astype(np.int16), 0, 0),
            "not int16 .*frame 0, /camera/right",
        ),
        (lambda w: w.add(picture(0), picture(1), 0, -1), "time stamp must be later"),
        (
            lambda w: [w.add(picture(0), picture(1), 9, k) for k in (1, 2)],
            "later than the one before .* frame 1",
        ),
        (lambda w: w.add(picture(0), picture(1), 1 << 63, 0), "fit 63 bits"),
        (
            lambda w: w.add(picture(0), picture(1), 0, 0, {"x": float("nan")}),
            "must be plain JSON data.*frame 0",
        ),
        (lambda w: w.add(picture(0), picture(1), 0, 0, {"x": {1, 2}}), "must be plain JSON data: .*set"),
    ],
)
def test_writer_refuses(tmp_path: Path, add: Callable[[RecordingWriter], object], message: str) -> None:
    """What could not be read back is not written, and no file appears."""
    writer = RecordingWriter(tmp_path / "a.mcap", width=WIDTH, height=HEIGHT)
    with pytest.raises(RecordingError, match=message), writer:
        add(writer)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("width", "height"), [(15, 8), (0, 8), (16, 0), (-2, 8)])
def test_writer_refuses_size(tmp_path: Path, width: int, height: int) -> None:
    """An odd or empty size is refused before a file is made."""
    with pytest.raises(RecordingError, match="must be (even and )?above 0"):
        RecordingWriter(tmp_path / "a.mcap", width=width, height=height)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((0, 30, 60, 20), "focal_px must be above 0"),
        ((386, 30, float("nan"), 20), "height_mm must be a finite"),
        ((386, 30, 60, 91), "tilt_deg must be -90 to 90, not 91"),
    ],
)
def test_impossible_geometry(values: tuple[float, float, float, float], message: str) -> None:
    """A geometry that no robot has is refused where it is made."""
    with pytest.raises(RecordingError, match=message):
        StereoGeometry(*values)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (np.zeros((8, 16), np.int32), r"shape \(2, 8, 16\) for 16x8 pixels, not int32 of shape \(8, 16\)"),
        (np.zeros((2, 8, 16), np.int64), "must be int32"),
        (np.full((2, 8, 16), 8, np.int32), r"rows 0 to 7 .*, not at row 8 and column 8 \(pixel x 0, y 0\)"),
        (np.indices((9, 17), np.int32)[:, 1:, 1:], r"not at row 1 and column 16 \(pixel x 15, y 0\)"),
        (np.indices((8, 16), np.int32) - 1, r"not at row -1 and column 0 \(pixel x 1, y 0\)"),
    ],
)
def test_impossible_table(tmp_path: Path, table: np.ndarray, message: str) -> None:
    """A table that would read outside the picture never gets into a recording."""
    good = np.full((2, 8, 16), -1, np.int32)
    with pytest.raises(RecordingError, match=f"right rectification table .*{message}"):
        RecordingWriter(
            tmp_path / "a.mcap", width=16, height=8, rectification=RectificationTables(good, table)
        )


@pytest.mark.parametrize("disparity", [np.zeros((8, 16)), np.zeros((16, 8), np.float32)])
def test_impossible_disparity(tmp_path: Path, disparity: np.ndarray) -> None:
    """Disparities of another type or size than the picture's pixels are refused with the frame."""
    image = np.zeros((8, 32), np.uint8)
    with (
        pytest.raises(RecordingError, match=r"disparity must be float32 of shape \(8, 16\), not .*frame 0"),
        RecordingWriter(tmp_path / "a.mcap", width=16, height=8) as writer,
    ):
        writer.add(image, image, 1, 1, disparity_px=disparity)


def test_full_disk(tmp_path: Path) -> None:
    """A disk that takes no more is an error of the recording, and nothing is left on it."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(RecordingError, match=r"a\.mcap: recording must be writable: File too large"):
            write(tmp_path / "a.mcap")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, handler)
    assert list(tmp_path.iterdir()) == []


def test_folder_that_is_not_there(tmp_path: Path) -> None:
    """A recording into a missing folder, or in the place of a folder or a device, is refused at once."""
    with pytest.raises(RecordingError, match="recording must be writable: No such file or directory"):
        write(tmp_path / "none" / "a.mcap")
    for taken in (tmp_path, Path("/dev/null")):
        with pytest.raises(RecordingError, match="must be a file, not a folder or a device"):
            write(taken)
