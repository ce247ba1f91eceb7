"""Whether the rows of raw frames, which have no size of their own, are as long as was said.

Rows that follow each other look alike: in the pixels of a picture, one after the other, those that are a row apart differ least.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.importing.sources import PictureSource
from bfsim.recording.planes import Plane, YuvPlanes

MOST_PIXELS = 200_000
"""Of a picture, that are compared."""

SHORTEST_PX, NEAREST_PX = 32, 8
"""The shortest row that is sought, and how far from the length that was said another one is one."""

TWO_ROWS_SHARE = 0.9
"""Rows that follow each other differ by less than this part of what the first and the third do: by 0.70 at most in real pictures."""

DOUBTED_SHARE = 0.5
"""Of the difference of rows of the length that was said. Of 201 real pictures of the right one nothing is told: the best other one has five
times that difference. Of 1,606 with a wrong one 1,600 are told, 1,482 with the very length."""


def row_length_warnings(sources: Iterable[PictureSource]) -> Iterator[str]:
    """Yield what to tell the user of each source whose first picture seems to have rows of another length."""
    for source in sources:
        picture = next(source.pictures(), None)
        if isinstance(picture, YuvPlanes) and (length_px := other_row_length(picture.y)):
            yield (
                f"Warning: {source.name}: rows seem to be {length_px} pixels long and not {picture.size[0]}, for then those "
                "that follow each other are alike; is `--size` right?"
            )


def other_row_length(luma: Plane) -> int | None:
    """Return the length in pixels that rows of a picture of shape (height, width) seem to have; None for its own, or if nothing tells."""
    width: int = luma.shape[1]
    pixels = luma.ravel()[:MOST_PIXELS].astype(np.float64)
    first, end = max(SHORTEST_PX, width // 4), min(4 * width, len(pixels) // 3)
    if not first < width < end:
        return None
    differences = _differences(pixels)
    best = first + int(np.argmin(differences[first:end]))
    if abs(best - width) >= NEAREST_PX and differences[best] < DOUBTED_SHARE * differences[width]:
        return best
    parts = [width // each for each in (2, 3, 4) if width // each >= SHORTEST_PX]
    part = min(parts, key=lambda each: float(differences[each]), default=width)
    return part if differences[part] < TWO_ROWS_SHARE * differences[width] else None


def _differences(pixels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean square of the difference of pixels that are so many apart, by their distance."""
    count = len(pixels)
    centred = pixels - pixels.mean()
    spectrum = np.fft.rfft(centred, 2 * count)
    products = np.fft.irfft(spectrum * spectrum.conj(), 2 * count)[:count]
    sums = np.concatenate([[0], np.cumsum(centred**2)])
    distance = np.arange(count)
    squares = sums[count - distance] + sums[count] - sums[distance] - 2 * products
    # Of equal rows nothing but rounding is left.
    differences: NDArray[np.float64] = np.round(squares / (count - distance), 6)
    return differences
