"""The ideal pair behind a real one: which way both cameras look after rectification."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def rectified_rotation(baseline: NDArray[np.float64], forward: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the one rotation (3, 3) of both rectified cameras; its rows are their right, down and forward.

    `baseline` (3,) points from the left optical centre to the right one, `forward` (3,) is where the left
    camera looks, both in any one frame, in which the rows are given too. Right is along the baseline, as
    rectification wants it. The freedom that is left, to turn round the baseline, is used to look where the
    left camera looks, so that its tilt stays true; OpenCV splits that turn between the cameras.
    """
    right = baseline / np.linalg.norm(baseline)
    down = np.cross(forward, right)
    down /= np.linalg.norm(down)
    return np.stack([right, down, np.cross(right, down)])
