"""Write a recording, pair by pair; it appears under its name when it is complete, or not at all."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import IO, TYPE_CHECKING, Any, Self

import numpy as np
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from mcap.writer import Writer
from mcap_protobuf.schema import register_schema
from numpy.typing import NDArray

from bfsim import __version__
from bfsim.errors import RecordingError, shown
from bfsim.recording import layout
from bfsim.recording.frames import DisparityImage, RectificationTables, StereoGeometry, UyvyImage
from bfsim.recording.growing_file import growing_file, writing

if TYPE_CHECKING:
    from bfsim.recording.calibration_report import CalibrationReport

_FRAME_IDS = {layout.LEFT_TOPIC: "left", layout.RIGHT_TOPIC: "right", layout.DISPARITY_TOPIC: "left"}


class RecordingWriter:
    """Context manager that writes one recording.

    The file grows under a temporary name beside `path` and takes its place on a clean exit of the `with`
    block; after an error or Ctrl-C nothing is left and a file that was at `path` before is untouched.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        width: int,
        height: int,
        geometry: StereoGeometry | None = None,
        description: str = "",
        rectification: RectificationTables | None = None,
        calibration: CalibrationReport | None = None,
        residual_plot: bytes | None = None,
    ) -> None:
        self.path = Path(path)
        self.width = width
        self.height = height
        self.frame_count = 0
        self._geometry = geometry
        self._description = description
        self._rectification = rectification
        self._calibration = calibration
        self._residual_plot = residual_plot
        self._last_ns = {layout.LEFT_TOPIC: -1, layout.RIGHT_TOPIC: -1}
        if not self.path.name or (self.path.exists() and not self.path.is_file()):
            raise RecordingError(f"{path}: recording must be a file, not a folder or a device")
        if width <= 0 or width % 2:
            raise RecordingError(
                f"{path}: image width must be even and above 0 (UYVY pixels come in pairs), not {width}"
            )
        if height <= 0:
            raise RecordingError(f"{path}: image height must be above 0, not {height}")
        if 2 * width * height > layout.LARGEST_PICTURE_BYTES:
            most = f"{layout.LARGEST_PICTURE_BYTES >> 20} MiB"
            raise RecordingError(
                f"{path}: image must have at most {most} in UYVY, not {width}x{height} pixels"
            )
        try:
            description.encode()
        except UnicodeEncodeError:
            raise RecordingError(
                f"{path}: description must be text in UTF-8, not {shown(description)}"
            ) from None
        if rectification is not None:
            rectification.check(width, height)

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            stream = stack.enter_context(growing_file(self.path))
            with writing(self.path):
                self._start(stream)
            self._file = stack.pop_all()
        return self

    def _start(self, stream: IO[bytes]) -> None:
        self._mcap = Writer(stream, chunk_size=layout.CHUNK_BYTES)
        self._mcap.start(profile="", library=layout.LIBRARY_PREFIX + __version__)
        self._mcap.add_metadata(layout.DESCRIPTION_RECORD, layout.seal({"description": self._description}))
        if self._geometry is not None:
            known = {name: value for name, value in asdict(self._geometry).items() if value is not None}
            record = {name: repr(float(value)) for name, value in known.items()}
            self._mcap.add_metadata(layout.GEOMETRY_RECORD, layout.seal(record))
        if self._calibration is not None:
            record = {"json": self._calibration.to_json()}
            self._mcap.add_metadata(layout.CALIBRATION_RECORD, layout.seal(record))
        if self._rectification is not None:
            for side, name in layout.RECTIFICATION_NAMES.items():
                data = layout.table_to_npy(getattr(self._rectification, side))
                self._mcap.add_attachment(0, 0, name, "application/octet-stream", data)
        if self._residual_plot is not None:
            self._mcap.add_attachment(0, 0, layout.RESIDUAL_PLOT_NAME, "image/png", self._residual_plot)
        image_schema = register_schema(self._mcap, RawImage)
        truth_schema = self._mcap.register_schema(layout.TRUTH_SCHEMA, "jsonschema", layout.TRUTH_JSON_SCHEMA)
        self._channels = {
            layout.LEFT_TOPIC: self._mcap.register_channel(layout.LEFT_TOPIC, "protobuf", image_schema),
            layout.RIGHT_TOPIC: self._mcap.register_channel(layout.RIGHT_TOPIC, "protobuf", image_schema),
            layout.TRUTH_TOPIC: self._mcap.register_channel(layout.TRUTH_TOPIC, "json", truth_schema),
            layout.DISPARITY_TOPIC: self._mcap.register_channel(
                layout.DISPARITY_TOPIC, "protobuf", image_schema
            ),
        }

    def add(
        self,
        left: UyvyImage,
        right: UyvyImage,
        left_ns: int,
        right_ns: int,
        truth: Mapping[str, Any] | None = None,
        disparity_px: DisparityImage | None = None,
    ) -> None:
        """Append one stereo frame.

        left and right are uint8 of shape (height, 2 * width) in UYVY order; left_ns and right_ns are the times when
        they were taken, later than those of the frame before; truth is anything that JSON can hold; disparity_px is
        float32 of shape (height, width). Raises RecordingError.
        """
        for topic, image, time_ns in (
            (layout.LEFT_TOPIC, left, left_ns),
            (layout.RIGHT_TOPIC, right, right_ns),
        ):
            self._check(topic, image, time_ns)
        # Truth is stamped no later than its pictures, so that a reader in time order has it when the pair is complete.
        truth_ns = min(left_ns, right_ns)
        if truth is not None:
            self._add_message(layout.TRUTH_TOPIC, truth_ns, self._encode_truth(truth))
        if disparity_px is not None:
            self._add_disparity(disparity_px, truth_ns)
        self._add_image(layout.LEFT_TOPIC, left, left_ns)
        self._add_image(layout.RIGHT_TOPIC, right, right_ns)
        self._last_ns = {layout.LEFT_TOPIC: left_ns, layout.RIGHT_TOPIC: right_ns}
        self.frame_count += 1

    def _check(self, topic: str, image: UyvyImage, time_ns: int) -> None:
        where = f"({self.path}: frame {self.frame_count}, {topic})"
        if image.dtype != np.uint8 or image.shape != (self.height, 2 * self.width):
            raise RecordingError(
                f"image must be uint8 of shape ({self.height}, {2 * self.width}), UYVY, "
                f"not {image.dtype} of shape {image.shape} {where}"
            )
        if not self._last_ns[topic] < time_ns <= layout.LAST_NS:
            raise RecordingError(
                f"time stamp must be later than the one before ({self._last_ns[topic]} ns) "
                f"and fit 63 bits, not {time_ns} ns {where}"
            )

    def _add_disparity(self, disparity_px: DisparityImage, time_ns: int) -> None:
        if disparity_px.dtype != np.float32 or disparity_px.shape != (self.height, self.width):
            raise RecordingError(
                f"disparity must be float32 of shape ({self.height}, {self.width}), not {disparity_px.dtype} of "
                f"shape {disparity_px.shape} ({self.path}: frame {self.frame_count})"
            )
        self._add_image(
            layout.DISPARITY_TOPIC, disparity_px.astype("<f4"), time_ns, layout.DISPARITY_ENCODING
        )

    def _add_image(
        self,
        topic: str,
        image: NDArray[Any],
        time_ns: int,
        encoding: str = layout.IMAGE_ENCODINGS[0],
    ) -> None:
        message = RawImage(
            frame_id=_FRAME_IDS[topic],
            width=self.width,
            height=self.height,
            encoding=encoding,
            step=image.nbytes // self.height,
            data=image.tobytes(),
        )
        message.timestamp.FromNanoseconds(time_ns)
        self._add_message(topic, time_ns, message.SerializeToString(deterministic=True))

    def _add_message(self, topic: str, time_ns: int, data: bytes) -> None:
        with writing(self.path):
            self._mcap.add_message(self._channels[topic], time_ns, data, time_ns, sequence=self.frame_count)

    def _encode_truth(self, truth: Mapping[str, Any]) -> bytes:
        try:
            return json.dumps(truth, allow_nan=False, separators=(",", ":")).encode()
        except (TypeError, ValueError) as error:
            raise RecordingError(
                f"ground truth must be plain JSON data: {error} ({self.path}: frame {self.frame_count})"
            ) from None

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None:
            self._file.__exit__(kind, error, trace)
            return
        with self._file:
            self._finish()

    def _finish(self) -> None:
        if self.frame_count == 0:
            raise RecordingError(f"{self.path}: a recording must have at least one stereo frame, not 0")
        with writing(self.path):
            self._mcap.finish()  # type: ignore[no-untyped-call]  # mcap left this one unannotated
