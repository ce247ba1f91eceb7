"""Check the height of raw frames, which do not state their size.

Adjacent rows are alike in their details, except where a picture ends and the next one begins.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.importing.sources import PictureSource

MOST_FRAMES = 30
"""The number of frames of a file to check."""

DETAIL_PX = 2
"""Details are differences of pixels at this distance, which have the same colour even behind a sensor's filters."""

LEAST_LIKENESS = 0.3
"""The least median likeness of adjacent rows for any report. It is 0.4 and more in 168 real pictures."""

ALIKE, OTHER = 0.5, 0.3
"""Fractions of that median: rows above the first belong to one picture, rows below the second do not."""

CONTINUED_SHARE = 1 / 3
"""The least share of frames that continue in the next one for a warning.

None of 168 real pictures with the right height does, but half of them and more do with a wrong one.
"""

Pixels = NDArray[np.uint8]


def row_count_warnings(sources: Iterable[PictureSource]) -> Iterator[str]:
    """Yield a warning for each raw source whose frames seem to have another height."""
    for source in sources:
        if source.count:
            width, height = source.size
            frames = np.memmap(source.name, np.uint8, "r").reshape(source.count, -1)[:MOST_FRAMES]
            pixel_bytes = frames.shape[1] // (width * height)  # colours may follow the rows
            told = (
                wrong_row_count(frames[:, each::pixel_bytes], width, height) for each in range(pixel_bytes)
            )
            if said := next(filter(None, told), ""):
                yield f"Warning: {source.name}: frames seem not to be {height} rows high: {said}; is `--size` right?"


def wrong_row_count(frames: Pixels, width: int, height: int) -> str:
    """Return why frames do not have this height; "" if nothing contradicts it.

    `frames` of shape (count, numbers) begin with their rows.
    """
    rows = frames[0, : height * width].reshape(height, width)
    usual = float(np.median([_likeness(*pair) for pair in pairwise(rows)] or [0]))
    if usual < LEAST_LIKENESS:
        return ""
    ends = [_likeness(frame[-width:], other[:width]) for frame, other in pairwise(frames)]
    if ends and np.mean(np.array(ends) > ALIKE * usual) >= CONTINUED_SHARE:
        return "they go on in the next ones"
    for parts in (2, 3) if len(frames) > 1 else ():  # a single picture may have such an edge of its own
        at = height // parts * width
        if all(_likeness(each[at - width : at], each[at : at + width]) < OTHER * usual for each in frames):
            return f"another picture begins at a {('half', 'third')[parts - 2]} of them"
    return ""


def _likeness(row: Pixels, other: Pixels) -> float:
    """Return the correlation of the details of two rows, 0 if one has none."""
    details = [each[DETAIL_PX:].astype(float) - each[:-DETAIL_PX] for each in (row, other)]
    energy = float(np.sqrt(np.prod([np.square(each).sum() for each in details])))
    return float(details[0] @ details[1]) / energy if energy else 0.0
