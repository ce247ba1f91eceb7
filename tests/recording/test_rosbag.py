"""`record import` of bags: which pixels come of which encoding, and pictures that are none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording import RecordingReader
from bfsim.recording.importing.importer import import_recording
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.ros.ros_images import ENCODINGS
from tests.recording.bag_imports import COMPRESSED, IMAGE, each_kind, greys, imported
from tests.recording.bags import (
    EPOCH_NS,
    LEFT,
    PERIOD_NS,
    RIGHT,
    Message,
    Ros,
    grey_pair,
    grey_rows,
)


def bytes_of(picture: NDArray[np.uint8], encoding: str) -> NDArray[np.uint8]:
    """Rows of an RGB picture (height, width, 3) as an encoding has them; YUV is of the same picture's planes."""
    height, width, _ = picture.shape
    full = np.full((height, width, 1), 77, np.uint8)
    uyvy = YuvPlanes.from_image(Image.fromarray(picture)).to_uyvy()
    rows = {
        "rgb8": picture,
        "bgr8": picture[..., ::-1],
        "rgba8": np.concatenate([picture, full], axis=2),
        "bgra8": np.concatenate([picture[..., ::-1], full], axis=2),
        "8UC3": picture[..., ::-1],
        "8UC4": np.concatenate([picture[..., ::-1], full], axis=2),
        "uyvy": uyvy,
        "yuv422": uyvy,
        "yuyv": uyvy.reshape(height, width, 2)[..., ::-1],
        "yuv422_yuy2": uyvy.reshape(height, width, 2)[..., ::-1],
    }
    return np.ascontiguousarray(rows[encoding]).reshape(height, -1)


def one_pair(ros: Ros, message: object, kind: str = IMAGE) -> list[Message]:
    """One stereo frame of one picture."""
    return [(topic, kind, EPOCH_NS, message) for topic in (LEFT, RIGHT)]


@each_kind
@pytest.mark.parametrize(
    "encoding", ["rgb8", "bgr8", "rgba8", "bgra8", "8UC3", "8UC4", "uyvy", "yuv422", "yuyv", "yuv422_yuy2"]
)
def test_colours_are_those_of_the_picture(kind: str, encoding: str, tmp_path: Path) -> None:
    """Whatever the order of their bytes, and with rows that are padded."""
    picture = np.random.default_rng(561).integers(0, 256, (6, 10, 3), np.uint8)
    rows = np.pad(bytes_of(picture, encoding), ((0, 0), (0, 5)))
    ros = Ros(kind)
    (frame,) = imported(ros.write(tmp_path, one_pair(ros, ros.image(EPOCH_NS, encoding, rows, 10))))
    assert np.array_equal(frame.left, YuvPlanes.from_image(Image.fromarray(picture)).to_uyvy())
    assert np.array_equal(frame.right, frame.left)


def test_colours_without_an_order_are_told_of(tmp_path: Path) -> None:
    """As OpenCV has them, blue first, which nobody can know: a yellow ball would be cyan."""
    ros = Ros("ros2")
    path = ros.write(tmp_path, one_pair(ros, ros.image(EPOCH_NS, "8UC3", np.zeros((6, 30), np.uint8), 10)))
    summary = import_recording([path], tmp_path / "out.mcap")
    assert "8UC3 says no order of colours: BGR is taken, as OpenCV has it." in summary.notes


@pytest.mark.parametrize(
    ("encoding", "corner"),
    [("bayer_rggb8", "rggb"), ("bayer_bggr8", "bggr"), ("bayer_gbrg8", "gbrg"), ("bayer_grbg8", "grbg")],
)
def test_a_bayer_pattern_of_one_colour_is_that_colour(encoding: str, corner: str, tmp_path: Path) -> None:
    """Each pixel of the pattern has its own colour's value."""
    values = {"r": 200, "g": 120, "b": 40}
    pattern = np.array([values[each] for each in corner], np.uint8).reshape(2, 2)
    ros = Ros("ros1")
    (frame,) = imported(
        ros.write(tmp_path, one_pair(ros, ros.image(EPOCH_NS, encoding, np.tile(pattern, (4, 5)), 10)))
    )
    expected = YuvPlanes.from_image(Image.new("RGB", (10, 8), (200, 120, 40))).to_uyvy()
    assert np.array_equal(frame.left, expected)


@pytest.mark.parametrize("encoding", ["mono16", "16UC1", "bayer_rggb16"])
@pytest.mark.parametrize("is_bigendian", [False, True])
def test_of_pixels_of_16_bits_the_upper_8_that_the_camera_uses_are_taken(
    encoding: str, is_bigendian: bool, tmp_path: Path
) -> None:
    """In either order of their bytes; in the same bag, a picture of 8 bits has none to spare."""
    pixels = np.full((4, 8), 0xC8F, ">u2" if is_bigendian else "<u2").view(np.uint8)
    ros = Ros("ros1")
    deep = ros.image(EPOCH_NS, encoding, pixels, 8, is_bigendian=is_bigendian)
    path = ros.write(tmp_path, [*one_pair(ros, deep), *grey_pair(ros, [1])])
    summary = import_recording([path], tmp_path / "out.mcap", bits=12)
    assert summary.frame_count == 1
    assert "must be one of mono16, 16UC1, bayer_rggb16, " in summary.skipped[0].reason
    with RecordingReader(tmp_path / "out.mcap") as reader:
        assert set(next(reader.frames()).left[:, 1::2].flat) == {0xC8}


@each_kind
@pytest.mark.parametrize("form", ["png", "jpeg"])
def test_compressed_pictures_are_decoded(kind: str, form: str, tmp_path: Path) -> None:
    """PNG to the bit, JPEG nearly, of one colour."""
    picture = Image.new("RGB", (16, 16), (200, 120, 40))
    ros = Ros(kind)
    messages = [
        (f"{topic}/compressed", COMPRESSED, EPOCH_NS, ros.compressed(EPOCH_NS, picture, form))
        for topic in (LEFT, RIGHT)
    ]
    (frame,) = imported(ros.write(tmp_path, messages))
    off = np.abs(frame.left.astype(int) - YuvPlanes.from_image(picture).to_uyvy())
    assert off.max() <= (2 if form == "jpeg" else 0)


def test_resize_and_one_camera(tmp_path: Path) -> None:
    """As of pictures from anywhere else."""
    ros = Ros("ros1")
    messages = [each for each in grey_pair(ros, range(3), size=(16, 8)) if each[0] == LEFT]
    path = ros.write(tmp_path, messages)
    frames = imported(path, mono=True, resize=(8, 4))
    assert greys(frames) == [(10 + k, 10 + k) for k in range(3)]
    assert (
        [each.left_ns for each in frames]
        == [each.right_ns for each in frames]
        == [0, PERIOD_NS, 2 * PERIOD_NS]
    )
    halves = imported(path, side_by_side=True, topics=(LEFT, LEFT))
    assert halves[0].left.shape == (8, 16)


@pytest.mark.parametrize(
    ("how", "reason"),
    [
        ({"encoding": "rgb16"}, f"encoding must be one of {', '.join(ENCODINGS)}, not 'rgb16'"),
        (
            {"encoding": "mono16", "width": 4},
            "pixels must have 8 bits, or 16 of which `bfsim record import --bits` says",
        ),
        ({"encoding": ""}, "encoding must be one of"),
        (
            {"encoding": "rgb8"},
            "picture of 8x4 must have rows of 24 bytes or more and 4 of them, not 32 bytes in rows of 8",
        ),
        ({"step": 4}, "not 32 bytes in rows of 4"),
        ({"height": 5}, "rows of 8 bytes or more and 5 of them, not 32 bytes"),
        ({"height": 0}, "picture must have 1 pixel at least and 67,108,864 bytes at most, not be 8x0"),
        ({"width": 4_000_000_000}, "at most, not be 4000000000x4"),
        ({"encoding": "uyvy", "width": 3}, "uyvy must have an even width, not 3"),
    ],
)
def test_a_picture_that_is_none_is_skipped_with_its_partner(
    how: dict[str, object], reason: str, tmp_path: Path
) -> None:
    """The others stay; a bag of nothing else is refused."""
    ros = Ros("ros1")
    bad = {"encoding": "mono8", "width": 8, "height": 4, "step": 8} | how
    rows = grey_rows(50)
    message = ros.image(
        EPOCH_NS + PERIOD_NS, bad["encoding"], rows, bad["width"], height=bad["height"], step=bad["step"]
    )
    messages = grey_pair(ros, range(3))
    messages[2] = (LEFT, IMAGE, EPOCH_NS + PERIOD_NS, message)
    path = ros.write(tmp_path, messages)
    summary = import_recording([path], tmp_path / "out.mcap")
    assert summary.frame_count == 2
    assert [each.name for each in summary.skipped] == [f"{LEFT} 1"]
    assert reason in summary.skipped[0].reason
    alone = tmp_path / "alone"
    alone.mkdir()
    with pytest.raises(RecordingError, match="and no picture is left"):
        imported(ros.write(alone, one_pair(ros, message)))


def test_bytes_that_are_no_jpeg_are_skipped(tmp_path: Path) -> None:
    """Text, another format, and half a picture."""
    ros = Ros("mcap")
    types = ros.store.types["sensor_msgs/msg/CompressedImage"]
    whole = ros.compressed(EPOCH_NS, Image.new("RGB", (16, 16)), "jpeg")
    messages = []
    for k, data in enumerate(
        [whole.data, np.frombuffer(b"hello", np.uint8), whole.data[:200], whole.data[:0]]
    ):
        at = EPOCH_NS + k * PERIOD_NS
        message = types(header=ros.header(at), format="jpeg", data=data)
        messages += [(topic, COMPRESSED, at, message) for topic in (LEFT, RIGHT)]
    summary = import_recording([ros.write(tmp_path, messages)], tmp_path / "out.mcap")
    assert summary.frame_count == 1
    assert len(summary.skipped) == 6


def test_another_size_is_refused_unless_pictures_are_fitted(tmp_path: Path) -> None:
    """As in a folder."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, [*grey_pair(ros, [0]), *grey_pair(ros, [1], size=(16, 8))])
    with pytest.raises(
        RecordingError, match=f"{LEFT} 1: picture must be 8x4 like the first, not 16x8; `--resize`"
    ):
        imported(path)
    assert len(imported(path, resize=(8, 4))) == 2


def test_a_size_that_no_recording_has_is_told_with_the_bag(tmp_path: Path) -> None:
    """Its topic alone may be in many bags."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, grey_pair(ros, [0], size=(7, 4)))
    with pytest.raises(RecordingError, match=f"{path}: {LEFT}: image width must be even .* not 7"):
        imported(path)
