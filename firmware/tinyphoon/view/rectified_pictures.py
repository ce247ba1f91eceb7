"""The rectified picture under rectified features, for people: nothing on the chip needs one.

The places of the camera's pixels are known, but the sources of the rectified ones are needed: each is sought from the
pixel itself, correcting by the error of its place. This converges if a lens moves neighbours by less than their distance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tinyphoon.areas import Area
from tinyphoon.stages.rectified_places import COLUMNS, NODE_PX, NODES, ROWS
from tinyphoon.stores.lines import SUBPIXELS

STEPS = 12
BLACK_PAIR = (128, 0, 128, 0)  # U Y V Y

Points = NDArray[np.float64]


def rectified_picture(picture: NDArray[np.uint8], places: NDArray[np.int16], area: Area) -> NDArray[np.uint8]:
    """Return an area of the rectified picture, UYVY: each pixel is the camera's nearest, black outside of `picture`."""
    height, width = picture.shape[0], picture.shape[1] // 2
    rows, columns = np.indices((area.height, area.width))
    wanted = np.stack([columns + area.x, rows + area.y], axis=-1).astype(float)
    nodes = places[NODES:].reshape(places[ROWS], places[COLUMNS], 2) / SUBPIXELS
    sources = wanted.copy()
    for _ in range(STEPS):
        sources += wanted - _placed(nodes, sources)
    x, y = np.moveaxis(np.rint(sources).astype(int), -1, 0)
    inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    x, y = np.where(inside, x, 0), np.where(inside, y, 0)
    rectified = np.empty((area.height, 2 * area.width), np.uint8)
    rectified[:, 1::2] = np.where(inside, picture[y, 2 * x + 1], BLACK_PAIR[1])
    for byte in (0, 2):  # both pixels of a pair get the colour of the left one
        colour = picture[y, 4 * (x // 2) + byte]
        rectified[:, byte::4] = np.where(inside, colour, BLACK_PAIR[byte])[:, ::2]
    return rectified


def _placed(nodes: Points, points: Points) -> Points:
    """Return the places of points in the camera's picture, interpolated between nodes; beyond them, extrapolated."""
    last = np.array(nodes.shape[1::-1]) - 2
    cells = np.clip(np.floor(points / NODE_PX).astype(int), 0, last)
    right, below = np.moveaxis(points / NODE_PX - cells, -1, 0)[..., None]
    column, row = np.moveaxis(cells, -1, 0)
    upper = nodes[row, column] * (1 - right) + nodes[row, column + 1] * right
    lower = nodes[row + 1, column] * (1 - right) + nodes[row + 1, column + 1] * right
    placed: Points = upper * (1 - below) + lower * below
    return placed
