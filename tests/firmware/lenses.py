"""Rectification tables of lenses that never were, and what they must make of a picture; plain numpy."""

from __future__ import annotations

from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from bfsim.api import SourcePixels
from tests.firmware.references import Picture


def source_points(
    width: int, height: int, *, barrel: float = 0.0, turn_deg: float = 0.0, down_px: float = 0.0
) -> tuple[Picture, Picture]:
    """Return the exact source row and column of every rectified pixel of a bent, turned and shifted camera.

    `barrel` is how far a pixel at half the width from the centre is moved towards it, as a share of that distance.
    """
    y, x = np.mgrid[:height, :width].astype(float)
    x, y = x - (width - 1) / 2, y - (height - 1) / 2
    scale = 1 - barrel * (x**2 + y**2) / (width / 2) ** 2
    turn = np.radians(turn_deg)
    rows = (np.sin(turn) * x + np.cos(turn) * y) * scale + (height - 1) / 2 + down_px
    columns = (np.cos(turn) * x - np.sin(turn) * y) * scale + (width - 1) / 2
    return rows, columns


def nearest(rows: Picture, columns: Picture) -> SourcePixels:
    """Return the table of the nearest pixels; -1 for points outside of the picture."""
    height, width = rows.shape
    row, column = np.rint(rows).astype(np.int32), np.rint(columns).astype(np.int32)
    outside = (row < 0) | (row >= height) | (column < 0) | (column >= width)
    row[outside] = column[outside] = -1
    return SourcePixels(row, column)


def rectified(uyvy: Picture, sources: SourcePixels) -> Picture:
    """Move every pixel by itself: the luma from its source, the colour from that of the pair's left pixel."""
    height, width = sources.rows.shape
    result = np.empty_like(uyvy)
    for y in range(height):
        for x in range(width):
            row, column = sources.rows[y, x], sources.columns[y, x]
            result[y, 2 * x + 1] = uyvy[row, 2 * column + 1] if row >= 0 else 0
            if x % 2 == 0:
                pair = column // 2
                result[y, 2 * x] = uyvy[row, 4 * pair] if row >= 0 else 128
                result[y, 2 * x + 2] = uyvy[row, 4 * pair + 2] if row >= 0 else 128
    return result


def sighted(sources: SourcePixels) -> NDArray[np.bool_]:
    """Return which pixels can be edges: in each row the longest stretch without a sourceless pixel within four pixels."""
    blind = sources.rows < 0
    height, width = blind.shape
    result = np.zeros((height, width), bool)
    for y in range(height):
        above, below = max(0, y - 4), min(height, y + 5)
        clear = [not blind[above:below, max(0, x - 4) : x + 5].any() for x in range(width)]
        stretches = [list(group) for _, group in groupby(range(width), key=lambda x: clear[x])]
        best = max((each for each in stretches if clear[each[0]]), key=len, default=[])
        result[y, best] = True
    return result


def bilinear(luma: Picture, rows: Picture, columns: Picture) -> Picture:
    """Return the luma by four tables and four weights; the picture's border is repeated outside."""
    height, width = luma.shape
    top, left = np.floor(rows).astype(int), np.floor(columns).astype(int)
    down, right = rows - top, columns - left
    result = np.zeros(luma.shape)
    for dy, dx in ((0, 0), (0, 1), (1, 0), (1, 1)):
        weight = abs(1 - dy - down) * abs(1 - dx - right)
        result += weight * luma[np.clip(top + dy, 0, height - 1), np.clip(left + dx, 0, width - 1)]
    return result
