"""Detect pictures that show things in different rows, because the cameras are not parallel or lenses bend.

Patches with contrast in both directions are sought in the other picture, some rows and many columns around. A patch
counts if it matches one place well and no other nearly as well, or if it matches nothing, as when a camera is turned
far or sees something else.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bfsim.recording.planes import Plane


OTHER_ROWS = (
    "the pictures seem not to be rectified: at {percent} % of the places compared, things stand in other rows of the right "
    "picture, where no partner is sought, and so have no depth or a wrong one; `bfsim record calibrate` rectifies them by pictures "
    "of a chessboard, `bfsim record import --rectification` by tables"
)

NOWHERE = (
    "the right pictures seem not to show what the left ones do: {percent} % of the places compared are nowhere near in them, and so "
    "have no depth or a wrong one; are they of one moment, is a camera turned or upside down? `bfsim record calibrate` rectifies what "
    "is turned"
)

Cells = NDArray[np.float32]

COLUMNS = 160
"""Pictures are shrunk to about this many columns: a row is two or more rows of a picture of 320x240. [assumed]"""

PATCH, STEP, REACH_ROWS = 9, 5, 8
REACH_LEFT, REACH_RIGHT = 3 / 8, 1 / 8
"""Parts of the width: near things lie far further left in the right picture, and further right only if cameras squint.

With a larger reach, still nearer things would be found, but squares of boards would be mistaken for their neighbours.
[assumed]
"""
LEAST_CONTRAST = 3  # mean difference of adjacent cells of a patch in grey levels, both ways [assumed]
MOST_PATCHES = 64
"""The most patches of a frame, evenly spread."""
SAME_PEAK = 2  # rows and columns on each side of the best place that count as part of it


def in_other_rows(offsets: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return for each patch with a certain place in the right picture whether it lies in another row there."""
    return np.asarray(offsets[np.isfinite(offsets)] != 0)


def are_nowhere(offsets: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return for each patch whether nothing around its place in the right picture resembles it."""
    return np.isinf(offsets)


def row_offsets(left: Plane, right: Plane) -> NDArray[np.float64]:
    """Return for each patch how many rows further down it is in the right picture.

    NaN if that is uncertain, infinite if it is nowhere.
    """
    lefts, rights = _cells(left), _cells(right)
    height, width = lefts.shape
    leftwards, rightwards = (int(part * width) for part in (REACH_LEFT, REACH_RIGHT))
    if height < PATCH + 2 * REACH_ROWS or width < PATCH + leftwards + rightwards:
        return np.zeros(0)
    windows = sliding_window_view(rights, (PATCH, PATCH))
    energies = _sums(np.square(rights)) - np.square(_sums(rights)) / PATCH**2
    offsets = []
    for top, start in _corners(lefts, leftwards, rightwards):
        rows = slice(top - REACH_ROWS, top + REACH_ROWS + 1)
        columns = slice(start - leftwards, start + rightwards + 1)
        patch = lefts[top : top + PATCH, start : start + PATCH]
        offsets.append(_row_offset(patch - patch.mean(), windows[rows, columns], energies[rows, columns]))
    return np.array(offsets, np.float64)


def _cells(luma: Plane) -> Cells:
    height, width = luma.shape
    side = max(width // COLUMNS, 1)
    down, across = height // side, width // side
    squares = luma[: down * side, : across * side].reshape(down, side, across, side)
    return np.asarray(squares.mean(axis=(1, 3), dtype=np.float32))


def _corners(cells: Cells, leftwards: int, rightwards: int) -> NDArray[np.int64]:
    """Return where patches with contrast both ways begin, (count, 2); of many, an evenly spread selection."""
    inside = cells[REACH_ROWS:-REACH_ROWS, leftwards:-rightwards]
    across, along = (
        sliding_window_view(np.abs(np.diff(inside, axis=axis)), (PATCH - 1, PATCH - 1))[::STEP, ::STEP].mean(
            axis=(2, 3)
        )
        for axis in (1, 0)
    )
    rows, columns = (min(sizes) for sizes in zip(across.shape, along.shape, strict=True))
    contrast = np.minimum(across[:rows, :columns], along[:rows, :columns])
    places = np.argwhere(contrast >= LEAST_CONTRAST) * STEP + (REACH_ROWS, leftwards)
    return places[:: -(-len(places) // MOST_PATCHES)] if len(places) else places


def _sums(cells: Cells) -> NDArray[np.float64]:
    """Return the sums over all patches."""
    sums = np.pad(cells.cumsum(axis=0, dtype=np.float64).cumsum(axis=1), ((1, 0), (1, 0)))
    return np.asarray(
        sums[PATCH:, PATCH:] - sums[:-PATCH, PATCH:] - sums[PATCH:, :-PATCH] + sums[:-PATCH, :-PATCH]
    )


def _row_offset(patch: Cells, windows: Cells, energies: NDArray[np.float64]) -> float:
    """Return how many rows further down the best match of a patch is, as `row_offsets`; the patch has no mean.

    `windows`: the possible matches; `energies`: the sums of their squares, without their means.
    """
    energy = float(np.square(patch).sum())
    costs = energies + energy - 2 * np.tensordot(windows, patch, axes=2)  # sum of squared differences
    row, column = np.unravel_index(costs.argmin(), costs.shape)
    least = float(costs[row, column])
    if 4 * least >= energy:
        return math.inf
    peak = (
        slice(max(row - SAME_PEAK, 0), row + SAME_PEAK + 1),
        slice(max(column - SAME_PEAK, 0), column + SAME_PEAK + 1),
    )
    costs[peak] = np.inf
    return int(row) - REACH_ROWS if float(costs.min()) > 1.5 * least else math.nan
