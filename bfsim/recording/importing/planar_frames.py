"""Frames of planes of pixels, as they lie in a file without a container."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np

from bfsim.errors import RecordingError
from bfsim.recording.planes import YuvPlanes


@dataclass(frozen=True, slots=True)
class PlanarLayout:
    """The layout of a frame in the file: planes one after the other, colour divided by (columns, rows)."""

    width: int
    height: int
    subsampling: tuple[int, int]

    @property
    def chroma_shape(self) -> tuple[int, int]:
        """Rows and columns of a plane of colour; (0, 0) for grey."""
        columns, rows = self.subsampling
        return (-(-self.height // rows), -(-self.width // columns)) if columns else (0, 0)

    @property
    def frame_bytes(self) -> int:
        """Bytes of a frame."""
        return self.width * self.height + 2 * self.chroma_shape[0] * self.chroma_shape[1]

    def planes(self, data: bytes) -> YuvPlanes:
        """Return the planes of a frame, which `data` is."""
        pixels = np.frombuffer(data, np.uint8)
        luma_bytes = self.width * self.height
        y = pixels[:luma_bytes].reshape(self.height, self.width)
        if self.subsampling == (0, 0):
            return YuvPlanes.from_grey(y)
        u, v = pixels[luma_bytes:].reshape(2, *self.chroma_shape)
        return YuvPlanes(y, u, v)


def opened(source: str) -> IO[bytes]:
    """Open a file of frames. Raises RecordingError if it cannot be read."""
    try:
        return Path(source).open("rb")
    except OSError as error:
        raise RecordingError(f"{source}: source must be a readable file: {error.strerror}") from None


def read_frame(stream: IO[bytes], frame_bytes: int, source: str, index: int) -> bytes:
    """Return the bytes of the next frame, number `index`. Raises RecordingError if the file breaks off in it."""
    start = stream.tell()
    data = stream.read(frame_bytes)
    if len(data) < frame_bytes:
        raise RecordingError(
            f"{source}: frame {index} must have {frame_bytes} bytes, not {len(data)}: the file breaks off "
            f"(frame starts at byte {start})"
        )
    return data
