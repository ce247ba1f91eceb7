"""Pictures from a video in any container and codec that FFmpeg reads, through the optional package PyAV."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

from bfsim.errors import RecordingError
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.sources import PictureSource


def open_video(source: str) -> PictureSource:
    """The first video stream of a file, in full-range BT.601 whatever range and matrix it was coded in."""
    with _stream_of(source) as (_, stream):
        rate = stream.average_rate
        return PictureSource(
            name=source,
            size=(stream.width, stream.height),
            count=None,
            fps=Fraction(rate) if rate else None,
            pictures=lambda: _pictures(source),
        )


def _pictures(source: str) -> Iterator[YuvPlanes]:
    with _stream_of(source) as (container, stream):
        size = stream.width, stream.height
        for index, frame in enumerate(container.decode(stream)):
            if (frame.width, frame.height) != size:
                raise RecordingError(
                    f"{source}: frame {index} must be {size[0]}x{size[1]} like the first, "
                    f"not {frame.width}x{frame.height}"
                )
            full_range = frame.reformat(format="yuv444p", dst_colorspace="ITU601", dst_color_range="JPEG")
            yield YuvPlanes(*full_range.to_ndarray())


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
                raise RecordingError(f"{source}: file must have a video stream, not only other kinds")
            yield container, container.streams.video[0]
    except (av.FFmpegError, OSError) as error:
        raise RecordingError(f"{source}: video must be readable: {error.strerror}") from None
