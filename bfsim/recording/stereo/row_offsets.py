"""Whether things stand in other rows of the right picture than of the left one, where the cameras are not parallel or lenses bend.

Patches with contrast across and along are sought in the other picture, some rows and many columns around. They count where they
agree well, and nowhere else nearly as well; and where they agree with nothing, as if a camera were turned far, or saw something else.
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
"""Pictures are shrunk to some so many columns: rows of these are two or more of the pictures of 320x240. [assumed]"""

PATCH, STEP, REACH_ROWS = 9, 5, 8
REACH_LEFT, REACH_RIGHT = 3 / 8, 1 / 8
"""Parts of the width: what is near stands far further left in the right picture, and further right only if cameras squint.
What is nearer is not found where it is, and of boards of squares then taken for its neighbour. [assumed]"""
LEAST_CONTRAST = 3  # grey levels from cell to cell in the mean of a patch, both ways [assumed]
MOST_PATCHES = 64
"""Of a frame, evenly spread."""
SAME_PEAK = 2  # rows and columns to each side of the best place that are one with it


def in_other_rows(offsets: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return of each patch whose place in the right picture is certain whether it stands in another row there."""
    return np.asarray(offsets[np.isfinite(offsets)] != 0)


def are_nowhere(offsets: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return of each patch whether nothing around its place in the right picture is like it."""
    return np.isinf(offsets)


def row_offsets(left: Plane, right: Plane) -> NDArray[np.float64]:
    """Return of each patch how many rows further down it is in the right picture: not a number where that is uncertain, infinite if it is nowhere."""
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
    """Return where patches with contrast both ways begin, (count, 2), some evenly spread ones of them."""
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
    """Return the sums of all patches."""
    sums = np.pad(cells.cumsum(axis=0, dtype=np.float64).cumsum(axis=1), ((1, 0), (1, 0)))
    return np.asarray(
        sums[PATCH:, PATCH:] - sums[:-PATCH, PATCH:] - sums[PATCH:, :-PATCH] + sums[:-PATCH, :-PATCH]
    )


def _row_offset(patch: Cells, windows: Cells, energies: NDArray[np.float64]) -> float:
    """Return how many rows further down a patch without its mean is best found, as `row_offsets` does.

    `windows`: where it may be; `energies`: the sums of their squares, without their means.
    """
    energy = float(np.square(patch).sum())
    costs = energies + energy - 2 * np.tensordot(windows, patch, axes=2)  # squares of the differences, summed
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
