"""Checks of sources and options before an import."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from bfsim.errors import RecordingError
from bfsim.recording.growing_file import require_free
from bfsim.recording.importing.deep_pixels import check_bits
from bfsim.recording.importing.sources import (
    DEEP_FORMATS,
    RAW_FORMATS,
    PictureSource,
    SourceFormat,
    guess_format,
)

_PATTERN = '"left*.jpg"'


def check_call(
    names: list[str],
    output: Path,
    *,
    resize: tuple[int, int] | None,
    crop: tuple[int, int] | None,
    side_by_side: bool,
    mono: bool,
    is_bag: bool,
    force: bool,
) -> None:
    """Raise RecordingError unless the options fit each other and the number of sources, and `output` may be written."""
    if output == Path("-"):
        raise RecordingError(
            "-: recording must have a name like run.mcap, not be standard output: it appears only once it is whole"
        )
    if output.suffix.lower() != ".mcap" and guess_format(os.fspath(output)):
        raise RecordingError(
            f"{output}: recording must have a name like run.mcap, not one of pictures; it comes first, and its sources "
            "follow: `bfsim record import run.mcap left/ right/`"
        )
    if output.exists() and any(_is_of(each, output) for each in names):
        raise RecordingError(
            f"{output}: recording must be a file of its own, not one that it is made of; it comes first: "
            "`bfsim record import run.mcap drive.bag`"
        )
    require_free(output, force=force)
    if side_by_side and mono:
        raise RecordingError("a recording must be made with `--side-by-side` or `--mono`, not both")
    _check_sources(names, is_bag=is_bag, is_single=side_by_side or mono)
    if resize is not None and crop is not None:
        raise RecordingError("pictures must be fitted with `--resize` or `--crop`, not both")
    for option, wanted_size in (("--resize", resize), ("--crop", crop)):
        if wanted_size is not None and (min(wanted_size) <= 0 or wanted_size[0] % 2):
            raise RecordingError(
                f"`{option}` must be above 0 and of even width, not {wanted_size[0]}x{wanted_size[1]}"
            )


def check_options(
    name: str,
    formats: Sequence[SourceFormat | None],
    *,
    size: tuple[int, int] | None,
    bits: int | None,
    fps: Fraction | float | None,
    topics: tuple[str, str] | None,
    slop_s: float | None,
) -> None:
    """Raise RecordingError if an option for one kind of source has no such source; `name` is that of the first source."""
    is_bag = "rosbag" in formats
    if is_bag and fps is not None:
        raise RecordingError(f"{name}: `--fps` must not be given, for a bag has time stamps")
    if not is_bag and (topics is not None or slop_s is not None):
        raise RecordingError(f"{name}: `--topics` and `--slop` must go with a bag of ROS")
    if size is not None and not any(each in (*RAW_FORMATS, None) for each in formats):
        raise RecordingError(
            f"{name}: `--size` must go with raw frames, which have none of their own; `--resize` scales pictures"
        )
    check_bits(bits)
    if bits is not None and not any(each in (*DEEP_FORMATS, None) for each in formats):
        raise RecordingError(
            f"{name}: `--bits` must go with {', '.join(DEEP_FORMATS)}, whose pixels may have 16"
        )


def _check_sources(names: list[str], *, is_bag: bool, is_single: bool) -> None:
    """Raise RecordingError unless there is one source for each camera, and no source twice."""
    if is_bag and len(names) > 1:
        raise RecordingError(f"sources must be one bag with the topics of both cameras, not {len(names)}")
    wanted = 1 if is_single or is_bag else 2
    if len(names) != wanted:
        raise RecordingError(
            f"sources must be {wanted}, not {len(names)}: two (left, right), "
            "or one with `--side-by-side` or `--mono`, or a bag of ROS; the pictures of a camera are a folder, or a pattern in "
            f"quotes, such as {_both_in(names[0]) or _PATTERN}"
        )
    for name in names:
        if Path(name).is_fifo():
            raise RecordingError(
                f"{name}: source must be a file, which is read more than once, not a pipe; save it under a name first"
            )
    if wanted == 2 and _is_one(*names):
        raise RecordingError(
            f"{names[0]}: sources must be of two cameras, left and right, not one twice; one camera alone is imported with `--mono`"
        )


def _is_one(left: str, right: str) -> bool:
    """Whether two names stand for the same file, folder or pattern."""
    paths = Path(left), Path(right)
    return left == right or (all(each.exists() for each in paths) and paths[0].samefile(paths[1]))


def _is_of(source: str, file: Path) -> bool:
    """Whether a source is this existing file, or a folder with it: a bag of ROS 2."""
    path = Path(source)
    if (path / "metadata.yaml").exists():
        return path.samefile(file.parent)
    return path.exists() and path.samefile(file)


def _both_in(source: str) -> str:
    """Return two sources, for a folder's left and right pictures, if names in it say left and right."""
    folder = Path(source)
    inside = sorted(folder.iterdir()) if folder.is_dir() else []
    sources = []
    for side in ("left", "right"):
        named = re.compile(side, re.IGNORECASE)
        path = next((each for each in inside if named.search(each.name)), None)
        if path is None:
            return ""
        (word, *_) = named.findall(path.name)
        sources.append(str(path) if path.is_dir() else f'"{folder}/*{word}*"')
    return " ".join(sources)


def check_pair(sources: list[PictureSource], *, side_by_side: bool, is_fitted: bool) -> int | None:
    """Return the number of pictures, if the sources know it; raise RecordingError if they do not match."""
    left, right = sources[0], sources[-1]
    if side_by_side:
        check_halves(left.name, left.size)
    if left.size != right.size and not is_fitted:
        raise RecordingError(
            f"left and right images must have one size, not {left.size[0]}x{left.size[1]} ({left.name}) and "
            f"{right.size[0]}x{right.size[1]} ({right.name}); `--resize` or `--crop` brings both to one"
        )
    if left.count is not None and right.count is not None and left.count != right.count:
        raise RecordingError(
            f"both cameras must have the same number of images, not {left.count} ({left.name}) "
            f"and {right.count} ({right.name})"
        )
    return left.count


def camera_size(source: PictureSource, side_by_side: bool) -> tuple[int, int]:
    """Return the size of one camera's picture; raises RecordingError, with the source, if it is not possible."""
    width, height = source.size
    if width % 2:
        raise RecordingError(
            f"{source.name}: image width must be even (UYVY pixels come in pairs), not {width}; "
            "`--resize` scales, `--crop` cuts"
        )
    return width // 2 if side_by_side else width, height


def check_halves(name: str, size: tuple[int, int]) -> None:
    """Raise RecordingError unless a picture of two cameras side by side has two halves of even width."""
    if size[0] % 4:
        raise RecordingError(f"{name}: side-by-side image must have a width of 4 x n pixels, not {size[0]}")
