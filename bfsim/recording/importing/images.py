"""Pictures from image files: a folder of them, a pattern, or a single file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from PIL import Image

from bfsim.errors import RecordingError, cut
from bfsim.recording.importing.bayer import BayerPattern, planes_of_bayer
from bfsim.recording.importing.image_files import has_deep_colours, load_image
from bfsim.recording.importing.pairs import pairs_of
from bfsim.recording.importing.sources import IMAGE_SUFFIXES, PictureSource, Skipped, is_pattern
from bfsim.recording.planes import YuvPlanes

_DARK = 64
"""Colours of 16 bits whose upper 8 are below this are of a dark scene, or of a camera that uses at most 14 bits."""


def open_image_pair(
    left: str, right: str, *, mixed: bool, bits: int | None = None, pattern: BayerPattern | None = None
) -> list[PictureSource]:
    """Return the images of both cameras, as `open_images` does, in matching pairs."""
    lefts, rights = (images_and_others(source) for source in (left, right))
    pairs, alone = pairs_of(lefts[0], rights[0], f"{left} and {right}: images")
    sides = list(zip(*pairs, strict=True))
    return [
        _source(left, list(sides[0]), [*lefts[1], *alone], mixed=mixed, bits=bits, pattern=pattern),
        _source(right, list(sides[1]), rights[1], mixed=mixed, bits=bits, pattern=pattern),
    ]


def open_images(
    source: str, *, mixed: bool, bits: int | None = None, pattern: BayerPattern | None = None
) -> PictureSource:
    """Return the images of a folder, of a pattern or of one file, in natural order of their names (2 before 10).

    Unreadable images are skipped, unless all are; images of another size than the first are refused, unless sizes may
    be `mixed`. `bits` as in `load_image`. `pattern`: the pattern of the sensor's colour filters, if grey images are its
    raw pixels.
    """
    return _source(source, *images_and_others(source), mixed=mixed, bits=bits, pattern=pattern)


def _source(
    source: str,
    paths: list[Path],
    skipped: list[Skipped],
    *,
    mixed: bool,
    bits: int | None,
    pattern: BayerPattern | None,
) -> PictureSource:
    path, image = _first_readable(paths, bits)
    first = path.name, image.size
    return PictureSource(
        name=source,
        size=image.size,
        count=len(paths),
        fps=None,
        pictures=lambda: _pictures(paths, None if mixed else first, bits, pattern),
        skipped=tuple(skipped),
        notes=tuple(_doubts(source, path, image)),
    )


def _doubts(source: str, path: Path, image: Image.Image) -> Iterator[str]:
    """Yield a warning if an image's colours have 16 bits and seem to use the lower ones: of 12, black would be left."""
    brightest = int(np.asarray(image.convert("RGB")).max()) if has_deep_colours(path) else _DARK
    if brightest < _DARK:
        yield (
            f"Warning: {source}: of colours of 16 bits the upper 8 are taken, which reach only {brightest} of 255 in "
            f"{path.name}; if the camera uses fewer bits, multiply them first, for `--bits` is for grey pixels"
        )


def _first_readable(paths: list[Path], bits: int | None) -> tuple[Path, Image.Image]:
    """Return the first readable image and its path; if there is none, raise the error of the first image."""
    errors = []
    for path in paths:
        try:
            return path, load_image(path, bits)
        except RecordingError as error:
            errors.append(error)
    raise errors[0]


def _pictures(
    paths: list[Path],
    model: tuple[str, tuple[int, int]] | None,
    bits: int | None,
    pattern: BayerPattern | None,
) -> Iterator[YuvPlanes | Skipped]:
    for path in paths:
        try:
            image = load_image(path, bits)
        except RecordingError as error:
            yield Skipped(path.name, str(error).removeprefix(f"{path}: "))
            continue
        if model and image.size != model[1]:
            name, size = model
            raise RecordingError(
                f"{path}: image must be {size[0]}x{size[1]} like {name}, the first of its folder, "
                f"not {image.width}x{image.height}; `--resize` or `--crop` brings all to one size"
            )
        if pattern and image.mode != "L":
            raise RecordingError(
                f"{path}: image must be grey for `--format {pattern}`, not of the pixel format {image.mode}"
            )
        yield planes_of_bayer(np.asarray(image), pattern) if pattern else YuvPlanes.from_image(image)


def images_and_others(source: str) -> tuple[list[Path], list[Skipped]]:
    """Return the images of a folder, a pattern or one file, in natural order, and the other files there.

    Raises RecordingError if there is no such source, or no image in it.
    """
    path = Path(source)
    if is_pattern(source):
        found = _matching(path)
    elif path.is_dir():
        found = list(path.iterdir())
    elif path.exists():
        return [path], []
    else:
        raise RecordingError(
            f"{source}: source must be a file, a folder or a pattern of image files, but is not there"
        )
    images, others = images_among(found)
    if not images:
        deeper = next(
            (each for each in sorted(found) if each.is_dir() and any(map(_is_image, each.iterdir()))), None
        )
        raise RecordingError(
            f"{source}: source must hold images ({', '.join(sorted(IMAGE_SUFFIXES))}), "
            f"but none of its {len(found)} files is one{_names_of(found)}{f'; {deeper} holds some' if deeper else ''}"
        )
    return images, others


def images_among(paths: Iterable[Path]) -> tuple[list[Path], list[Skipped]]:
    """Return the image files in natural order of their names, and the other files."""
    # A broken link counts as a picture that cannot be read.
    files = sorted((each for each in paths if each.is_file() or _is_broken_link(each)), key=_natural_key)
    others = [Skipped(file.name, "no image by its name") for file in files if not _is_image(file)]
    return [file for file in files if _is_image(file)], others


def _matching(pattern: Path) -> list[Path]:
    """Return the files that match a pattern, in an existing folder; existing folders may have brackets in their names."""
    folder, rest = Path(pattern.anchor), list(pattern.relative_to(pattern.anchor).parts)
    while (folder / rest[0]).exists():
        folder /= rest.pop(0)
    if not is_pattern(rest[0]):
        raise RecordingError(f"{pattern}: the folder {folder / rest[0]} must be there, but is not")
    return list(folder.glob(str(Path(*rest))))


def _is_image(file: Path) -> bool:
    """Whether a file's name is that of an image."""
    return file.suffix.lower() in IMAGE_SUFFIXES and not file.name.startswith(".")


def _is_broken_link(path: Path) -> bool:
    return path.is_symlink() and not path.exists()


def _names_of(found: list[Path]) -> str:
    """Return the end of an error: what is there instead of images; folders end in a slash."""
    names = sorted(f"{each.name}/" if each.is_dir() else each.name for each in found)
    return f": {cut(', '.join(names))}" if names else ""


def _natural_key(path: Path) -> tuple[list[int | str], str]:
    """Return words and numbers alternately: 2 comes before 10, and `IMG.jpg` before its copy `IMG (1).jpg`."""
    parts = re.split(r"(\d+)", str(path.with_suffix("")))
    return [int(part) if part.isdecimal() else part for part in parts], path.suffix
