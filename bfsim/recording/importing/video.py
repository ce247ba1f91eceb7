"""Pictures from a video in any container and codec that FFmpeg reads, through the optional package PyAV."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np

from bfsim.errors import RecordingError
from bfsim.recording.importing.sources import PictureSource, Skipped
from bfsim.recording.planes import YuvPlanes

LARGEST_JITTER_S = Fraction(1, 1000)
"""Pictures of an even rate may deviate by less than this, or than a tick of the video's clock."""
DURATION = re.compile(r"(\d+):(\d+):(\d+(?:\.\d+)?)$")


def open_video(source: str) -> PictureSource:
    """Open the first video stream of a file, upright as it says, in full-range BT.601 whatever its range and matrix.

    Pictures that do not come at the video's nominal rate, such as those of phones, keep their times. Raises
    RecordingError if no picture of the file can be decoded, or if PyAV is missing.
    """
    with _stream_of(source) as (container, stream):
        rate = Fraction(stream.average_rate) if stream.average_rate else None
        times_s = sorted(
            each.pts * stream.time_base for each in container.demux(stream) if each.pts is not None
        )
        jitter_s = max(stream.time_base, LARGEST_JITTER_S)
        ends = _break_off(source, times_s, _duration_s(stream), rate)
        first = next((each for each in _pictures(source, []) if isinstance(each, YuvPlanes)), None)
    if first is None:
        raise RecordingError(f"{source}: video must have at least one frame that can be decoded, not none")
    own = PictureSource(
        name=source, size=first.size, count=None, fps=rate, pictures=lambda: _pictures(source, []), notes=ends
    )
    gaps_s = [after - before for before, after in pairwise(times_s)]
    is_even = rate and all(
        abs(time_s - times_s[0] - index / rate) < jitter_s for index, time_s in enumerate(times_s)
    )
    if is_even or not any(gaps_s):
        return own
    least, most = (f"{float(each) * 1000:.0f}" for each in (min(gaps_s), max(gaps_s)))
    apart = least if least == most else f"{least} to {most}"
    times_ns: list[int] = []
    return replace(
        own,
        fps=len(gaps_s) / sum(gaps_s),
        pictures=lambda: _pictures(source, times_ns),
        times_ns=times_ns,
        notes_on_times=(
            f"{source}: pictures are {apart} ms apart, as in the video; `--fps` spaces them evenly",
        ),
    )


def _duration_s(stream: Any) -> Fraction | None:
    """Return the stated length of a stream; Matroska states it in words, 00:00:02.960000000."""
    if stream.duration:
        return Fraction(stream.duration * stream.time_base)
    found = DURATION.match(stream.metadata.get("DURATION", ""))
    if not found:
        return None
    hours, minutes, seconds = map(Fraction, found.groups())
    return 3600 * hours + 60 * minutes + seconds


def _break_off(
    source: str, times_s: list[Fraction], duration_s: Fraction | None, rate: Fraction | None
) -> tuple[str, ...]:
    """Return a note if the pictures end long before the stated end: FFmpeg takes a cut file for a complete one."""
    if not (times_s and duration_s and rate):
        return ()
    longest_s = max([1 / rate, *(after - before for before, after in pairwise(times_s))])
    end_s = times_s[-1] - times_s[0] + longest_s
    if end_s + 2 * longest_s > duration_s:
        return ()
    return (
        f"{source}: the pictures end after {float(end_s):.2f} of {float(duration_s):.2f} s, as if the file were cut off there",
    )


def _pictures(source: str, times_ns: list[int]) -> Iterator[YuvPlanes | Skipped]:
    """Yield the pictures; `times_ns` then says when each of them was taken, from the first one on.

    The decoder makes up parts of a damaged picture; if it says so, the picture is skipped.
    """
    size, ticks = None, list[int]()
    times_ns.clear()
    with _stream_of(source) as (container, stream):
        for index, frame in enumerate(container.decode(stream)):
            full_range = frame.reformat(format="yuv444p", dst_colorspace="ITU601", dst_color_range="JPEG")
            # A phone stores pictures in its sensor's orientation, and with them the degrees to turn them
            # counterclockwise.
            quarters = round(frame.rotation / 90)
            picture = YuvPlanes(*(np.rot90(plane, quarters) for plane in full_range.to_ndarray()))
            size = size or picture.size
            if picture.size != size:
                width, height = picture.size
                raise RecordingError(
                    f"{source}: frame {index} must be {size[0]}x{size[1]} like the first, not {width}x{height}"
                )
            tick = 0 if frame.pts is None else frame.pts
            ticks.append(max(tick, ticks[-1] + 1) if ticks else tick)  # time stamps must rise
            times_ns.append(round((ticks[-1] - ticks[0]) * stream.time_base * 1_000_000_000))
            yield Skipped(f"{source} {index}", "the video is damaged there") if frame.is_corrupt else picture


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
        with av.open(source, **_in_any_encoding(av.__version__)) as container:
            if not container.streams.video:
                kinds = ", ".join(sorted({each.type for each in container.streams})) or "none at all"
                raise RecordingError(f"{source}: file must be whole and have a video stream, not {kinds}")
            yield container, container.streams.video[0]
    except (av.FFmpegError, OSError) as error:
        raise RecordingError(f"{source}: video must be readable: {error.strerror}") from None


def _in_any_encoding(pyav: str) -> dict[str, Any]:
    """Return the options with which this version of PyAV reads a title in whatever encoding: since version 19 it always does."""
    return {"metadata_errors": "replace"} if int(pyav.split(".", 1)[0]) < 19 else {}
