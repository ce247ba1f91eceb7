"""Check the length of the rows of raw frames, which do not state their size.

Adjacent rows are alike: among all pixels in a sequence, those that are one row apart differ least.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.importing.sources import PictureSource
from bfsim.recording.planes import Plane, YuvPlanes

MOST_PIXELS = 200_000
"""The number of pixels of a picture that are compared."""

SHORTEST_PX, NEAREST_PX = 32, 8
"""The shortest row that is considered, and the least difference from the given length that counts as another length."""

TWO_ROWS_SHARE = 0.9
"""The ratio of differences below which a half, third or quarter of the given length is reported.

In real pictures, adjacent rows differ by at most 0.70 of what rows two apart do.
"""

DOUBTED_SHARE = 0.5
"""The fraction of the difference at the given length below which another length is reported.

With the right length, nothing is reported for 201 real pictures: the best other length has five times the difference.
With a wrong one, 1,600 of 1,606 are reported, 1,482 of them with the exact length.
"""


def row_length_warnings(sources: Iterable[PictureSource]) -> Iterator[str]:
    """Yield a warning for each source whose first picture seems to have rows of another length."""
    for source in sources:
        picture = next(source.pictures(), None)
        if isinstance(picture, YuvPlanes) and (length_px := other_row_length(picture.y)):
            yield (
                f"Warning: {source.name}: rows seem to be {length_px} pixels long, not {picture.size[0]}, as rows are then "
                "like their neighbours; is `--size` right?"
            )


def other_row_length(luma: Plane) -> int | None:
    """Return the apparent length in pixels of the rows of a picture of shape (height, width).

    None if it is the given one, or if nothing tells.
    """
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
    """Return the mean square difference of pixels, by their distance."""
    count = len(pixels)
    centred = pixels - pixels.mean()
    spectrum = np.fft.rfft(centred, 2 * count)
    products = np.fft.irfft(spectrum * spectrum.conj(), 2 * count)[:count]
    sums = np.concatenate([[0], np.cumsum(centred**2)])
    distance = np.arange(count)
    squares = sums[count - distance] + sums[count] - sums[distance] - 2 * products
    # For equal rows, only rounding errors are left.
    differences: NDArray[np.float64] = np.round(squares / (count - distance), 6)
    return differences
