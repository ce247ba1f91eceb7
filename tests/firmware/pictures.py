"""Pictures that a kernel may get wrong: flat, steep, noisy, narrow."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]

WIDTHS = (4, 6, 320)


def three_rows(width: int) -> Iterator[Bytes]:
    """Pictures of three rows, for kernels that make one row of three."""
    rng = np.random.default_rng(width)
    x, y = np.meshgrid(np.arange(width), np.arange(3))
    yield np.zeros((3, width), np.uint8)
    yield np.full((3, width), 255, np.uint8)
    yield ((x + y) % 2 * 255).astype(np.uint8)
    yield (x % 2 * 255).astype(np.uint8)
    yield (x // 2 % 2 * 255).astype(np.uint8)
    yield (y * 100).astype(np.uint8)
    yield (x * 255 // (width - 1)).astype(np.uint8)
    yield (255 - x * 255 // (width - 1)).astype(np.uint8)
    yield np.clip(40 + 3 * x + 20 * y + rng.normal(0, 2, x.shape), 0, 255).astype(np.uint8)
    yield rng.integers(0, 256, (3, width), np.uint8)
    yield rng.choice(np.array([0, 255], np.uint8), (3, width))


def random_uyvy(width: int, height: int, seed: int) -> Bytes:
    """A picture of coloured squares of four pixels with noise, bytes U Y V Y: edges, hues, black and white."""
    rng = np.random.default_rng(seed)
    squares = rng.integers(0, 256, (height // 4 + 1, width // 4 + 1, 3))
    pixels = squares.repeat(4, axis=0).repeat(4, axis=1)[:height, :width]
    noisy = np.clip(pixels + rng.integers(-3, 4, pixels.shape), 0, 255).astype(np.uint8)
    uyvy = np.empty((height, 2 * width), np.uint8)
    uyvy[:, 1::2] = noisy[:, :, 0]
    uyvy[:, 0::4], uyvy[:, 2::4] = noisy[:, ::2, 1], noisy[:, ::2, 2]
    return uyvy
