"""Read a recording frame by frame, with memory that does not depend on its length."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterator, Mapping
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from mcap.records import Message

from bfsim.errors import RecordingError, cut, shown
from bfsim.recording import layout
from bfsim.recording.container import McapContainer
from bfsim.recording.frames import (
    DisparityImage,
    RectificationTables,
    StereoFrame,
    StereoGeometry,
    UyvyImage,
)
from bfsim.recording.messages import disparity_of, image_of, picture_of, truth_of

if TYPE_CHECKING:
    from bfsim.recording.calibration_report import CalibrationReport

# One camera may start before the other. If it is further ahead, its clock is a different one, and waiting would fill
# the memory.
_AHEAD_BYTES = 64 << 20
_AHEAD_PICTURES = 2  # of any size


class RecordingReader:
    """Context manager that opens one recording; its properties are checked and known from the start.

    width and height are in pixels and the same for both cameras. frame_count is the number of stereo frames. geometry,
    rectification and calibration are None if the recording has none. library names the program that wrote the file.
    Everything raises RecordingError.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._file = McapContainer(path)
        self.path = self._file.path
        try:
            self._check_channels()
            self.width, self.height = self._image_size()
            self.frame_count = self._count_frames()
            self.description = self._metadata(layout.DESCRIPTION_RECORD).get("description", "")
            self.geometry = self._read_geometry()
            self.rectification = self._read_rectification()
            self.calibration = self._read_calibration()
        except BaseException:
            self._file.close()
            raise

    @property
    def library(self) -> str:
        """Name of the program that wrote the file."""
        return self._file.library

    @property
    def size_bytes(self) -> int:
        """Size of the file."""
        return self._file.size_bytes

    @property
    def compressions(self) -> list[str]:
        """Compressions of the file's chunks, "" for none."""
        return sorted({index.compression for index in self._file.summary.chunk_indexes})

    @property
    def read_end(self) -> int:
        """The end of the frames that were read so far, in bytes of the file."""
        return self._file.read_end

    def stored_digest(self, end: int) -> str:
        """Return a digest of the file as stored up to byte `end`: if it is the same, so are the frames up to there."""
        return self._file.stored_digest(end)

    def residual_plot(self) -> bytes:
        """The plot (PNG) of how far the chessboards' corners are from those of the fitted cameras.

        Raises RecordingError if the recording is not calibrated.
        """
        plot = self._file.attachment(layout.RESIDUAL_PLOT_NAME)
        if plot is None:
            raise RecordingError(
                f"{self.path}: recording must be calibrated to have a plot of residuals, and is not; "
                "`bfsim record calibrate` does that"
            )
        return plot

    @property
    def truth_count(self) -> int:
        """The number of frames with ground truth."""
        return self._file.message_count(layout.TRUTH_TOPIC)

    @property
    def disparity_count(self) -> int:
        """The number of frames with exact disparities."""
        return self._file.message_count(layout.DISPARITY_TOPIC)

    @property
    def other_topics(self) -> list[str]:
        """Topics of the file that are not bfsim's and that nothing here reads."""
        return sorted(
            {channel.topic for channel in self._file.summary.channels.values()} - set(layout.TOPICS)
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def frames(self, limit: int | None = None) -> Iterator[StereoFrame]:
        """Yield stereo frames from the first, at most `limit`.

        The k-th picture of the left camera is paired with the k-th of the right. The pictures are read-only. Each
        camera's time stamps rise strictly. Raises RecordingError at a frame that is damaged or missing.
        """
        count = self.frame_count if limit is None else min(limit, self.frame_count)
        frames = self._pair()
        for _ in range(count):
            frame = next(frames, None)
            if frame is None:
                raise RecordingError(
                    f"{self.path}: recording must hold {self.frame_count} stereo frames, not fewer"
                )
            yield frame

    def _pair(self) -> Iterator[StereoFrame]:
        waiting: dict[str, deque[Message]] = {layout.LEFT_TOPIC: deque(), layout.RIGHT_TOPIC: deque()}
        truths: dict[int, Mapping[str, Any]] = {}
        disparities: dict[int, DisparityImage] = {}
        last_ns = {layout.LEFT_TOPIC: -1, layout.RIGHT_TOPIC: -1}
        index = 0
        for channel, message in self._file.messages([*waiting, layout.TRUTH_TOPIC, layout.DISPARITY_TOPIC]):
            if channel.topic == layout.TRUTH_TOPIC:
                truths[message.sequence] = truth_of(
                    message, self._place(channel.topic, "frame", message.sequence)
                )
                continue
            if channel.topic == layout.DISPARITY_TOPIC:
                where = self._place(channel.topic, "frame", message.sequence)
                disparities[message.sequence] = disparity_of(message, self.width, self.height, where)
                continue
            where = self._place(channel.topic, "image", index + len(waiting[channel.topic]))
            if message.log_time <= last_ns[channel.topic]:
                raise RecordingError(f"time stamps must rise, but {message.log_time} ns comes twice {where}")
            last_ns[channel.topic] = message.log_time
            waiting[channel.topic].append(message)
            ahead = len(waiting[channel.topic])
            if ahead > _AHEAD_PICTURES and ahead * len(message.data) > _AHEAD_BYTES:
                raise RecordingError(
                    f"left and right camera must be on one clock, but one is far ahead {where}"
                )
            if all(waiting.values()):
                left, right = (queue.popleft() for queue in waiting.values())
                yield StereoFrame(
                    index,
                    self._picture(left, layout.LEFT_TOPIC, index),
                    self._picture(right, layout.RIGHT_TOPIC, index),
                    left.log_time,
                    right.log_time,
                    truths.pop(index, None),
                    disparities.pop(index, None),
                )
                index += 1

    def _picture(self, message: Message, topic: str, index: int) -> UyvyImage:
        return picture_of(message, self.width, self.height, self._place(topic, "image", index))

    def _place(self, topic: str, what: str, index: int) -> str:
        """Return the place of a message, for errors."""
        return f"({self.path}: {topic}, {what} {index})"

    def _check_channels(self) -> None:
        topics = sorted(channel.topic for channel in self._file.summary.channels.values())
        for topic in (layout.LEFT_TOPIC, layout.RIGHT_TOPIC):
            found = self._file.channel(topic)
            if found is None:
                raise RecordingError(
                    f"{self.path}: recording must have the topics {layout.LEFT_TOPIC} and "
                    f"{layout.RIGHT_TOPIC}, not {cut(', '.join(topics)) if topics else 'none'}{self._advice()}"
                )
            channel, schema = found
            name = schema.name if schema else "no schema"
            if (channel.message_encoding, name) != ("protobuf", layout.IMAGE_SCHEMA):
                raise RecordingError(
                    f"{self.path}: topic {topic} must hold {layout.IMAGE_SCHEMA} messages in protobuf, "
                    f"not {cut(name)} in {cut(channel.message_encoding) if channel.message_encoding else 'no encoding'}"
                    f"{self._advice()}"
                )

    def _advice(self) -> str:
        """Say how to make a recording of a ROS 2 bag, if the file is one."""
        is_bag = any(each.name.startswith("sensor_msgs/") for each in self._file.summary.schemas.values())
        return "; `bfsim record import` makes a recording of a bag of ROS" if is_bag else ""

    def _count_frames(self) -> int:
        left, right = (self._file.message_count(topic) for topic in (layout.LEFT_TOPIC, layout.RIGHT_TOPIC))
        if left != right:
            raise RecordingError(
                f"{self.path}: recording must have as many images from the left camera as from the right, "
                f"not {left} and {right}"
            )
        if not left:
            raise RecordingError(f"{self.path}: recording must have at least one stereo frame, not none")
        return left

    def _image_size(self) -> tuple[int, int]:
        sizes = []
        for topic in (layout.LEFT_TOPIC, layout.RIGHT_TOPIC):
            first = next(self._file.messages([topic]), None)
            if first is None:
                raise RecordingError(f"{self.path}: recording must have images in {topic}, not none")
            image = image_of(first[1], self._place(topic, "image", 0))
            sizes.append((image.width, image.height))
        if sizes[0] != sizes[1]:
            (left_width, left_height), (right_width, right_height) = sizes
            raise RecordingError(
                f"{self.path}: images of both cameras must have one size, "
                f"not {left_width}x{left_height} (left) and {right_width}x{right_height} (right)"
            )
        return sizes[0]

    def _metadata(self, name: str) -> dict[str, str]:
        record = self._file.metadata(name)
        if record is None:
            return {}
        try:
            return layout.unseal(record, self.library)
        except ValueError as error:
            raise RecordingError(
                f"{self.path}: metadata {shown(name)} must be readable, but {error}"
            ) from None

    def _read_geometry(self) -> StereoGeometry | None:
        record = self._metadata(layout.GEOMETRY_RECORD)
        if not record:
            return None
        try:
            return StereoGeometry(
                float(record["focal_px"]),
                float(record["baseline_mm"]),
                *(float(record[name]) if name in record else None for name in ("height_mm", "tilt_deg")),
            )
        except KeyError as error:
            raise RecordingError(
                f"{self.path}: metadata {layout.GEOMETRY_RECORD!r} must give {error.args[0]}"
            ) from None
        except ValueError as error:
            raise RecordingError(
                f"{self.path}: metadata {layout.GEOMETRY_RECORD!r}: {cut(str(error))}"
            ) from None

    def _read_calibration(self) -> CalibrationReport | None:
        record = self._metadata(layout.CALIBRATION_RECORD)
        if not record:
            return None
        from bfsim.recording.calibration_report import CalibrationReport

        try:
            return CalibrationReport.from_json(record.get("json", ""))
        except RecordingError as error:
            raise RecordingError(f"{self.path}: metadata {layout.CALIBRATION_RECORD!r}: {error}") from None

    def _read_rectification(self) -> RectificationTables | None:
        found = {side: self._file.attachment(name) for side, name in layout.RECTIFICATION_NAMES.items()}
        tables = {side: data for side, data in found.items() if data is not None}
        if not tables:
            return None
        if len(tables) < len(found):
            raise RecordingError(f"{self.path}: rectification tables must be there for both cameras, not one")
        try:
            rectification = RectificationTables(
                **{side: layout.table_from_npy(data) for side, data in tables.items()}
            )
            rectification.check(self.width, self.height)
        except RecordingError as error:
            raise RecordingError(f"{self.path}: {error}") from None
        return rectification
