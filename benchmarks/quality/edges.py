"""Edges beside `cv2.Canny` with like parameters, on the same pictures.

Like parameters: the binomial Gauss of the same size, Sobel 3x3, the length of the gradient (L2), and both thresholds
times four, since the firmware stores quarters of a gradient.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from benchmarks.quality.seen import Picture, Seen
from bfsim.report.tables.table import percent
from tinyphoon.strategy.modes import INDOOR_FIELD

TITLE = f"Edges beside cv2.Canny {cv2.__version__}"
COLUMNS = "ours", "OpenCV", "precision %", "recall %", "same %", "lost"
NOTE = (
    "Edge pixels a picture. Precision: share of ours with one of OpenCV's within 1 px; recall the other way round; "
    "same: pixels of both by those of either; lost: no room in the edge store."
)

GRADIENT_UNIT = 4  # Sobel units in one of the firmware
NEAR = np.ones((3, 3), np.uint8)


def opencv_edges(luma: Picture) -> Picture:
    """Return OpenCV's edges of a grey picture as 0 and 1."""
    wanted = INDOOR_FIELD.edges
    smooth = cv2.GaussianBlur(luma, (wanted.gauss_px, wanted.gauss_px), 0, borderType=cv2.BORDER_REPLICATE)
    low, high = GRADIENT_UNIT * wanted.edge_threshold, GRADIENT_UNIT * wanted.strong_threshold
    return cv2.Canny(smooth, low, high, L2gradient=True) & 1


def cells(seen: Sequence[Seen]) -> Sequence[str]:
    """Return the numbers of a recording."""
    pairs = [((each.edges > 0).astype(np.uint8), opencv_edges(each.luma)) for each in seen]
    ours, theirs = (sum(int(each.sum()) for each in side) for side in zip(*pairs, strict=True))
    ours_near = sum(int((own & cv2.dilate(other, NEAR)).sum()) for own, other in pairs)
    theirs_near = sum(int((other & cv2.dilate(own, NEAR)).sum()) for own, other in pairs)
    same = sum(int((own & other).sum()) for own, other in pairs)
    lost = sum(each.results["edges_lost"] for each in seen)
    return [
        f"{ours / len(seen):,.0f}",
        f"{theirs / len(seen):,.0f}",
        percent(ours_near, ours),
        percent(theirs_near, theirs),
        percent(same, ours + theirs - same),
        f"{lost / len(seen):,.0f}",
    ]
