"""How a sensor makes smaller pictures: it skips pixels and lines without averaging (OV9650 data sheet, sub-sampling)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SKIPS = (1, 2, 4)
"""One pixel in so many is sent, in each direction: VGA, QVGA and QQVGA for a sensor of 640x480."""


def skipped(picture: NDArray[np.uint8], step: int) -> NDArray[np.uint8]:
    """Return every `step`-th pixel of every `step`-th line of a UYVY picture (height, 2 · width).

    Two pixels that become a pair get the colour of the left one's original pair. Width and height are rounded down.
    """
    if step == 1:
        return picture
    height, width = picture.shape[0] // step, picture.shape[1] // 2 // step
    lines = picture[: height * step : step]
    luma = lines[:, 1::2][:, ::step][:, :width]
    sent = np.empty((height, 2 * width), np.uint8)
    sent[:, 1::2] = luma
    sent[:, 0::4] = lines[:, 0::4][:, ::step][:, : width // 2]
    sent[:, 2::4] = lines[:, 2::4][:, ::step][:, : width // 2]
    return sent
