"""Detect grey pictures that are raw pixels behind colour filters; an image file does not say so.

In an ordinary picture, adjacent pixels are more alike than those two apart. Behind the filters of a Bayer pattern,
pixels two apart have the same colour and are more alike.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.importing.sources import PictureSource
from bfsim.recording.planes import Plane, YuvPlanes

MOSAIC_RATIO = 1.1
"""The difference of adjacent pixels over that of pixels two apart: the warning begins above this ratio.

It is 0.78 at most in real grey pictures (66 measured), and at least 1.26 in mosaics of real ones (36 measured). There
is no warning for any of 104 real grey pictures, and one for 71 of 72 mosaics.
"""


def mosaic_warnings(sources: Iterable[PictureSource]) -> Iterator[str]:
    """Yield a warning for each source whose first picture is grey and seems to be a mosaic of colours."""
    for source in sources:
        picture = next(source.pictures(), None)
        if isinstance(picture, YuvPlanes) and _is_grey(picture) and is_mosaic(picture.y):
            yield (
                f"Warning: {source.name}: grey pixels seem to be raw ones behind a pattern of colour filters, as every second "
                "one is alike; `--format bayer_rggb8`, or another pattern of a camera, makes colours of them"
            )


def _is_grey(picture: YuvPlanes) -> bool:
    return all(each.size and each.min() == each.max() for each in (picture.u, picture.v))


def is_mosaic(luma: Plane) -> bool:
    """Whether adjacent pixels, shape (height, width), differ more than those two apart, both across and down.

    Dithered black and white does so, too, and is excluded; a picture of less than three pixels is not judged.
    """
    if min(luma.shape) < 3 or ((luma == luma.min()) | (luma == luma.max())).all():
        return False
    pixels = luma.astype(np.int16)
    return all(_apart(each, 1) > MOSAIC_RATIO * _apart(each, 2) for each in (pixels, pixels.T))


def _apart(rows: NDArray[np.int16], step: int) -> float:
    """Return the mean difference of pixels that are `step` apart in their row."""
    return float(np.abs(rows[:, step:] - rows[:, :-step]).mean())
