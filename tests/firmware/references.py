"""What the firmware must compute, for whole pictures and in plain numpy; shares no code with the firmware.

Pictures are two-dimensional. Rows beyond the top and the bottom repeat the outermost one; the leftmost and the
rightmost column of a 3x3 operation have fixed values, so what lies beyond them does not matter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[Any]

NEIGHBOURHOOD = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]


def neighbour(picture: Picture, dy: int, dx: int) -> Picture:
    """Return the picture of every pixel's neighbour `dy` rows below and `dx` columns to the right."""
    height, width = picture.shape
    return np.pad(picture, 1, mode="edge")[1 + dy : 1 + dy + height, 1 + dx : 1 + dx + width]


def weighted(picture: Picture, weights: list[list[int]]) -> NDArray[np.int64]:
    """Return the sum of the 3x3 neighbourhood of every pixel, weighted."""
    wide = picture.astype(np.int64)
    return sum(
        (weights[dy + 1][dx + 1] * neighbour(wide, dy, dx) for dy, dx in NEIGHBOURHOOD), np.zeros_like(wide)
    )


def with_border(picture: Picture, border: Picture | int) -> Picture:
    """Return `picture` with its first and last column taken from `border`."""
    result = np.full_like(picture, border)
    result[:, 1:-1] = picture[:, 1:-1]
    return result


def luma(uyvy: Picture) -> Picture:
    """Return Y of pictures of bytes U Y V Y."""
    return uyvy[:, 1::2]


def gauss3(picture: Picture) -> Picture:
    """Smooth with 1-2-1 by 1-2-1 sixteenths, rounded down."""
    smooth = weighted(picture, [[1, 2, 1], [2, 4, 2], [1, 2, 1]]) // 16
    return with_border(smooth, picture)


def sobel(picture: Picture) -> tuple[Picture, Picture]:
    """Return the gradients to the right and downwards."""
    gx = weighted(picture, [[-1, 0, 1], [-2, 0, 2], [-1, 0, 1]])
    gy = weighted(picture, [[-1, -2, -1], [0, 0, 0], [1, 2, 1]])
    return with_border(gx, 0), with_border(gy, 0)


def magnitude(gx: Picture, gy: Picture) -> Picture:
    """Return a quarter of the length, rounded down twice, saturated at 255."""
    root = np.floor(np.sqrt(gx.astype(np.int64) ** 2 + gy.astype(np.int64) ** 2))
    return np.minimum(root // 4, 255).astype(np.int64)


def angle(x: Picture, y: Picture) -> NDArray[np.int64]:
    """Return the 8-bit angle: arctangent of short by long side in steps of 1/256, unfolded by octants."""
    x, y = x.astype(np.int64), y.astype(np.int64)
    short, long = np.minimum(abs(x), abs(y)), np.maximum(abs(x), abs(y))
    octant = np.rint(np.arctan2(256 * short // np.maximum(long, 1), 256) * 256 / (2 * np.pi)).astype(np.int64)
    quadrant = np.where(abs(y) > abs(x), 64 - octant, octant)
    half = np.where(x < 0, 128 - quadrant, quadrant)
    return np.where(y < 0, 256 - half, half) % 256


def angle_of(x: int, y: int) -> int:
    """Return the 8-bit angle of one vector."""
    return int(angle(np.array([x]), np.array([y]))[0])


def suppress(gradient: Picture, direction: Picture, threshold: int) -> Picture:
    """Remove what is under the threshold first, then what is no maximum along the gradient (T §2.1.4)."""
    strong = np.where(gradient >= threshold, gradient, 0).astype(np.int64)
    kept = np.zeros_like(strong)
    # a direction of 0 (mod 128) is horizontal, 32 goes down to the right, 64 is vertical, 96 down to the left
    for centre, (dy, dx) in {0: (0, 1), 32: (1, 1), 64: (1, 0), 96: (1, -1)}.items():
        along = (direction.astype(np.int64) - centre + 16) % 128 < 32
        maximum = (strong >= neighbour(strong, -dy, -dx)) & (strong > neighbour(strong, dy, dx))
        kept[along & maximum] = strong[along & maximum]
    return with_border(kept, 0)


def colours(
    uyvy: Picture, eps_black: int, eps_white: int, least_chroma: int, groups: Sequence[int] = ()
) -> NDArray[np.uint32]:
    """Reduce to one bit of 32 per pixel, or none (T Eq. 5.1-5.4, and the least chroma), each pixel by itself.

    A pixel with a bit of a group has all bits of that group.
    """
    u = np.repeat(uyvy[:, 0::4], 2, axis=1).astype(np.int64) - 128
    v = np.repeat(uyvy[:, 2::4], 2, axis=1).astype(np.int64) - 128
    chroma = np.floor(np.sqrt(v**2 + u**2)).astype(np.int64)
    brightness = luma(uyvy) - chroma
    black = (brightness < eps_black) & ((chroma < least_chroma) | (least_chroma == 0))
    hue = np.where(chroma < least_chroma, 0, 1 << 3 + 28 * angle(v, u) // 256)
    words = np.select([black, brightness > eps_white], [1 << 1, 1 << 2], hue).astype(np.uint32)
    for group in groups:
        words[words & group != 0] = group
    return words


def erode(picture: Picture) -> Picture:
    """Keep the bits that the whole 3x3 neighbourhood has."""
    return with_border(np.bitwise_and.reduce([neighbour(picture, dy, dx) for dy, dx in NEIGHBOURHOOD]), 0)


def dilate(picture: Picture) -> Picture:
    """Take every bit of the 3x3 neighbourhood."""
    return with_border(np.bitwise_or.reduce([neighbour(picture, dy, dx) for dy, dx in NEIGHBOURHOOD]), 0)


@dataclass(frozen=True, slots=True)
class EdgeStore:
    """The three arrays of the edge store, as far as they are used, and the edges that had no room."""

    data: list[int]
    index: list[int]
    counts: list[int]
    lost: int


def edge_store(edges: Picture, direction: Picture, capacity: int) -> EdgeStore:
    """Collect the edges row by row, from left to right, until the store is full."""
    data: list[int] = []
    index, counts, found = [], [], 0
    for row, directions in zip(edges.tolist(), direction.tolist(), strict=True):
        words = [
            int.from_bytes(bytes([gradient, directions[x], x % 256, x // 256]), "little")
            for x, gradient in enumerate(row)
            if gradient
        ]
        index.append(len(data))
        data = (data + words)[:capacity]
        counts.append(len(data) - index[-1])
        found += len(words)
    return EdgeStore(data, index, counts, found - len(data))


def opened(picture: Picture) -> Picture:
    """Remove what is narrower than three pixels (T §2.3.1)."""
    return dilate(erode(picture))


def closed(picture: Picture) -> Picture:
    """Fill what is narrower than three pixels; what lies beyond the border is as what is beside it (T §2.3.1)."""
    grown = np.pad(dilate(picture)[:, 1:-1], ((0, 0), (1, 1)), mode="edge")
    return erode(grown)
