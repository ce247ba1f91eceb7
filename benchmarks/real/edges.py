"""Edges of real pictures by bands of rows, beside `cv2.Canny` with like parameters (`benchmarks.quality.edges`).

A store that fills from the top loses the lower part of a cluttered picture, the near floor. Recall by thirds of the
rows shows it; `blind rows` are those in which Canny sees an edge and the firmware none.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from benchmarks.quality.edges import NEAR, opencv_edges
from bfsim.api import Seen
from bfsim.report.tables.table import percent

TITLE = "Edges by thirds of the rows"
COLUMNS = "edges", "prec. %", "recall: top", "middle", "low", "blind rows %", "lost"
NOTE = "Recall in % of cv2.Canny's edges, within 1 px. Blind rows: with edges of Canny's and none of ours. Edges and lost: a picture."
BANDS = 3


def cells(seen: Sequence[Seen]) -> list[str]:
    """Return the numbers of a set of pictures, one a camera."""
    near = ours = lost = blind = rows = 0
    kept, theirs = np.zeros(BANDS, int), np.zeros(BANDS, int)
    for each in seen:
        own = np.zeros((each.height_px, each.width_px), np.uint8)
        own[each.edges.y_px, each.edges.x_px] = 1
        other = opencv_edges(np.ascontiguousarray(each.picture[:, 1::2]))
        ours += int(own.sum())
        near += int((own & cv2.dilate(other, NEAR)).sum())
        hit = other & cv2.dilate(own, NEAR)
        for band, (found, wanted) in enumerate(
            zip(np.array_split(hit, BANDS), np.array_split(other, BANDS), strict=True)
        ):
            kept[band] += int(found.sum())
            theirs[band] += int(wanted.sum())
        has = other.any(axis=1)
        rows += int(has.sum())
        blind += int((has & ~own.any(axis=1)).sum())
        lost += each.edges.lost
    return [
        f"{ours / len(seen):,.0f}",
        percent(near, ours),
        *(percent(int(one), int(all_)) for one, all_ in zip(kept, theirs, strict=True)),
        percent(blind, rows),
        f"{lost / len(seen):,.0f}",
    ]
