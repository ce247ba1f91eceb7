"""One bag of ROS 1 or ROS 2 as a file: its topics, and the messages of one, through the optional package rosbags.

Nothing in a bag is executed: its messages are read by ROS's own definitions, never by those in the bag, of which
rosbags would make Python code.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from bfsim.errors import RecordingError, cut
from bfsim.recording.container import McapContainer
from bfsim.recording.layout import LEFT_TOPIC, RIGHT_TOPIC

METADATA = "metadata.yaml"
"""The file that is in the folder of a ROS 2 bag besides its data."""

ZSTANDARD = b"\x28\xb5\x2f\xfd"
"""The first bytes of what Zstandard compressed, such as each message of a ROS 2 bag of compression mode `message`."""
WHERE_COMPRESSION_IS = f"as {METADATA} beside it says: give the folder with both"


@dataclass(frozen=True, slots=True)
class Topic:
    """The type and the number of a topic's messages."""

    name: str
    kind: str
    count: int

    def __str__(self) -> str:
        return f"{self.name} ({self.kind.replace('/msg/', '/')}, {self.count:,})"


class BagFile:
    """One bag, which is opened anew for each reading. Raises RecordingError for anything wrong with it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.is_ros1 = path.suffix.lower() == ".bag"

    def topics(self) -> list[Topic]:
        """Return all topics of the bag."""
        with self._open() as reader:
            return [
                Topic(name, info.msgtype or "of several types", info.msgcount)
                for name, info in sorted(reader.topics.items())
            ]

    def messages(self, topic: str) -> Iterator[tuple[int, bytes]]:
        """Yield the time at which each message of a topic was logged, in ns, and its bytes.

        Raises RecordingError if they are not as ROS defines their type.
        """
        with self._open() as reader:
            connections = [each for each in reader.connections if each.topic == topic]
            for connection, time_ns, raw in reader.messages(connections=connections):
                if self.is_ros1 and connection.digest not in (_ros1_digest(connection.msgtype), "*"):
                    raise RecordingError(
                        f"{self.path}: {topic} must have {connection.msgtype} as ROS defines it, not another"
                    )
                yield time_ns, bytes(raw)

    def stamp_ns(self, raw: bytes) -> int:
        """Return the time stamp in the header of a message, its first field. Raises RecordingError if it has none."""
        try:
            if self.is_ros1:
                _, seconds, nanoseconds = struct.unpack_from("<III", raw)
            else:
                seconds, nanoseconds = struct.unpack_from("<iI" if raw[1:2] == b"\x01" else ">iI", raw, 4)
        except struct.error:
            raise RecordingError(f"{self.path}: a message must have a header, not {len(raw)} bytes") from None
        return int(seconds) * 1_000_000_000 + int(nanoseconds)

    def decode(self, raw: bytes, kind: str) -> Any:
        """Return the fields of a message. Raises RecordingError, without the bag's name, if it is not such a message."""
        store = _types(is_ros1=self.is_ros1)
        try:
            return store.deserialize_ros1(raw, kind) if self.is_ros1 else store.deserialize_cdr(raw, kind)
        except Exception as error:  # noqa: BLE001  # bytes of others: the parser may fail in any way
            said = cut(str(error)).rstrip(".")
            if raw.startswith(ZSTANDARD):
                said = f"it is compressed, {WHERE_COMPRESSION_IS}"
            raise RecordingError(f"message must be a {kind}: {said}") from None

    @contextmanager
    def _open(self) -> Iterator[Any]:
        try:
            from rosbags import rosbag1, rosbag2
        except ImportError:
            raise RecordingError(
                f'{self.path}: reading bags needs the package rosbags; install it with: pip install "bfsim[ros]"'
            ) from None
        if not self.path.exists():
            raise RecordingError(f"{self.path}: bag must be a file or a folder, but is not there")
        reader: Callable[[Path], Any] = rosbag1.Reader if self.is_ros1 else rosbag2.Reader
        try:
            with reader(self.path) as bag:
                yield bag
        except RecordingError:
            raise
        except Exception as error:  # noqa: BLE001  # the same
            said = cut(str(error)).rstrip(".") or type(error).__name__
            raise RecordingError(
                f"{self.path}: bag must be whole and of ROS: {said}{self._advice()}"
            ) from None

    def _advice(self) -> str:
        """Say what the file is, or how to repair it."""
        if self.is_ros1:
            return "; `rosbag reindex` may mend it"
        if self.path.suffix.lower() == ".zstd":
            return f"; it is compressed, {WHERE_COMPRESSION_IS}"
        if self.path.is_dir() and not (self.path / METADATA).exists():
            return f"; {METADATA} is written at the end of a recording: `ros2 bag reindex` does it later"
        if advice := _if_of_others(self.path):
            return advice
        has_mcap = self.path.suffix == ".mcap" or any(self.path.glob("*.mcap"))
        return "; `mcap recover` may mend it" if has_mcap else ""


def _if_of_others(path: Path) -> str:
    """Say what an MCAP file is that is whole and has no messages of ROS; nothing about other files."""
    try:
        file = McapContainer(path)
    except RecordingError:
        return ""
    file.close()
    kinds = sorted({each.name for each in file.summary.schemas.values()})
    if any(each.startswith("sensor_msgs/") for each in kinds):
        return ""
    if {LEFT_TOPIC, RIGHT_TOPIC} <= {each.topic for each in file.summary.channels.values()}:
        return "; it is a recording already, which `bfsim run` plays"
    return f"; its messages are not those of ROS but {cut(', '.join(kinds)) or 'none'}"


@cache
def _types(*, is_ros1: bool) -> Any:
    """Return ROS's own definitions of messages."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS1_NOETIC if is_ros1 else Stores.LATEST)


@cache
def _ros1_digest(kind: str) -> str:
    store = _types(is_ros1=True)
    return str(store.generate_msgdef(kind)[1]) if kind in store.fielddefs else ""
