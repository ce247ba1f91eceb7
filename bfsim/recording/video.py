"""Pictures from a video in any container and codec that FFmpeg reads, through the optional package PyAV."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

import numpy as np

from bfsim.errors import RecordingError
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.sources import PictureSource


def open_video(source: str) -> PictureSource:
    """The first video stream of a file, upright as it says, in full-range BT.601 whatever range and matrix it was coded in."""
    with _stream_of(source) as (_, stream):
        rate = stream.average_rate
        first = next(_pictures(source), None)
        if first is None:
            raise RecordingError(
                f"{source}: video must have at least one frame that can be decoded, not none"
            )
        return PictureSource(
            name=source,
            size=first.size,
            count=None,
            fps=Fraction(rate) if rate else None,
            pictures=lambda: _pictures(source),
        )


def _pictures(source: str) -> Iterator[YuvPlanes]:
    size = None
    with _stream_of(source) as (container, stream):
        for index, frame in enumerate(container.decode(stream)):
            full_range = frame.reformat(format="yuv444p", dst_colorspace="ITU601", dst_color_range="JPEG")
            # A phone stores its pictures as its sensor lies, and beside them by how many degrees to turn them, counterclockwise.
            quarters = round(frame.rotation / 90)
            picture = YuvPlanes(*(np.rot90(plane, quarters) for plane in full_range.to_ndarray()))
            size = size or picture.size
            if picture.size != size:
                width, height = picture.size
                raise RecordingError(
                    f"{source}: frame {index} must be {size[0]}x{size[1]} like the first, not {width}x{height}"
                )
            yield picture


@contextmanager
def _stream_of(source: str) -> Iterator[tuple[Any, Any]]:
    """Open the file; yield its container and its first video stream."""
    try:
        import av
    except ImportError:
        raise RecordingError(
            f'{source}: reading video needs the package PyAV; install it with: pip install "bfsim[video]"'
        ) from None
    try:
        with av.open(source) as container:
            if not container.streams.video:
                kinds = ", ".join(sorted({each.type for each in container.streams})) or "none at all"
                raise RecordingError(f"{source}: file must be whole and have a video stream, not {kinds}")
            yield container, container.streams.video[0]
    except (av.FFmpegError, OSError) as error:
        raise RecordingError(f"{source}: video must be readable: {error.strerror}") from None
