"""Camera pictures in colours for people."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image


def rgb_of(uyvy: NDArray[np.uint8]) -> Image.Image:
    """Return a UYVY picture of shape (height, 2 · width), full range BT.601, as a Pillow image."""
    height, width = uyvy.shape[0], uyvy.shape[1] // 2
    planes = uyvy[:, 1::2], uyvy[:, 0::4].repeat(2, axis=1), uyvy[:, 2::4].repeat(2, axis=1)
    image = Image.frombytes("YCbCr", (width, height), np.stack(planes, axis=2).tobytes())
    return image.convert("RGB")
