"""Whether raw frames, which have no size of their own, have as many rows as was said.

Rows that follow each other look alike in their details, but for those where a picture ends and the next one begins.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.importing.sources import PictureSource

MOST_FRAMES = 30
"""Of a file, that are looked at."""

DETAIL_PX = 2
"""Details are the differences of pixels so far apart: of one colour, also of a sensor with filters."""

LEAST_LIKENESS = 0.3
"""Of rows that follow each other, in the middle: of less nothing is said. It is 0.4 and more in 168 real pictures."""

ALIKE, OTHER = 0.5, 0.3
"""Parts of that likeness: rows that are more alike follow each other in one picture, and those that are less do not."""

CONTINUED_SHARE = 1 / 3
"""So many frames that go on in the next one are told: none does of 168 real pictures with the right height, half of them and more with another one."""

Pixels = NDArray[np.uint8]


def row_count_warnings(sources: Iterable[PictureSource]) -> Iterator[str]:
    """Yield what to tell the user of each raw source whose frames seem to be of another height."""
    for source in sources:
        if source.count:
            width, height = source.size
            frames = np.memmap(source.name, np.uint8, "r").reshape(source.count, -1)[:MOST_FRAMES]
            pixel_bytes = frames.shape[1] // (width * height)  # colours may stand behind the rows
            told = (
                wrong_row_count(frames[:, each::pixel_bytes], width, height) for each in range(pixel_bytes)
            )
            if said := next(filter(None, told), ""):
                yield f"Warning: {source.name}: frames seem not to be {height} rows high: {said}; is `--size` right?"


def wrong_row_count(frames: Pixels, width: int, height: int) -> str:
    """Return why frames of shape (count, numbers), which begin with their rows, are not that high; empty if nothing speaks against it."""
    rows = frames[0, : height * width].reshape(height, width)
    usual = float(np.median([_likeness(*pair) for pair in pairwise(rows)] or [0]))
    if usual < LEAST_LIKENESS:
        return ""
    ends = [_likeness(frame[-width:], other[:width]) for frame, other in pairwise(frames)]
    if ends and np.mean(np.array(ends) > ALIKE * usual) >= CONTINUED_SHARE:
        return "they go on in the next ones"
    for parts in (2, 3) if len(frames) > 1 else ():  # of one picture an edge of its own would tell the same
        at = height // parts * width
        if all(_likeness(each[at - width : at], each[at : at + width]) < OTHER * usual for each in frames):
            return f"another picture begins at a {('half', 'third')[parts - 2]} of them"
    return ""


def _likeness(row: Pixels, other: Pixels) -> float:
    """Return how the details of two rows correlate, 0 where one has none."""
    details = [each[DETAIL_PX:].astype(float) - each[:-DETAIL_PX] for each in (row, other)]
    energy = float(np.sqrt(np.prod([np.square(each).sum() for each in details])))
    return float(details[0] @ details[1]) / energy if energy else 0.0
