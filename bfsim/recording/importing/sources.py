"""Sources of pictures for a recording: which reader a path needs, and what every reader provides."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

if TYPE_CHECKING:
    from bfsim.recording.planes import YuvPlanes

SourceFormat = Literal[
    "images", "uyvy", "i420", "yuyv", "nv12", "grey", "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8",
    "y4m", "video", "rosbag",
]  # fmt: skip
SOURCE_FORMATS: tuple[SourceFormat, ...] = get_args(SourceFormat)
RAW_FORMATS = tuple(each for each in SOURCE_FORMATS if each not in ("images", "y4m", "video", "rosbag"))
"""Formats that do not state the size of their pictures."""
DEEP_FORMATS = tuple(
    each for each in SOURCE_FORMATS if each in ("images", "grey", "rosbag") or each.startswith("bayer")
)
"""Formats whose pixels may have 16 bits."""

IMAGE_SUFFIXES = frozenset({
    ".bmp", ".gif", ".jfif", ".jpe", ".jpeg", ".jpg", ".pgm", ".png", ".pnm", ".ppm", ".tif", ".tiff", ".webp",
})  # fmt: skip

_FILE_SUFFIXES: dict[str, SourceFormat] = {
    ".uyvy": "uyvy", ".422": "uyvy",
    ".yuyv": "yuyv", ".yuy2": "yuyv",
    ".i420": "i420", ".yuv": "i420", ".yuv420": "i420",
    ".nv12": "nv12", ".grey": "grey", ".gray": "grey", ".y8": "grey",
    ".y4m": "y4m",
    ".bag": "rosbag", ".db3": "rosbag", ".mcap": "rosbag", ".zstd": "rosbag",
    **dict.fromkeys((
        ".264", ".265", ".3gp", ".apng", ".asf", ".avi", ".flv", ".gif", ".h264", ".h265", ".hevc", ".m2ts", ".m2v", ".m4v", ".mjpeg",
        ".mjpg", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".mts", ".ogv", ".ts", ".webm", ".wmv",
    ), "video"),
}  # fmt: skip

_OF_BAG = re.compile(r"\.db3$|_\d+\.mcap$")
"""Names of the files in a bag of ROS 2."""


@dataclass(frozen=True, slots=True)
class Skipped:
    """A file that was left out, and the reason."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureSource:
    """One stream of pictures. size is that of the first one.

    count is None if only reading to the end can tell; fps is None if the source does not say. `pictures` opens the
    source and yields pictures from the first on, one in memory at a time; in place of an unreadable one it yields the
    reason. `skipped` are other files beside them. `times_ns` says when each picture was taken, if the source knows, at
    least for those already yielded. `notes` are for the user who imports the source, `notes_on_times` only if its times
    are kept.
    """

    name: str
    size: tuple[int, int]
    count: int | None
    fps: Fraction | None
    pictures: Callable[[], Iterator[YuvPlanes | Skipped]]
    skipped: tuple[Skipped, ...] = ()
    times_ns: Sequence[int] | None = None
    notes: tuple[str, ...] = ()
    notes_on_times: tuple[str, ...] = ()


def guess_format(source: str) -> SourceFormat | None:
    """Return the format of a source by its name; None if the name does not tell. A single GIF is an animation."""
    path = Path(source)
    if (path / "metadata.yaml").is_file() or _is_cut_bag(path):
        return "rosbag"
    if path.is_dir() or is_pattern(source):
        return "images"
    suffix = path.suffix.lower()
    return _FILE_SUFFIXES.get(suffix, "images" if suffix in IMAGE_SUFFIXES else None)


def _is_cut_bag(path: Path) -> bool:
    """Whether a folder holds files of a ROS 2 bag without metadata, since its recorder died, and no pictures."""
    names = [
        each.name.lower() for each in path.glob("*")
    ]  # empty if the folder cannot be read, which its reader reports
    return any(map(_OF_BAG.search, names)) and not any(each.endswith(tuple(IMAGE_SUFFIXES)) for each in names)


def is_pattern(source: str) -> bool:
    """Whether the source is a pattern such as `frames/left_*.png` and not the name of a file or folder."""
    return any(sign in source for sign in "*?[") and not Path(source).exists()
