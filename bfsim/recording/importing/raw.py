"""Pictures from files without a container: raw frames back to back, as cameras send them, and YUV4MPEG2 (.y4m).

Their bytes are kept as they are, except that a y4m file with XCOLORRANGE=LIMITED is stretched to full range. YUV4MPEG2:
the MJPEG Tools' yuv4mpeg(5) manual page, with FFmpeg's X parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError
from bfsim.recording.importing.bayer import BayerPattern, planes_of_bayer
from bfsim.recording.importing.deep_pixels import are_uppermost, upper_bits, words
from bfsim.recording.importing.sources import PictureSource, Skipped
from bfsim.recording.planes import YuvPlanes

_Y4M_MAGIC = b"YUV4MPEG2"
_LONGEST_LINE_BYTES = 1024
SWAPPED = "; they would with their bytes the other way round: swap them, as `dd conv=swab` does"

# Divisors of the colour planes, in columns and rows; (0, 0): there are none.
_Y4M_SUBSAMPLING = {
    "420": (2, 2), "420jpeg": (2, 2), "420mpeg2": (2, 2), "420paldv": (2, 2),
    "422": (2, 1), "444": (1, 1), "mono": (0, 0),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Layout:
    """The layout of a frame in the file: planes one after the other, colour divided by (columns, rows)."""

    width: int
    height: int
    subsampling: tuple[int, int]

    @property
    def chroma_shape(self) -> tuple[int, int]:
        columns, rows = self.subsampling
        return (-(-self.height // rows), -(-self.width // columns)) if columns else (0, 0)

    @property
    def frame_bytes(self) -> int:
        return self.width * self.height + 2 * self.chroma_shape[0] * self.chroma_shape[1]

    def planes(self, data: bytes) -> YuvPlanes:
        pixels = np.frombuffer(data, np.uint8)
        luma_bytes = self.width * self.height
        y = pixels[:luma_bytes].reshape(self.height, self.width)
        if self.subsampling == (0, 0):
            return YuvPlanes.from_grey(y)
        u, v = pixels[luma_bytes:].reshape(2, *self.chroma_shape)
        return YuvPlanes(y, u, v)


def open_uyvy(source: str, size: tuple[int, int]) -> PictureSource:
    """Open raw UYVY frames of `size` (width, height) in pixels."""
    return _open_packed(source, "UYVY", size, YuvPlanes.from_uyvy)


def open_yuyv(source: str, size: tuple[int, int]) -> PictureSource:
    """Open raw YUYV frames, also called YUY2, of `size` (width, height) in pixels."""
    return _open_packed(source, "YUYV", size, YuvPlanes.from_yuyv)


def _open_packed(
    source: str, name: str, size: tuple[int, int], planes_of: Callable[[NDArray[np.uint8]], YuvPlanes]
) -> PictureSource:
    """Open frames with two bytes a pixel, where two pixels share a colour."""
    width, height = size
    if width % 2:
        raise RecordingError(f"{source}: width of {name} frames must be even, not {width}")

    def planes(data: bytes) -> YuvPlanes:
        return planes_of(np.frombuffer(data, np.uint8).reshape(height, 2 * width))

    return _open_raw(source, name, size, 2 * width * height, planes)


def open_i420(source: str, size: tuple[int, int]) -> PictureSource:
    """Open raw I420 frames (planes Y, U, V; colour halved both ways) of `size` (width, height) in pixels."""
    frame = _quartered(source, "I420", size)
    return _open_raw(source, "I420", size, frame.frame_bytes, frame.planes)


def open_nv12(source: str, size: tuple[int, int]) -> PictureSource:
    """Open raw NV12 frames (a plane Y, one of alternating U and V; colour halved both ways) of `size` (width, height)."""
    frame = _quartered(source, "NV12", size)

    def planes(data: bytes) -> YuvPlanes:
        pixels = np.frombuffer(data, np.uint8)
        luma, chroma = np.split(pixels, [frame.width * frame.height])
        pairs = chroma.reshape(*frame.chroma_shape, 2)
        return YuvPlanes(luma.reshape(frame.height, frame.width), pairs[..., 0], pairs[..., 1])

    return _open_raw(source, "NV12", size, frame.frame_bytes, planes)


def open_grey(source: str, size: tuple[int, int], bits: int | None = None) -> PictureSource:
    """Open raw grey frames of `size` (width, height); pixels have one byte, or two with this many used `bits`."""
    return _open_sensor(source, "grey", size, bits, YuvPlanes.from_grey)


def open_bayer(
    pattern: BayerPattern, source: str, size: tuple[int, int], bits: int | None = None
) -> PictureSource:
    """Open raw frames of a sensor with colour filters on its pixels, like `open_grey`."""
    return _open_sensor(source, pattern, size, bits, partial(planes_of_bayer, pattern=pattern))


def _open_sensor(
    source: str,
    name: str,
    size: tuple[int, int],
    bits: int | None,
    planes_of: Callable[[NDArray[np.uint8]], YuvPlanes],
) -> PictureSource:
    """Open frames with one number a pixel; numbers of two bytes begin with the lower one."""
    width, height = size

    def planes(data: bytes) -> YuvPlanes:
        if bits is None:
            return planes_of(np.frombuffer(data, np.uint8).reshape(height, width))
        pixels = words(data, (height, width))
        try:
            return planes_of(upper_bits(pixels, bits))
        except RecordingError as error:
            fit_swapped = not words(data, (height, width), is_big_endian=True).max() >> bits
            is_swapped = fit_swapped and not are_uppermost(pixels, bits)
            raise RecordingError(f"{error}{SWAPPED if is_swapped else ''}") from None

    return _open_raw(source, name, size, width * height * (1 if bits is None else 2), planes)


def _quartered(source: str, name: str, size: tuple[int, int]) -> _Layout:
    """Return the layout of frames whose colour planes are half as wide and high."""
    width, height = size
    if width % 2 or height % 2:
        raise RecordingError(
            f"{source}: width and height of {name} frames must be even, not {width}x{height}"
        )
    return _Layout(width, height, (2, 2))


def _open_raw(
    source: str, name: str, size: tuple[int, int], frame_bytes: int, planes: Callable[[bytes], YuvPlanes]
) -> PictureSource:
    with _open(source) as stream:
        size_bytes = stream.seek(0, 2)
    count, rest = divmod(size_bytes, frame_bytes)
    if size_bytes == 0 or rest:
        raise RecordingError(
            f"{source}: file must be a whole number of {size[0]}x{size[1]} {name} frames "
            f"of {frame_bytes} bytes, not {size_bytes} bytes: {count} frames and {rest} bytes; "
            "is `--size` right?"
        )

    def pictures() -> Iterator[YuvPlanes | Skipped]:
        with _open(source) as stream:
            for index in range(size_bytes // frame_bytes):
                data = _read_frame(stream, frame_bytes, source, index)
                try:
                    yield planes(data)
                except RecordingError as error:
                    yield Skipped(f"{source} {index}", str(error))

    return PictureSource(name=source, size=size, count=size_bytes // frame_bytes, fps=None, pictures=pictures)


def open_y4m(source: str) -> PictureSource:
    """Open frames of a YUV4MPEG2 file with 8 bits a sample, 4:2:0, 4:2:2, 4:4:4 or mono.

    Raises RecordingError for anything else; reading the pictures raises it, with the frame, where the file breaks off.
    """
    with _open(source) as stream:
        header = _read_line(stream, source, 0).split(" ")
        start = stream.tell()
        size_bytes = stream.seek(0, 2)
    if header[0].encode() != _Y4M_MAGIC:
        raise RecordingError(f"{source}: file must start with {_Y4M_MAGIC.decode()}, not {header[0][:20]!r}")
    frame = _y4m_layout(source, header)
    limited = "XCOLORRANGE=LIMITED" in header

    def pictures() -> Iterator[YuvPlanes]:
        with _open(source) as stream:
            stream.seek(start)
            index = 0
            while stream.tell() < size_bytes:
                line = _read_line(stream, source, index)
                if line.split(" ")[0] != "FRAME":
                    raise RecordingError(
                        f"{source}: frame {index} must start with FRAME, not {line[:20]!r} "
                        f"(before byte {stream.tell()})"
                    )
                planes = frame.planes(_read_frame(stream, frame.frame_bytes, source, index))
                yield planes.stretched() if limited else planes
                index += 1

    count = (size_bytes - start) // (frame.frame_bytes + len("FRAME\n"))
    if count == 0:
        raise RecordingError(
            f"{source}: file must have at least one whole frame, not {size_bytes - start} bytes of one"
        )
    fps = _y4m_fps(source, header)
    return PictureSource(
        name=source, size=(frame.width, frame.height), count=None, fps=fps, pictures=pictures
    )


def _y4m_layout(source: str, header: list[str]) -> _Layout:
    fields = {field[0]: field[1:] for field in reversed(header[1:]) if field}
    colourspace = fields.get("C", "420jpeg")
    if colourspace not in _Y4M_SUBSAMPLING:
        raise RecordingError(
            f"{source}: y4m colourspace must be one of {', '.join(_Y4M_SUBSAMPLING)}, not {colourspace} "
            "(in its first line)"
        )
    width, height = fields.get("W", ""), fields.get("H", "")
    if not (width.isdecimal() and height.isdecimal() and int(width) > 0 and int(height) > 0):
        raise RecordingError(f"{source}: y4m header must give a size W… H… above 0, not W{width} H{height}")
    return _Layout(int(width), int(height), _Y4M_SUBSAMPLING[colourspace])


def _y4m_fps(source: str, header: list[str]) -> Fraction | None:
    """Return the frame rate; None if it is missing or unknown (0:0)."""
    for field in header[1:]:
        if field.startswith("F"):
            frames, _, seconds = field[1:].partition(":")
            if not (frames.isdecimal() and seconds.isdecimal()):
                raise RecordingError(f"{source}: y4m frame rate must be like F30:1, not {field}")
            return Fraction(int(frames), int(seconds)) if int(frames) and int(seconds) else None
    return None


def _open(source: str) -> IO[bytes]:
    try:
        return Path(source).open("rb")
    except OSError as error:
        raise RecordingError(f"{source}: source must be a readable file: {error.strerror}") from None


def _read_line(stream: IO[bytes], source: str, index: int) -> str:
    start = stream.tell()
    line = stream.readline(_LONGEST_LINE_BYTES)
    if not line.endswith(b"\n"):
        raise RecordingError(
            f"{source}: y4m header line must end within {_LONGEST_LINE_BYTES} bytes "
            f"(frame {index}, byte {start})"
        )
    return line[:-1].decode("ascii", "replace")


def _read_frame(stream: IO[bytes], frame_bytes: int, source: str, index: int) -> bytes:
    start = stream.tell()
    data = stream.read(frame_bytes)
    if len(data) < frame_bytes:
        raise RecordingError(
            f"{source}: frame {index} must have {frame_bytes} bytes, not {len(data)}: the file breaks off "
            f"(frame starts at byte {start})"
        )
    return data
