"""Check that stereo frames suit the matching of edges: left and right in order, with the same things in each row.

Only places that both pictures surely show are compared, and those that contradict are counted. This is no stereo
matching: it says nothing of depths.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.frames import RectificationTables, StereoFrame, UyvyImage
from bfsim.recording.stereo.exchange import EXCHANGED, exchanged_places
from bfsim.recording.stereo.row_offsets import NOWHERE, OTHER_ROWS, are_nowhere, in_other_rows, row_offsets

ENOUGH_PLACES, MOST_FRAMES = 40, 8
"""Frames are compared until there are enough places."""

FEWEST_PLACES, DOUBTED_SHARE = 16, 0.75
"""With fewer places nothing is reported. In a frame of a correct pair up to 24 % of the places contradict, 68 % on
chessboards, whose squares look alike.

Up to 25 % of a correct pair's places are found nowhere, 54 % for a plant; 91 to 100 % if a camera is turned by 30
degrees, 69 to 100 % if it sees other things.
"""


Counts = tuple[tuple[int, int], tuple[int, int], tuple[int, int]]
"""For each doubt: the number of places compared, and how many of these were wrong."""


@dataclass(slots=True)
class _Doubt:
    """A possible fault, the number of compared places, and how many are wrong; `text` is the warning."""

    text: str
    places: int = 0
    wrong: int = 0

    @property
    def is_open(self) -> bool:
        return self.places < ENOUGH_PLACES

    def add(self, found: NDArray[np.bool_]) -> None:
        """Add more places, each with whether it is wrong there, unless there are enough."""
        if self.is_open:
            self.places += found.size
            self.wrong += int(found.sum())

    @property
    def is_told(self) -> bool:
        return self.places >= FEWEST_PLACES and self.wrong >= DOUBTED_SHARE * self.places


class StereoCheck:
    """Checks the first stereo frames that pass, as rectified by `tables`."""

    def __init__(self, tables: RectificationTables | None = None) -> None:
        self._tables = tables
        self._frames = 0
        self._exchanged, self._other_rows, self._nowhere = self._doubts = (
            _Doubt(EXCHANGED),
            _Doubt(OTHER_ROWS),
            _Doubt(NOWHERE),
        )

    def watch(self, frames: Iterable[StereoFrame]) -> Iterator[StereoFrame]:
        """Yield the frames, and check them on the way."""
        for frame in frames:
            self.look_at(frame.left, frame.right)
            yield frame

    def look_at(self, left: UyvyImage, right: UyvyImage) -> None:
        """Compare the pictures of a frame, unless they are from one camera, or enough was compared."""
        is_done = self._frames == MOST_FRAMES or not any(each.is_open for each in self._doubts)
        if is_done or np.array_equal(left, right):
            return
        self._frames += 1
        lumas = [each[:, 1::2] for each in (left, right)]
        if self._tables:
            tables = (self._tables.left, self._tables.right)
            lumas = [
                np.where(rows < 0, 0, luma[rows, columns])
                for luma, (rows, columns) in zip(lumas, tables, strict=True)
            ]
        if self._exchanged.is_open:
            self._exchanged.add(exchanged_places(*lumas))
        if self._other_rows.is_open or self._nowhere.is_open:
            offsets = row_offsets(*lumas)
            self._other_rows.add(in_other_rows(offsets))
            self._nowhere.add(are_nowhere(offsets))

    @property
    def counts(self) -> Counts:
        """The results so far."""
        exchanged, other_rows, nowhere = ((each.places, each.wrong) for each in self._doubts)
        return exchanged, other_rows, nowhere

    def take_counts(self, counts: Counts) -> None:
        """Take the results of another check of the same frames; no more frames are compared."""
        for doubt, (places, wrong) in zip(self._doubts, counts, strict=True):
            doubt.places, doubt.wrong = places, wrong
        self._frames = MOST_FRAMES

    @property
    def warnings(self) -> Iterator[str]:
        """Warnings for the user; none if the pictures seem to be right."""
        for each in self._doubts:
            if each.is_told:
                yield each.text.format(percent=100 * each.wrong // each.places)
