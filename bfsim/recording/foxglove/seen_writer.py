"""Write what was seen to an MCAP file for Foxglove and rerun: marked pictures, and objects, lines and edges in space.

These messages have Foxglove's own schemas. With them are the numbers of each frame, for plots, in protobuf schemas of
their names. All carry the time at which the picture was taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

from foxglove_schemas_protobuf.Log_pb2 import Log
from mcap.writer import Writer
from mcap_protobuf.schema import register_schema

from bfsim import __version__
from bfsim.errors import RecordingError
from bfsim.recording import layout
from bfsim.recording.container import McapContainer
from bfsim.recording.foxglove.number_messages import NumberMessages
from bfsim.recording.foxglove.seen_pictures import features_message, heat_message, image_message
from bfsim.recording.foxglove.seen_space import (
    calibration_message,
    edges_message,
    lines_message,
    objects_message,
    transforms_message,
)
from bfsim.recording.growing_file import growing_file, writing
from bfsim.seen import SeenFrame
from bfsim.seen.heat import hottest_row_us

IMAGE_TOPIC = "/camera/{}/image_rect"
HEAT_TOPIC = "/camera/{}/heat"
CALIBRATION_TOPIC = "/camera/{}/calibration"
FEATURES_TOPIC = "/camera/{}/features"
TRANSFORMS_TOPIC = "/transforms"
OBJECTS_TOPIC = "/seen/objects"
LINES_TOPIC = "/seen/lines_3d"
EDGES_TOPIC = "/seen/edges_3d"
WARNINGS_TOPIC = "/warnings"


class SeenWriter:
    """Context manager that writes one file; it appears on a clean exit of the `with` block, or not at all.

    Raises RecordingError if the file cannot be written or is already another kind of file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._times_ns: dict[int, int] = {}
        self._numbers = NumberMessages()
        if not path.name or path.is_dir():
            raise RecordingError(f"{path}: --mcap must be a file, not a folder")
        if path.exists() and not _is_ours(path):
            raise RecordingError(
                f"{path}: --mcap must be a new file or what an earlier run saw, not another file"
            )

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            stream: IO[bytes] = stack.enter_context(growing_file(self.path))
            with writing(self.path):
                self._mcap = Writer(stream, chunk_size=layout.CHUNK_BYTES)
                self._mcap.start(profile="", library=layout.LIBRARY_PREFIX + __version__)
            self._file = stack.pop_all()
        return self

    def add(self, frame: SeenFrame) -> None:
        """Append what was seen in a frame; frames come in order of time."""
        self._times_ns[frame.index] = frame.time_ns
        for topic, time_ns, message in sorted(self._messages(frame), key=lambda each: each[1]):
            self._write(topic, time_ns, message, frame.index)

    def has(self, frame: int) -> bool:
        """Whether something was seen in a frame: other frames have no picture and no known time."""
        return frame in self._times_ns

    def add_numbers(self, frame: int, topic: str, kind: str, numbers: Mapping[str, float]) -> None:
        """Append numbers of a frame in which something was seen; all numbers of a kind have the same names."""
        self._write(topic, self._times_ns[frame], self._numbers.message(kind, frame, numbers), frame)

    def add_note(self, frame: int, text: str, *, is_warning: bool) -> None:
        """Append a sentence about a frame in which something was seen."""
        time_ns = self._times_ns[frame]
        message = Log(level=Log.WARNING if is_warning else Log.INFO, message=text, name="bfsim")
        message.timestamp.FromNanoseconds(time_ns)
        self._write(WARNINGS_TOPIC, time_ns, message, frame)

    def _write(self, topic: str, time_ns: int, message: Any, frame: int) -> None:
        data = message.SerializeToString(deterministic=True)
        with writing(self.path):
            channel = self._channel(topic, message)
            self._mcap.add_message(channel, time_ns, data, time_ns, sequence=frame)

    def _messages(self, frame: SeenFrame) -> Iterator[tuple[str, int, Any]]:
        """Yield topic, time and message of everything that was seen in a frame."""
        time_ns, tilt_deg = frame.time_ns, 0.0
        for geometry in list(frame.geometries.values())[:1]:  # the cameras are parallel, one rig
            tilt_deg = geometry.tilt_deg
            yield TRANSFORMS_TOPIC, time_ns, transforms_message(geometry, time_ns)
        hottest_us = hottest_row_us(each.heat for each in frame.cameras if each.heat)
        for seen in frame.cameras:
            camera, taken_ns = seen.camera, frame.times_ns[seen.camera]
            yield IMAGE_TOPIC.format(camera), taken_ns, image_message(seen, taken_ns)
            if seen.heat:
                message = heat_message(seen, seen.heat, hottest_us, taken_ns)
                yield HEAT_TOPIC.format(camera), taken_ns, message
            yield FEATURES_TOPIC.format(camera), taken_ns, features_message(seen, frame.objects, taken_ns)
            if seen.geometry:
                size_px = seen.width_px, seen.height_px
                calibration = calibration_message(seen.geometry, camera, size_px, taken_ns)
                yield CALIBRATION_TOPIC.format(camera), taken_ns, calibration
        yield OBJECTS_TOPIC, time_ns, objects_message(frame.objects, tilt_deg, time_ns)
        yield LINES_TOPIC, time_ns, lines_message(frame.lines_3d, time_ns)
        yield EDGES_TOPIC, time_ns, edges_message(frame.edges_3d(), time_ns)

    def _channel(self, topic: str, message: Any) -> int:
        """Return the channel of a topic, which is opened with its first message."""
        if topic not in self._channels:
            kind = message.DESCRIPTOR.full_name
            if kind not in self._schemas:
                self._schemas[kind] = register_schema(self._mcap, type(message))
            self._channels[topic] = self._mcap.register_channel(topic, "protobuf", self._schemas[kind])
        return self._channels[topic]

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None:
            self._file.__exit__(kind, error, trace)
            return
        with self._file, writing(self.path):
            self._mcap.finish()  # type: ignore[no-untyped-call]  # mcap left this one unannotated


def _is_ours(path: Path) -> bool:
    """Whether a file was written by `SeenWriter` before, and is not a recording or anything else."""
    try:
        container = McapContainer(path)
    except RecordingError:
        return False
    try:
        return container.channel(OBJECTS_TOPIC) is not None
    finally:
        container.close()
