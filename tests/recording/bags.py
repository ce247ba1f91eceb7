"""Small bags of ROS 1 and ROS 2, made with the writers of rosbags."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

KINDS = ("ros1", "mcap", "db3")
LEFT, RIGHT = "/stereo/left/image_raw", "/stereo/right/image_raw"
EPOCH_NS = 1_700_000_000_000_000_000
PERIOD_NS = 40_000_000

Message = tuple[str, str, int, Any]
"""Topic, type, when it was logged in ns, and the message."""


@dataclass
class Ros:
    """One of both generations: makes messages and writes bags."""

    kind: str
    store: Any = field(init=False)

    def __post_init__(self) -> None:
        self.store = get_typestore(Stores.ROS1_NOETIC if self.is_ros1 else Stores.ROS2_HUMBLE)

    @property
    def is_ros1(self) -> bool:
        return self.kind == "ros1"

    def header(self, stamp_ns: int) -> Any:
        types = self.store.types
        stamp = types["builtin_interfaces/msg/Time"](sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
        more = {"seq": 0} if self.is_ros1 else {}
        return types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera", **more)

    def image(
        self,
        stamp_ns: int,
        encoding: str,
        rows: NDArray[np.uint8],
        width: int,
        *,
        height: int | None = None,
        step: int | None = None,
        is_bigendian: bool = False,
    ) -> Any:
        """An Image; `rows` (height, bytes of a row)."""
        return self.store.types["sensor_msgs/msg/Image"](
            header=self.header(stamp_ns),
            height=rows.shape[0] if height is None else height,
            width=width,
            encoding=encoding,
            is_bigendian=int(is_bigendian),
            step=rows.shape[1] if step is None else step,
            data=rows.ravel(),
        )

    def compressed(self, stamp_ns: int, picture: Image.Image, form: str) -> Any:
        stream = BytesIO()
        picture.save(stream, form)
        return self.store.types["sensor_msgs/msg/CompressedImage"](
            header=self.header(stamp_ns), format=form, data=np.frombuffer(stream.getvalue(), np.uint8)
        )

    def camera_info(
        self,
        size: tuple[int, int],
        matrix: Sequence[float],
        projection: Sequence[float],
        *,
        model: str = "plumb_bob",
        distortion: Sequence[float] = (0.0,) * 5,
        rotation: Sequence[float] = (1, 0, 0, 0, 1, 0, 0, 0, 1),
        binning: int = 0,
    ) -> Any:
        letters = "DKRP" if self.is_ros1 else "dkrp"
        numbers = (distortion, matrix, rotation, projection)
        types = self.store.types
        roi = types["sensor_msgs/msg/RegionOfInterest"](
            x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        return types["sensor_msgs/msg/CameraInfo"](
            header=self.header(0),
            width=size[0],
            height=size[1],
            distortion_model=model,
            binning_x=binning,
            binning_y=binning,
            roi=roi,
            **{letter: np.array(each, np.float64) for letter, each in zip(letters, numbers, strict=True)},
        )

    def imu(self) -> Any:
        return self.store.types["std_msgs/msg/String"](data="imu")

    def write(
        self,
        folder: Path,
        messages: Iterable[Message],
        empty: Sequence[tuple[str, str]] = (),
        compression: CompressionMode = CompressionMode.NONE,
    ) -> Path:
        """Write a bag; return the file, or the folder of a ROS 2 bag. `empty` topics have a type and no message."""
        path = folder / ("drive.bag" if self.is_ros1 else f"drive-{self.kind}")
        plugin = StoragePlugin.MCAP if self.kind == "mcap" else StoragePlugin.SQLITE3
        serialize: Callable[..., Any] = (
            self.store.serialize_ros1 if self.is_ros1 else self.store.serialize_cdr
        )
        bag = Writer1(path) if self.is_ros1 else Writer2(path, version=9, storage_plugin=plugin)
        if compression is not CompressionMode.NONE:
            bag.set_compression(compression, CompressionFormat.ZSTD)
        with bag as writer:
            connections = {
                topic: writer.add_connection(topic, kind, typestore=self.store) for topic, kind in empty
            }
            for topic, kind, logged_ns, message in messages:
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, kind, typestore=self.store)
                writer.write(connections[topic], logged_ns, serialize(message, kind))
        return path


def grey_rows(value: int, size: tuple[int, int] = (8, 4)) -> NDArray[np.uint8]:
    """Rows of a picture of one grey."""
    return np.full(size[::-1], value, np.uint8)


def grey_pair(
    ros: Ros, numbers: Iterable[int], right_after_ns: int = 3_000_000, size: tuple[int, int] = (8, 4)
) -> list[Message]:
    """Left and right pictures: the k-th at k periods, of grey 10 + k and 100 + k, the right ones a little later."""
    return [
        (
            topic,
            "sensor_msgs/msg/Image",
            at + 1_000_000,
            ros.image(at, "mono8", grey_rows(grey + k, size), size[0]),
        )
        for k in numbers
        for topic, grey, at in (
            (LEFT, 10, EPOCH_NS + k * PERIOD_NS),
            (RIGHT, 100, EPOCH_NS + k * PERIOD_NS + right_after_ns),
        )
    ]
