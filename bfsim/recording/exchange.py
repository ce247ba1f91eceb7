"""Whether left and right pictures are exchanged: then what both show lies further right in the right one, which nothing can.

Bands of rows are compared along their columns. Places count where the pictures have contrast and agree at one shift alone.
That is no stereo matching: it says on which side most of the picture is, and nothing of depths.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.frames import RectificationTables, StereoFrame, UyvyImage

Signals = NDArray[np.float32]
"""Rise of the luma from column to column in bands of rows, (bands, columns)."""

COLUMNS, ROWS_OF_BAND = 160, 4
"""Pictures are shrunk to some so many columns; a band may be a pixel or two higher in one picture. [assumed]"""

WINDOW = 9
LEAST_CONTRAST = 24  # grey levels, up and down, in a window [assumed]
SAME_PEAK = 2  # columns to each side of the best shift that are one with it

ENOUGH_PLACES, MOST_FRAMES = 100, 8
"""As many frames are looked at as it takes."""

FEWEST_PLACES, EXCHANGED_SHARE = 16, 0.75
"""Of fewer places nothing is said. Of right pairs up to 7 % of the places lie so, of chessboards, that look alike, half."""


class ExchangeCheck:
    """Looks at the first stereo frames that pass, as rectified by `tables`, and counts on which side things are."""

    def __init__(self, tables: RectificationTables | None = None) -> None:
        self._tables = tables
        self._frames = self._places = self._exchanged = 0

    def watch(self, frames: Iterable[StereoFrame]) -> Iterator[StereoFrame]:
        """Pass frames on."""
        for frame in frames:
            self.look_at(frame.left, frame.right)
            yield frame

    def look_at(self, left: UyvyImage, right: UyvyImage) -> None:
        """Count the places of a frame, unless there are enough."""
        if self._frames == MOST_FRAMES or self._places >= ENOUGH_PLACES:
            return
        self._frames += 1
        lumas = [each[:, 1::2] for each in (left, right)]
        if self._tables:
            tables = (self._tables.left, self._tables.right)
            lumas = [luma[rows, columns] for luma, (rows, columns) in zip(lumas, tables, strict=True)]
        shifts = _shifts(*map(_signals, lumas))
        self._places += len(shifts)
        self._exchanged += int((shifts < 0).sum())

    @property
    def warnings(self) -> Iterator[str]:
        """What to tell the user; nothing where left and right seem to be right."""
        if self._places < FEWEST_PLACES or self._exchanged < EXCHANGED_SHARE * self._places:
            return
        percent = 100 * self._exchanged // self._places
        yield (
            f"left and right pictures seem to be exchanged: at {percent} % of the places compared, things stand further right in "
            "the right picture, and so have no depth; the left camera comes first in `bfsim record import`; where it did, "
            "the cameras squint, and `bfsim record calibrate` rectifies their pictures"
        )


def _signals(luma: NDArray[np.uint8]) -> Signals:
    height, width = luma.shape
    across = max(width // COLUMNS, 1)
    down = ROWS_OF_BAND * across
    bands, columns = height // down, width // across
    cells = luma[: bands * down, : columns * across].reshape(bands, down, columns, across)
    return np.diff(cells.mean(axis=(1, 3), dtype=np.float32), axis=1)


def _shifts(left: Signals, right: Signals) -> NDArray[np.int64]:
    """Return by how many columns things lie further left in the right picture, at the places where that is certain."""
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
