"""Detect exchanged left and right pictures: things then lie further right in the right one, which is impossible.

Bands of rows are compared along their columns. Places count if the pictures have contrast there, and agree at one shift
only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bfsim.recording.planes import Plane


EXCHANGED = (
    "left and right pictures seem to be exchanged: at {percent} % of the places compared, things stand further right in "
    "the right picture, and so have no depth; the left camera comes first in `bfsim record import`; where it did, "
    "the cameras squint, and `bfsim record calibrate` rectifies their pictures"
)

Signals = NDArray[np.float32]
"""Increase of the luma from column to column in bands of rows, (bands, columns)."""

COLUMNS, ROWS_OF_BAND = 160, 4
"""Pictures are shrunk to about this many columns; a band may be a pixel or two higher in one picture. [assumed]"""

WINDOW = 9
LEAST_CONTRAST = 24  # grey levels, up and down, in a window [assumed]
SAME_PEAK = 2  # columns on each side of the best shift that count as part of it


def exchanged_places(left: Plane, right: Plane) -> NDArray[np.bool_]:
    """Return for each certain place whether things there lie further right in the right picture."""
    return np.asarray(_shifts(*map(_signals, (left, right))) < 0)


def _signals(luma: Plane) -> Signals:
    height, width = luma.shape
    across = max(width // COLUMNS, 1)
    down = ROWS_OF_BAND * across
    bands, columns = height // down, width // across
    cells = luma[: bands * down, : columns * across].reshape(bands, down, columns, across)
    return np.diff(cells.mean(axis=(1, 3), dtype=np.float32), axis=1)


def _shifts(left: Signals, right: Signals) -> NDArray[np.int64]:
    """Return by how many columns things lie further left in the right picture, at the places where this is certain."""
    columns = left.shape[1]
    reach = columns // 4
    starts = np.arange(reach, columns - reach - WINDOW, WINDOW // 2)

    def in_windows(values: Signals) -> Signals:
        sums = np.pad(values.cumsum(axis=1), ((0, 0), (1, 0)))
        return np.asarray(sums[:, starts + WINDOW] - sums[:, starts])

    contrast = in_windows(np.abs(left))
    shifts = np.arange(-reach, reach + 1)
    costs = np.stack([in_windows(np.abs(left - np.roll(right, shift, axis=1))) for shift in shifts])
    best = shifts[costs.argmin(axis=0)]
    least = costs.min(axis=0)
    is_other = np.abs(shifts[:, None, None] - best) > SAME_PEAK
    other = costs.min(axis=0, where=is_other, initial=np.inf)
    is_certain = (contrast >= LEAST_CONTRAST) & (2 * least < contrast) & (4 * other > 5 * least)
    return np.asarray(best[is_certain])
