"""Find the inner corners of a chessboard in pictures, by two finders of OpenCV, and report what was skipped."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError
from bfsim.recording.importing.image_files import load_image
from bfsim.recording.importing.images import images_among, images_and_others
from bfsim.recording.importing.pairs import SIDES, pairs_of, side_of
from bfsim.recording.importing.sources import Skipped
from bfsim.recording.planes import Plane, YuvPlanes, fit_matrix

Corners = NDArray[np.float32]

# Corners are refined in a window of half this part of the smallest distance between two, up to this many pixels, until
# they move less, or up to a number of times. [assumed; OpenCV's tutorial has 11 px and 0.001 px]
_WINDOW_PART, _LARGEST_WINDOW_PX = 0.5, 11
_LEAST_MOVE_PX, _MOST_STEPS = 0.001, 100


@dataclass(frozen=True, slots=True)
class BoardView:
    """A board as one or both cameras saw it at one time: names of the pictures, and the corners (count, 2) in each."""

    names: tuple[str, ...]
    points: tuple[Corners, ...]


def find_views(
    cv2: Any,
    folder: Path,
    size: tuple[int, int],
    corners: tuple[int, int],
    *,
    mono: bool,
    resize: bool,
    bits: int | None,
    progress: Callable[[int, int], None] | None,
) -> tuple[list[BoardView], list[Skipped]]:
    """Return the boards seen in the pictures of `size` (width, height) of a folder, and the pictures that show none.

    With `mono`, every picture is from the only camera. Otherwise, pictures whose names (or whose folders' names) say
    left and right are paired by the rest of their names, or by their order if the names have nothing in common. With
    `resize`, corners in pictures of other sizes are found at full size, where they are sharpest, and then moved to
    where an import that scales the pictures has them. `bits`: how many the cameras use of 16-bit pixels. `progress` is
    called with the number of views examined, and that of all. Raises RecordingError.
    """
    sets, skipped = _together(folder, mono=mono)
    views = []
    for number, paths in enumerate(sets):
        if progress:
            progress(number, len(sets))
        found = []
        for path in paths:
            try:
                grey, to_recorded = _grey(path, size, resize=resize, bits=bits)
                found.append(_brought(_corners_in(cv2, grey, corners), to_recorded))
            except RecordingError as error:
                skipped.append(Skipped(path.name, str(error).removeprefix(f"{path}: ")))
        if len(found) == len(paths):
            first, *others = found
            points = (first, *(_numbered_like(first, other, corners) for other in others))
            views.append(BoardView(tuple(path.name for path in paths), points))
    return views, skipped


def _together(folder: Path, *, mono: bool) -> tuple[list[tuple[Path, ...]], list[Skipped]]:
    """Return the pictures that were taken at the same time, and those that have no partner."""
    if mono:
        images, others = images_and_others(str(folder))
        return [(path,) for path in images], others
    (lefts, no_lefts), (rights, no_rights) = (_pictures_of(folder, side) for side in SIDES)
    pairs, alone = pairs_of(lefts, rights, f"{folder}: chessboard pictures")
    return list(pairs), [*no_lefts, *no_rights, *alone]


def _pictures_of(folder: Path, side: str) -> tuple[list[Path], list[Skipped]]:
    """Return a camera's images in a folder, or in the subfolder of that side if there is one, and other files there."""
    if not folder.is_dir():
        raise RecordingError(
            f"{folder}: chessboard pictures must be in a folder, but there is none of that name"
        )
    named = [each for each in folder.iterdir() if side_of(each.stem) == side]
    folders = [each for each in named if each.is_dir()]
    if len(folders) == 1:
        return images_and_others(str(folders[0]))
    images, others = images_among(named)
    if not images:
        raise RecordingError(
            f"{folder}: folder must have pictures of a chessboard by both cameras, such as left_01.png and right_01.png, or folders "
            f"left and right of them, but no image in it has a name that says {side}; `--mono` takes those of one camera"
        )
    return images, others


def _grey(
    path: Path, size: tuple[int, int], *, resize: bool, bits: int | None
) -> tuple[Plane, NDArray[np.float64]]:
    """Return a picture, and the matrix (3, 3) that leads from its pixels to those of the recording."""
    image = load_image(path, bits)
    if image.size != size and not resize:
        raise RecordingError(
            f"picture must be {size[0]}x{size[1]} like the recording, not {image.width}x{image.height}; `--resize` "
            "scales it as `bfsim record import --resize` does"
        )
    return np.ascontiguousarray(YuvPlanes.from_image(image).y), fit_matrix(image.size, size, None)


def _brought(points: Corners, to_recorded: NDArray[np.float64]) -> Corners:
    scale, start = to_recorded.diagonal()[:2], to_recorded[:2, 2]
    return (points * scale + start).astype(np.float32)


def _corners_in(cv2: Any, grey: Plane, corners: tuple[int, int]) -> Corners:
    """Return the corners (count, 2): by sectors, then so with more effort, then by the squares' outlines.

    The last one sees boards at the rim and in bad light that the first misses, and its corners need refining.
    """
    accurate = cv2.CALIB_CB_ACCURACY
    for flags in (accurate, accurate | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_EXHAUSTIVE):
        found, points = cv2.findChessboardCornersSB(grey, corners, flags=flags)
        if found:
            return _flat(points)
    found, points = cv2.findChessboardCorners(
        grey, corners, flags=cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
    )
    if not found:
        raise RecordingError(f"no whole chessboard of {corners[0]}x{corners[1]} inner corners is found")
    return _refined(cv2, grey, _flat(points), corners)


def _refined(cv2: Any, grey: Plane, points: Corners, corners: tuple[int, int]) -> Corners:
    grid = points.reshape(corners[1], corners[0], 2)
    least_px = min(float(np.linalg.norm(np.diff(grid, axis=axis), axis=2).min()) for axis in (0, 1))
    half_px = int(np.clip(_WINDOW_PART * least_px, 2, _LARGEST_WINDOW_PX))
    until = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, _MOST_STEPS, _LEAST_MOVE_PX)
    return _flat(cv2.cornerSubPix(grey, points[:, None].copy(), (half_px, half_px), (-1, -1), until))


def _numbered_like(first: Corners, other: Corners, corners: tuple[int, int]) -> Corners:
    """Return `other` in the order of `first`: a turned or mirrored board has the same corners."""
    grid = other.reshape(corners[1], corners[0], 2)
    grids = [grid, grid.swapaxes(0, 1)] if corners[0] == corners[1] else [grid]
    orders: Sequence[Corners] = [
        each[::down, ::across].reshape(-1, 2) for each in grids for down in (1, -1) for across in (1, -1)
    ]
    shape = first - first.mean(axis=0)
    best = min(orders, key=lambda points: float(np.square(points - points.mean(axis=0) - shape).sum()))
    return np.ascontiguousarray(best)


def _flat(points: NDArray[np.float32]) -> Corners:
    return points.reshape(-1, 2)
