"""Recordings that other programs wrote: read where they can be, refused with the reason where not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from mcap.writer import Writer
from mcap_protobuf.schema import register_schema

from bfsim.errors import RecordingError
from bfsim.recording import RecordingReader

LEFT, RIGHT = "/camera/left/image_raw", "/camera/right/image_raw"
WIDTH, HEIGHT = 16, 8


def raw_image(width: int = WIDTH, height: int = HEIGHT, **fields: object) -> bytes:
    """Return a foreign image message; `fields` replace the right ones."""
    right = {
        "width": width,
        "height": height,
        "encoding": "uyvy",
        "step": 2 * width,
        "data": bytes(2 * width * height),
    }
    return RawImage(**(right | fields)).SerializeToString()  # type: ignore[arg-type]


def write_foreign(path: Path, messages: list[tuple[str, int, bytes]]) -> Path:
    """Write an MCAP as another program might: (topic, stamp, data), in this order."""
    with path.open("wb") as stream:
        mcap = Writer(stream, chunk_size=4096)
        mcap.start()
        schema = register_schema(mcap, RawImage)
        channels: dict[str, int] = {}
        for topic, time_ns, data in messages:
            if topic not in channels:
                channels[topic] = mcap.register_channel(topic, "protobuf", schema)
            mcap.add_message(channels[topic], time_ns, data, time_ns)
        mcap.finish()  # type: ignore[no-untyped-call]
    return path


def test_foreign_recording(tmp_path: Path) -> None:
    """All left images before all right ones, rows padded, encoding named yuv422: still paired one by one."""
    padded = raw_image(encoding="yuv422", step=2 * WIDTH + 8, data=bytes(range(40)) * HEIGHT)
    lefts = [(LEFT, k * 1000, padded) for k in range(20)]
    rights = [(RIGHT, k * 1000 + 400, raw_image(data=bytes([k]) * 2 * WIDTH * HEIGHT)) for k in range(20)]
    with RecordingReader(write_foreign(tmp_path / "a.mcap", lefts + rights)) as reader:
        frames = list(reader.frames())
    assert [(frame.left_ns, frame.right_ns) for frame in frames] == [
        (k * 1000, k * 1000 + 400) for k in range(20)
    ]
    assert [frame.right[0, 0] for frame in frames] == list(range(20))
    assert frames[0].left.shape == (HEIGHT, 2 * WIDTH)
    assert frames[0].left[3].tolist() == list(range(32))


BOTH = [(LEFT, 0, raw_image()), (RIGHT, 0, raw_image())]


@pytest.mark.parametrize(
    ("messages", "message"),
    [
        (
            [("/cam0", 0, raw_image()), ("/imu", 0, b"")],
            r"must have the topics .*left.* and .*right.*, not /cam0, /imu",
        ),
        (
            [*BOTH, (LEFT, 1, raw_image())],
            "as many images from the left camera as from the right, not 2 and 1",
        ),
        (
            [(LEFT, 0, raw_image()), (RIGHT, 0, raw_image(18))],
            r"one size, not 16x8 \(left\) and 18x8 \(right\)",
        ),
        (
            [*BOTH, (LEFT, 1, raw_image()), (RIGHT, 1, raw_image(16, 10))],
            r"size of the first, 16x8, not 16x10 .*right/image_raw, image 1",
        ),
        ([(LEFT, 0, raw_image(15)), (RIGHT, 0, raw_image(15))], r"width must be even .* not 15x8 .*image 0"),
        ([(LEFT, 0, raw_image(0, 0)), (RIGHT, 0, raw_image())], "no side 0, not 0x0"),
        ([(LEFT, 0, raw_image(encoding="rgb8")), BOTH[1]], "must be in UYVY .* not 'rgb8'"),
        ([(LEFT, 0, raw_image(data=b"abc")), BOTH[1]], "must have 256 bytes, not 3"),
        ([(LEFT, 0, raw_image(step=4)), BOTH[1]], "rows of at least 32 bytes, not 4"),
        ([(LEFT, 0, b"\xff\xff"), BOTH[1]], "must be a foxglove.RawImage message, not 2 other bytes"),
        ([*BOTH, *BOTH], "time stamps must rise, but 0 ns comes twice"),
    ],
)
def test_foreign_recording_that_cannot_be_used(
    tmp_path: Path, messages: list[tuple[str, int, bytes]], message: str
) -> None:
    """Whatever a foreign file claims is checked against what it holds, and the message says where."""
    path = write_foreign(tmp_path / "a.mcap", messages)
    with pytest.raises(RecordingError, match=message) as caught, RecordingReader(path) as reader:
        list(reader.frames())
    assert str(path) in str(caught.value)


def test_wrong_schema(tmp_path: Path) -> None:
    """A topic of the right name with other messages in it is refused with the schema it has."""
    path = tmp_path / "a.mcap"
    with path.open("wb") as stream:
        mcap = Writer(stream)
        mcap.start()
        schema = mcap.register_schema("sensor_msgs/msg/Image", "ros2msg", b"")
        for topic in (LEFT, RIGHT):
            mcap.add_message(mcap.register_channel(topic, "cdr", schema), 0, b"data", 0)
        mcap.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(
        RecordingError, match=r"must hold foxglove\.RawImage .* not sensor_msgs/msg/Image in cdr"
    ):
        RecordingReader(path)


def test_pickled_table_is_not_run(tmp_path: Path) -> None:
    """An attachment that holds a pickle is refused, not loaded."""
    path = tmp_path / "a.mcap"
    pickled = tmp_path / "evil.npy"
    np.save(pickled, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    write_foreign(path, BOTH)
    with path.open("wb") as stream:
        mcap = Writer(stream)
        mcap.start()
        for side in ("left", "right"):
            mcap.add_attachment(0, 0, f"rectification_{side}.npy", "", pickled.read_bytes())
        schema = register_schema(mcap, RawImage)
        for topic in (LEFT, RIGHT):
            mcap.add_message(mcap.register_channel(topic, "protobuf", schema), 0, raw_image(), 0)
        mcap.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(RecordingError, match=r"a\.mcap: rectification table must be a \.npy array"):
        RecordingReader(path)
