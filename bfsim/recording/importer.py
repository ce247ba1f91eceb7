"""Makes a recording from pictures: a stream for each camera, one with both side by side, or one for both."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

from bfsim.errors import RecordingError
from bfsim.recording.frames import RectificationTables, StereoGeometry
from bfsim.recording.images import open_images
from bfsim.recording.layout import table_from_npy
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.raw import open_i420, open_uyvy, open_y4m
from bfsim.recording.sources import SOURCE_FORMATS, PictureSource, SourceFormat, guess_format
from bfsim.recording.video import open_video
from bfsim.recording.writer import RecordingWriter

DEFAULT_FPS = Fraction(30)
FPS_PARTS = 1_000_000
"""Frame rates are fractions with denominators up to this; it is the highest rate, too."""
"""Of sources that do not say: the VGA rate of the OmniVision sensors."""

Progress = Callable[[int, int | None], None]
"""Called after each stereo frame with the frames done and, where known, the frames there are."""

_FILE_OPENERS = {"images": open_images, "y4m": open_y4m, "video": open_video}
_RAW_OPENERS = {"uyvy": open_uyvy, "i420": open_i420}


@dataclass(frozen=True, slots=True)
class ImportSummary:
    """What an import has written."""

    path: Path
    width: int
    height: int
    frame_count: int
    fps: Fraction
    size_bytes: int


def import_recording(
    sources: Sequence[str | os.PathLike[str]],
    output: str | os.PathLike[str],
    *,
    format: SourceFormat | None = None,
    size: tuple[int, int] | None = None,
    resize: tuple[int, int] | None = None,
    side_by_side: bool = False,
    mono: bool = False,
    fps: Fraction | float | None = None,
    geometry: StereoGeometry | None = None,
    rectification: RectificationTables | None = None,
    description: str = "",
    force: bool = False,
    progress: Progress | None = None,
) -> ImportSummary:
    """Write the recording `output` from pictures; `output` appears when it is complete, or not at all.

    Two sources are the left and the right camera. One source needs `side_by_side` (left half, right half) or
    `mono` (one camera feeds both sides). `format` is guessed from the names. `size` is the (width, height) of
    raw frames; `resize` scales every picture, cutting off what sticks out of its aspect ratio. The k-th
    stereo frame is stamped k / `fps` seconds; without `fps` the source's own rate counts, or 30. An existing
    `output` needs `force`. Raises RecordingError, with the file and the frame.
    """
    names = [os.fspath(source) for source in sources]
    _check_call(names, Path(output), resize=resize, side_by_side=side_by_side, mono=mono, force=force)
    opened = [_open_source(name, format, size) for name in names]
    rate = _frame_rate(fps, opened)
    count = _check_pair(opened, side_by_side=side_by_side, resized=resize is not None)
    pairs = _stereo_pairs(opened, side_by_side)
    picture_size = resize or _camera_size(opened[0], side_by_side)
    with RecordingWriter(
        output,
        width=picture_size[0],
        height=picture_size[1],
        geometry=geometry,
        rectification=rectification,
        description=description,
    ) as writer:
        for index, (left, right) in enumerate(pairs):
            images = [(side.resized(*resize) if resize else side).to_uyvy() for side in (left, right)]
            time_ns = round(index * 1_000_000_000 / rate)
            writer.add(images[0], images[1], time_ns, time_ns)
            if progress is not None:
                progress(index + 1, count)
    return ImportSummary(writer.path, *picture_size, writer.frame_count, rate, writer.path.stat().st_size)


def load_rectification(left: str | os.PathLike[str], right: str | os.PathLike[str]) -> RectificationTables:
    """Rectification tables from two .npy files of integers: source rows and source columns, -1 for nothing."""
    tables = []
    for path in (left, right):
        try:
            table = table_from_npy(Path(path).read_bytes())
        except OSError as error:
            raise RecordingError(
                f"{path}: rectification table must be a readable file: {error.strerror}"
            ) from None
        except RecordingError as error:
            raise RecordingError(f"{path}: {error}") from None
        if table.dtype.kind not in "iu" or table.ndim != 3:
            raise RecordingError(
                f"{path}: rectification table must hold integers of shape (2, height, width), "
                f"not {table.dtype} of shape {table.shape}"
            )
        bounds = np.iinfo(np.int32)
        tables.append(np.clip(table, bounds.min, bounds.max).astype(np.int32))
    return RectificationTables(*tables)


def _check_call(
    names: list[str],
    output: Path,
    *,
    resize: tuple[int, int] | None,
    side_by_side: bool,
    mono: bool,
    force: bool,
) -> None:
    if guess_format(os.fspath(output)):
        raise RecordingError(f"{output}: recording must have a name like run.mcap, not one of pictures")
    if output.exists() and not force:
        raise RecordingError(f"{output}: recording must not exist yet; `--force` overwrites it")
    if side_by_side and mono:
        raise RecordingError("a recording must be made with `--side-by-side` or `--mono`, not both")
    wanted = 1 if side_by_side or mono else 2
    if len(names) != wanted:
        raise RecordingError(
            f"sources must be {wanted}, not {len(names)}: two (left, right), "
            "or one with `--side-by-side` or `--mono`"
        )
    if resize is not None and (min(resize) <= 0 or resize[0] % 2):
        raise RecordingError(f"`--resize` must be above 0 and of even width, not {resize[0]}x{resize[1]}")


def _open_source(name: str, format: SourceFormat | None, size: tuple[int, int] | None) -> PictureSource:
    chosen = format or guess_format(name)
    if chosen is None:
        kind = "is not there" if not Path(name).exists() else "has a name that does not tell its format"
        raise RecordingError(
            f"{name}: source must be a folder of images or a file of pictures, but it {kind} "
            f"(`--format` {', '.join(SOURCE_FORMATS)})"
        )
    if chosen in _FILE_OPENERS:
        return _FILE_OPENERS[chosen](name)
    if size is None or min(size) <= 0:
        raise RecordingError(
            f"{name}: raw {chosen.upper()} needs the size of its frames, such as `--size 320x240`"
        )
    return _RAW_OPENERS[chosen](name, size)


def _frame_rate(fps: Fraction | float | None, sources: list[PictureSource]) -> Fraction:
    rates = {source.fps for source in sources if source.fps is not None}
    if fps is None and len(rates) > 1:
        described = " and ".join(f"{float(rate):g}" for rate in sorted(rates))
        raise RecordingError(f"both cameras must have one frame rate, not {described}; `--fps` sets it")
    if fps is not None and not 1 <= fps * FPS_PARTS <= FPS_PARTS**2:
        raise RecordingError(f"frame rate must be 0.000001 to 1000000 per second, not {fps}")
    return Fraction(fps).limit_denominator(FPS_PARTS) if fps is not None else next(iter(rates), DEFAULT_FPS)


def _check_pair(sources: list[PictureSource], *, side_by_side: bool, resized: bool) -> int | None:
    """Return how many pictures both sources have, if they know; raise where they do not fit each other."""
    left, right = sources[0], sources[-1]
    if side_by_side and left.size[0] % 4:
        raise RecordingError(
            f"{left.name}: side-by-side image must have a width of 4 x n pixels, not {left.size[0]}"
        )
    if left.size != right.size and not resized:
        raise RecordingError(
            f"left and right images must have one size, not {left.size[0]}x{left.size[1]} ({left.name}) and "
            f"{right.size[0]}x{right.size[1]} ({right.name}); `--resize` scales both"
        )
    if left.count is not None and right.count is not None and left.count != right.count:
        raise RecordingError(
            f"both cameras must have the same number of images, not {left.count} ({left.name}) "
            f"and {right.count} ({right.name})"
        )
    return left.count


def _camera_size(source: PictureSource, side_by_side: bool) -> tuple[int, int]:
    """Return the size of one camera's picture, checked, so that the message can name the source."""
    width, height = source.size
    if width % 2:
        raise RecordingError(
            f"{source.name}: image width must be even (UYVY pixels come in pairs), not {width}; "
            "`--resize` scales"
        )
    return width // 2 if side_by_side else width, height


def _stereo_pairs(sources: list[PictureSource], side_by_side: bool) -> Iterator[tuple[YuvPlanes, YuvPlanes]]:
    """Yield the left and the right picture of each stereo frame."""
    if len(sources) == 1:
        for picture in sources[0].pictures():
            yield picture.halves() if side_by_side else (picture, picture)
        return
    rights = sources[1].pictures()
    index = -1
    for index, left in enumerate(sources[0].pictures()):
        right = next(rights, None)
        if right is None:
            raise RecordingError(
                f"both cameras must have the same number of images, but {sources[1].name} ends after {index} "
                f"and {sources[0].name} has more"
            )
        yield left, right
    if next(rights, None) is not None:
        raise RecordingError(
            f"both cameras must have the same number of images, but {sources[0].name} ends after {index + 1} "
            f"and {sources[1].name} has more"
        )
