"""Choose the reader for a source of pictures, by its format or its name."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from bfsim.errors import RecordingError
from bfsim.recording.importing.bayer import BAYER_PATTERNS, BayerPattern
from bfsim.recording.importing.images import open_image_pair, open_images
from bfsim.recording.importing.raw import (
    open_bayer,
    open_grey,
    open_i420,
    open_nv12,
    open_uyvy,
    open_yuyv,
)
from bfsim.recording.importing.sources import SOURCE_FORMATS, PictureSource, SourceFormat, guess_format
from bfsim.recording.importing.video import open_video
from bfsim.recording.importing.y4m import open_y4m

_FILE_OPENERS = {"y4m": open_y4m, "video": open_video}
_RAW_OPENERS: dict[SourceFormat, Callable[[str, tuple[int, int]], PictureSource]] = {
    "uyvy": open_uyvy, "yuyv": open_yuyv, "i420": open_i420, "nv12": open_nv12,
}  # fmt: skip
_SENSOR_OPENERS: dict[SourceFormat, Callable[[str, tuple[int, int], int | None], PictureSource]] = {
    "grey": open_grey,
    **{each: partial(open_bayer, each) for each in BAYER_PATTERNS},
}
"""Raw frames whose pixels may have 16 bits."""


def open_sources(
    names: list[str],
    format: SourceFormat | None,
    size: tuple[int, int] | None,
    *,
    mixed: bool,
    bits: int | None = None,
) -> list[PictureSource]:
    """Open sources by their names; `format` applies to all, and `size` to raw frames.

    `mixed`: the pictures of a source may differ in size. `bits`: how many the cameras use of 16-bit pixels.
    """
    if len(names) == 2 and all(_is_of_images(name, format) for name in names):
        _check_size(names[0], format, size)
        return open_image_pair(*names, mixed=mixed, bits=bits, pattern=_pattern(format))
    return [_open_source(name, format, size, mixed=mixed, bits=bits) for name in names]


def _open_source(
    name: str, format: SourceFormat | None, size: tuple[int, int] | None, *, mixed: bool, bits: int | None
) -> PictureSource:
    chosen = format or guess_format(name)
    if chosen is None:
        kind = "is not there" if not Path(name).exists() else "has a name that does not tell its format"
        raise RecordingError(
            f"{name}: source must be a folder of images or a file of pictures, but it {kind} "
            f"(`--format` {', '.join(SOURCE_FORMATS)})"
        )
    if _is_of_images(name, chosen):
        _check_size(name, chosen, size)
        return open_images(name, mixed=mixed, bits=bits, pattern=_pattern(chosen))
    if chosen in _FILE_OPENERS:
        return _FILE_OPENERS[chosen](name)
    if size is None or min(size) <= 0:
        raise RecordingError(
            f"{name}: raw {chosen.upper()} needs the size of its frames, such as `--size 320x240`"
        )
    if chosen in _SENSOR_OPENERS:
        return _SENSOR_OPENERS[chosen](name, size, bits)
    return _RAW_OPENERS[chosen](name, size)


def _is_of_images(name: str, format: SourceFormat | None) -> bool:
    """Whether a source consists of image files; a format with colour filters does not exclude it."""
    said = None if _pattern(format) else format
    return (said or guess_format(name)) == "images"


def _pattern(format: SourceFormat | None) -> BayerPattern | None:
    """Return the filter pattern of a format, if it has one."""
    return next((each for each in BAYER_PATTERNS if each == format), None)


def _check_size(name: str, format: SourceFormat | None, size: tuple[int, int] | None) -> None:
    """Raise RecordingError if image files with a filter pattern get the size of raw frames."""
    if size is not None and _pattern(format):
        raise RecordingError(
            f"{name}: `--size` must go with raw frames, for images have one of their own; `--resize` scales pictures"
        )
