"""Raw pictures of a sensor, with a filter of one colour on each pixel: a Bayer pattern of 8 bits → planes."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from PIL import Image

from bfsim.recording.cameras.camera_model import load_opencv
from bfsim.recording.planes import Plane, YuvPlanes

BayerPattern = Literal["bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"]
"""The colours of the first two pixels, and of those below them, in ROS's names."""
BAYER_PATTERNS: tuple[BayerPattern, ...] = get_args(BayerPattern)

_OPENCV_NAMES = {"bayer_rggb8": "BG", "bayer_bggr8": "RG", "bayer_gbrg8": "GR", "bayer_grbg8": "GB"}
"""OpenCV names a pattern by the second row's second and third pixel, ROS by the first row's first two."""


def planes_of_bayer(pixels: Plane, pattern: str) -> YuvPlanes:
    """Return the picture; the colours that a pixel lacks come from its neighbours. Needs OpenCV."""
    cv2 = load_opencv("to take the colours of a Bayer pattern apart")
    code = getattr(cv2, f"COLOR_Bayer{_OPENCV_NAMES[pattern]}2RGB")
    return YuvPlanes.from_image(Image.fromarray(cv2.cvtColor(np.ascontiguousarray(pixels), code)))
