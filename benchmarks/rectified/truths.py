"""What is known exactly of a frame's rectified left picture: straight borders in it, and disparities.

Of a rendered frame the scene tells both: the edges of its box that are visible, and the disparity of each pixel. Of a
frame with a chessboard its corners do, found by OpenCV in the pictures as the cameras took them. A corner's place in
the rectified picture is that of a plane through the places of the rectified pixels whose sources lie around it, so it
is finer than a table's pixels. The borders of the squares are straight lines through the corners; and on a board, which
is flat, the disparity is a plane, too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.real.sets import Disparities
from bfsim.api import SourcePixels
from bfsim.recording import StereoFrame

CORNERS = 9, 6
AROUND_PX = 6

Points = NDArray[np.float64]
"""Rows of x and y in pixels."""


@dataclass(frozen=True, slots=True)
class Truth:
    """`borders`: ends of straight borders (count, 2, 2). `disparities` are right to `reach` pixels: at a border there are two."""

    borders: Points
    disparities: Disparities
    reach: int


def truth_of(frame: StereoFrame, tables: Mapping[str, SourcePixels]) -> Truth | None:
    """Return what is known of a frame; `tables`: sources of each side's rectified pixels. None where that is nothing."""
    if frame.truth is not None and frame.disparity_px is not None:
        disparities = frame.disparity_px.astype(float)
        return Truth(_box_borders(frame.truth), np.where(disparities > 0, disparities, np.nan), reach=1)
    corners = {side: corners_of(getattr(frame, side)) for side in tables}
    if any(each is None for each in corners.values()):
        return None
    left, right = (
        np.array([rectified_place(tables[side], corner) for corner in corners[side]])
        for side in ("left", "right")
    )
    return Truth(_board_borders(left), _board_disparities(left, right, tables["left"].rows.shape), reach=0)


def corners_of(uyvy: NDArray[np.uint8]) -> Points | None:
    """Return the corners of the chessboard in a picture (count, 2), row by row from the left, or None."""
    luma = np.ascontiguousarray(uyvy[:, 1::2])
    found, corners = cv2.findChessboardCornersSB(luma, CORNERS, flags=cv2.CALIB_CB_ACCURACY)
    if not found:
        return None
    points: Points = corners.reshape(-1, 2).astype(float)
    return points if points[0, 0] < points[-1, 0] else points[::-1]


def rectified_place(table: SourcePixels, point: Points) -> Points:
    """Return where a point of a camera's picture lies in the rectified one."""
    rows, columns = table.rows, table.columns
    near = (abs(rows - point[1]) <= AROUND_PX) & (abs(columns - point[0]) <= AROUND_PX)
    to_y, to_x = np.nonzero(near)
    sources = np.column_stack([np.ones(len(to_x)), columns[near] - point[0], rows[near] - point[1]])
    place: Points = np.linalg.lstsq(sources, np.column_stack([to_x, to_y]), rcond=None)[0][0]
    return place


def _box_borders(truth: Mapping[str, Any]) -> Points:
    edges = truth["box"]["edges"].values() if "box" in truth else ()
    seen = [each["left"] for each in edges if each["left"] is not None]
    return np.array([each["ends_px"] for each in seen if all(each["visible"])]).reshape(-1, 2, 2)


def _board_borders(corners: Points) -> Points:
    """Return the lines through the rows and columns of corners, from the first corner to the last, least squares across."""
    across, down = CORNERS
    grid = corners.reshape(down, across, 2)
    return np.array([_line_through(points) for points in (*grid, *grid.swapaxes(0, 1))])


def _line_through(points: Points) -> Points:
    middle = points.mean(axis=0)
    along = np.linalg.svd(points - middle)[2][0]
    return middle + np.outer((points[[0, -1]] - middle) @ along, along)


def _board_disparities(left: Points, right: Points, shape: tuple[int, int]) -> Disparities:
    """Return the disparities within the outermost corners; NaN elsewhere."""
    terms = np.column_stack([left, np.ones(len(left))])
    plane = np.linalg.lstsq(terms, left[:, 0] - right[:, 0], rcond=None)[0]
    inside = np.zeros(shape, np.uint8)
    cv2.fillConvexPoly(inside, np.rint(cv2.convexHull(left.astype(np.float32))).astype(np.int32), 1)
    rows, columns = np.indices(shape)
    return np.where(inside > 0, plane[0] * columns + plane[1] * rows + plane[2], np.nan)
