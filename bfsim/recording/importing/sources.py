"""Where pictures for a recording come from: which reader a path needs, and what every reader gives."""

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
"""Of these no file says how large its pictures are."""
DEEP_FORMATS = tuple(
    each for each in SOURCE_FORMATS if each in ("images", "grey", "rosbag") or each.startswith("bayer")
)
"""Of these pixels may have 16 bits."""

IMAGE_SUFFIXES = frozenset({
    ".bmp", ".gif", ".jfif", ".jpe", ".jpeg", ".jpg", ".pgm", ".png", ".pnm", ".ppm", ".tif", ".tiff", ".webp",
})  # fmt: skip

_FILE_SUFFIXES: dict[str, SourceFormat] = {
    ".uyvy": "uyvy", ".422": "uyvy",
    ".yuyv": "yuyv", ".yuy2": "yuyv",
    ".i420": "i420", ".yuv": "i420", ".yuv420": "i420",
    ".nv12": "nv12", ".grey": "grey", ".gray": "grey", ".y8": "grey",
    ".y4m": "y4m",
    ".bag": "rosbag", ".db3": "rosbag", ".mcap": "rosbag",
    **dict.fromkeys((
        ".264", ".265", ".3gp", ".apng", ".asf", ".avi", ".flv", ".gif", ".h264", ".h265", ".hevc", ".m2ts", ".m2v", ".m4v", ".mjpeg",
        ".mjpg", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".mts", ".ogv", ".ts", ".webm", ".wmv",
    ), "video"),
}  # fmt: skip

_OF_BAG = re.compile(r"\.db3$|_\d+\.mcap$")
"""How the files in a bag of ROS 2 are called."""


@dataclass(frozen=True, slots=True)
class Skipped:
    """A file that was left out, and why."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureSource:
    """One stream of pictures. size is that of the first one.

    count is None when only reading to the end tells; fps is None when the source does not say. `pictures`
    opens the source and yields from the first picture on, one in memory at a time; in the place of one that cannot be
    read, why not. `skipped` are files beside them that are no pictures. `times_ns` says when each was taken, if the
    source knows, at least of those that it has yielded. `notes` are for who imports it, `notes_on_times` if it
    keeps its times.
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
    """Format of a source by its name; None if the name does not tell. A GIF by itself is an animation."""
    path = Path(source)
    if (path / "metadata.yaml").is_file() or _is_cut_bag(path):
        return "rosbag"
    if path.is_dir() or is_pattern(source):
        return "images"
    suffix = path.suffix.lower()
    return _FILE_SUFFIXES.get(suffix, "images" if suffix in IMAGE_SUFFIXES else None)


def _is_cut_bag(path: Path) -> bool:
    """Whether a folder holds the files of a bag of ROS 2 whose recorder died before it wrote the metadata, and no pictures."""
    names = [
        each.name.lower() for each in path.glob("*")
    ]  # none where the folder cannot be read, which its reader tells
    return any(map(_OF_BAG.search, names)) and not any(each.endswith(tuple(IMAGE_SUFFIXES)) for each in names)


def is_pattern(source: str) -> bool:
    """Whether the source is a pattern such as `frames/left_*.png` and not the name of a file or folder."""
    return any(sign in source for sign in "*?[") and not Path(source).exists()
