"""Pictures from YUV4MPEG2 files (.y4m): the MJPEG Tools' yuv4mpeg(5) manual page, with FFmpeg's X parameters.

Their bytes are kept as they are, except that a file with XCOLORRANGE=LIMITED is stretched to full range.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import IO

from bfsim.errors import RecordingError
from bfsim.recording.importing.planar_frames import PlanarLayout, opened, read_frame
from bfsim.recording.importing.sources import PictureSource
from bfsim.recording.planes import YuvPlanes

_MAGIC = b"YUV4MPEG2"
_LONGEST_LINE_BYTES = 1024

# Divisors of the colour planes, in columns and rows; (0, 0): there are none.
_SUBSAMPLING = {
    "420": (2, 2), "420jpeg": (2, 2), "420mpeg2": (2, 2), "420paldv": (2, 2),
    "422": (2, 1), "444": (1, 1), "mono": (0, 0),
}  # fmt: skip


def open_y4m(source: str) -> PictureSource:
    """Open frames of a YUV4MPEG2 file with 8 bits a sample, 4:2:0, 4:2:2, 4:4:4 or mono.

    Raises RecordingError for anything else; reading the pictures raises it, with the frame, where the file breaks off.
    """
    with opened(source) as stream:
        header = _read_line(stream, source, 0).split(" ")
        start = stream.tell()
        size_bytes = stream.seek(0, 2)
    if header[0].encode() != _MAGIC:
        raise RecordingError(f"{source}: file must start with {_MAGIC.decode()}, not {header[0][:20]!r}")
    frame = _layout(source, header)
    limited = "XCOLORRANGE=LIMITED" in header

    def pictures() -> Iterator[YuvPlanes]:
        with opened(source) as stream:
            stream.seek(start)
            index = 0
            while stream.tell() < size_bytes:
                line = _read_line(stream, source, index)
                if line.split(" ")[0] != "FRAME":
                    raise RecordingError(
                        f"{source}: frame {index} must start with FRAME, not {line[:20]!r} "
                        f"(before byte {stream.tell()})"
                    )
                planes = frame.planes(read_frame(stream, frame.frame_bytes, source, index))
                yield planes.stretched() if limited else planes
                index += 1

    count = (size_bytes - start) // (frame.frame_bytes + len("FRAME\n"))
    if count == 0:
        raise RecordingError(
            f"{source}: file must have at least one whole frame, not {size_bytes - start} bytes of one"
        )
    fps = _fps(source, header)
    return PictureSource(
        name=source, size=(frame.width, frame.height), count=None, fps=fps, pictures=pictures
    )


def _layout(source: str, header: list[str]) -> PlanarLayout:
    fields = {field[0]: field[1:] for field in reversed(header[1:]) if field}
    colourspace = fields.get("C", "420jpeg")
    if colourspace not in _SUBSAMPLING:
        raise RecordingError(
            f"{source}: y4m colourspace must be one of {', '.join(_SUBSAMPLING)}, not {colourspace} "
            "(in its first line)"
        )
    width, height = fields.get("W", ""), fields.get("H", "")
    if not (width.isdecimal() and height.isdecimal() and int(width) > 0 and int(height) > 0):
        raise RecordingError(f"{source}: y4m header must give a size W… H… above 0, not W{width} H{height}")
    return PlanarLayout(int(width), int(height), _SUBSAMPLING[colourspace])


def _fps(source: str, header: list[str]) -> Fraction | None:
    """Return the frame rate; None if it is missing or unknown (0:0)."""
    for field in header[1:]:
        if field.startswith("F"):
            frames, _, seconds = field[1:].partition(":")
            if not (frames.isdecimal() and seconds.isdecimal()):
                raise RecordingError(f"{source}: y4m frame rate must be like F30:1, not {field}")
            return Fraction(int(frames), int(seconds)) if int(frames) and int(seconds) else None
    return None


def _read_line(stream: IO[bytes], source: str, index: int) -> str:
    start = stream.tell()
    line = stream.readline(_LONGEST_LINE_BYTES)
    if not line.endswith(b"\n"):
        raise RecordingError(
            f"{source}: y4m header line must end within {_LONGEST_LINE_BYTES} bytes "
            f"(frame {index}, byte {start})"
        )
    return line[:-1].decode("ascii", "replace")
