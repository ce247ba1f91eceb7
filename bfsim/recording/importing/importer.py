"""Make a recording from pictures: a stream for each camera, one with both side by side, or one for both."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from bfsim.errors import RecordingError
from bfsim.recording.cameras.camera_info import Rig, rig_of
from bfsim.recording.frames import RectificationTables, StereoGeometry
from bfsim.recording.importing.import_checks import camera_size, check_call, check_options, check_pair
from bfsim.recording.importing.mosaic import mosaic_warnings
from bfsim.recording.importing.opening import open_sources
from bfsim.recording.importing.picture_pairs import PicturePairs
from bfsim.recording.importing.pixel_bytes import pixel_bytes_warnings
from bfsim.recording.importing.row_count import row_count_warnings
from bfsim.recording.importing.row_length import row_length_warnings
from bfsim.recording.importing.sources import PictureSource, Skipped, SourceFormat, guess_format
from bfsim.recording.importing.stamps import Stamps, frame_rate
from bfsim.recording.planes import fit_matrix
from bfsim.recording.ros.rosbag import BagPictures, open_bag
from bfsim.recording.stereo.stereo_check import StereoCheck
from bfsim.recording.writer import RecordingWriter

SAME_PICTURES = "Warning: both cameras have the same pictures, byte for byte, so that nothing has a depth; `--mono` is for one camera"

Progress = Callable[[int, int | None], None]
"""Called after each stereo frame with the number of frames done and, if known, of all frames."""


@dataclass(frozen=True, slots=True)
class ImportSummary:
    """What an import has written: the sizes of the pictures, what was skipped, and `notes` on its decisions."""

    path: Path
    width: int
    height: int
    frame_count: int
    fps: Fraction
    size_bytes: int
    source_sizes: tuple[tuple[int, int], ...]
    skipped: tuple[Skipped, ...]
    notes: tuple[str, ...] = ()


def import_recording(
    sources: Sequence[str | os.PathLike[str]],
    output: str | os.PathLike[str],
    *,
    format: SourceFormat | None = None,
    size: tuple[int, int] | None = None,
    bits: int | None = None,
    resize: tuple[int, int] | None = None,
    crop: tuple[int, int] | None = None,
    side_by_side: bool = False,
    mono: bool = False,
    fps: Fraction | float | None = None,
    topics: tuple[str, str] | None = None,
    slop_s: float | None = None,
    geometry: StereoGeometry | None = None,
    rectification: RectificationTables | None = None,
    description: str = "",
    force: bool = False,
    progress: Progress | None = None,
) -> ImportSummary:
    """Write the recording `output` from pictures; `output` appears when it is complete, or not at all.

    - Two sources are the left and the right camera. One source needs `side_by_side` (left half, right half) or `mono`
      (one camera feeds both sides). `format` is guessed from the names.
    - `size` is the (width, height) of raw frames. `bits`: how many of its 16 bits a pixel uses; the upper 8 of these
      are kept.
    - `resize` scales every picture by a triangle filter as wide as the scale, and cuts off what is outside its aspect
      ratio. `crop` keeps the middle of every picture, and skips smaller ones.
    - A stereo frame is skipped if one of its pictures is missing or cannot be read: images of two cameras are paired by
      their names (`pairs_of`).

    A bag of ROS is one source with both cameras' topics, which `topics` names and `slop_s` pairs (see `open_bag`). Its
    time stamps, from the first picture on, are kept, and its camera_info gives geometry and rectification, unless these
    are given. For other sources, the k-th stereo frame is stamped k / `fps` seconds; without `fps` it gets the source's
    own rate, or 30, or an uneven video's own times.

    An existing `output` needs `force`. Raises RecordingError, with the file and the frame.
    """
    names = [os.fspath(source) for source in sources]
    formats = [format or guess_format(name) for name in names]
    is_bag = "rosbag" in formats
    check_call(
        names,
        Path(output),
        resize=resize,
        crop=crop,
        side_by_side=side_by_side,
        mono=mono,
        is_bag=is_bag,
        force=force,
    )
    check_options(names[0], formats, size=size, bits=bits, fps=fps, topics=topics, slop_s=slop_s)
    is_fitted = resize is not None or crop is not None
    is_single = side_by_side or mono
    bag = open_bag(names[0], topics, slop_s, single=is_single, mixed=is_fitted, bits=bits) if is_bag else None
    opened = [*bag.sources] if bag else open_sources(names, format, size, mixed=is_fitted, bits=bits)
    rate = frame_rate(fps, opened)
    count = check_pair(opened, side_by_side=side_by_side, is_fitted=is_fitted)
    picture_size = resize or crop or camera_size(opened[0], side_by_side)
    rig = Rig(geometry, rectification, ())
    if bag and (geometry is None or rectification is None):
        rig = _rig(bag, rig, picture_size, resize, crop, side_by_side=side_by_side)
    size_doubts = _size_doubts(opened, side_by_side=side_by_side) if size is not None else ()
    of_grey = any(each in ("images", "grey") for each in formats)
    mosaics = tuple(mosaic_warnings(opened)) if of_grey and not size_doubts else ()
    stamps = Stamps(opened, rate, is_even=fps is not None, has_pairs=is_bag)
    check = StereoCheck(rig.tables)
    pairs = PicturePairs(opened, side_by_side, resize, crop)
    with RecordingWriter(
        output,
        width=picture_size[0],
        height=picture_size[1],
        geometry=rig.geometry,
        rectification=rig.tables,
        description=description,
    ) as writer:
        are_same = _write(writer, pairs, stamps, check, count, progress)
        if not writer.frame_count and pairs.skipped:
            last = pairs.skipped[-1]
            raise RecordingError(f"{names[0]}: {last.name}: {last.reason}, and no picture is left")
    return ImportSummary(
        path=writer.path,
        width=picture_size[0],
        height=picture_size[1],
        frame_count=writer.frame_count,
        fps=rate,
        size_bytes=writer.path.stat().st_size,
        source_sizes=tuple(sorted(pairs.sizes)),
        skipped=tuple(pairs.skipped),
        notes=(
            *(bag.notes if bag else ()),
            *(note for source in opened for note in source.notes),
            *(note for source in opened for note in source.notes_on_times if fps is None),
            *rig.notes,
            *size_doubts,
            *mosaics,
            *(f"Warning: {each}" for each in check.warnings),
            *((SAME_PICTURES,) if are_same and not is_single else ()),
        ),
    )


def _write(
    writer: RecordingWriter,
    pairs: PicturePairs,
    stamps: Stamps,
    check: StereoCheck,
    count: int | None,
    progress: Progress | None,
) -> bool:
    """Write all pairs, check them on the way, and return whether both pictures of each pair are the same."""
    are_same = True
    for index, left, right in pairs:
        stamps_ns = stamps.of(index, writer.frame_count)
        coded = left.to_uyvy(), right.to_uyvy()
        check.look_at(*coded)
        are_same = are_same and np.array_equal(*coded)
        writer.add(*coded, *stamps_ns)
        if progress is not None:
            progress(index + 1, count)
    return are_same


def _size_doubts(opened: list[PictureSource], *, side_by_side: bool) -> tuple[str, ...]:
    """Return reasons to doubt the given size of raw frames: first the bytes of a pixel, then the length of a row."""
    return (
        tuple(pixel_bytes_warnings(opened))
        or (() if side_by_side else tuple(row_length_warnings(opened)))
        or tuple(row_count_warnings(opened))
    )


def _rig(
    bag: BagPictures,
    given: Rig,
    size: tuple[int, int],
    resize: tuple[int, int] | None,
    crop: tuple[int, int] | None,
    *,
    side_by_side: bool,
) -> Rig:
    """Return what is `given`, completed from the camera_info of a bag for pictures of that size."""
    if side_by_side:
        return replace(
            given,
            notes=("A camera_info of side-by-side pictures does not describe each camera: it is not read.",),
        )
    sizes = tuple(each.size for each in bag.sources)
    fits = tuple(fit_matrix(each, resize, crop) for each in sizes)
    return rig_of(bag.cameras, sizes, fits, size, given)
