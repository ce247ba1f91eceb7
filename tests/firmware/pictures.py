"""Pictures that a kernel may get wrong: flat, steep, noisy, narrow."""

from __future__ import annotations

from collections.abc import Callable, Iterator

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


def grey_uyvy(luma: NDArray[np.integer]) -> Bytes:
    """A picture of these grey levels without colour."""
    height, width = luma.shape
    uyvy = np.full((height, 2 * width), 128, np.uint8)
    uyvy[:, 1::2] = luma
    return uyvy


def grid(width: int, height: int) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Columns and rows of a picture's pixels."""
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    return x, y


def flat(value: int) -> Callable[[int, int], Bytes]:
    """Pictures with this value in every byte."""
    return lambda width, height: np.full((height, 2 * width), value, np.uint8)


def stripes(period: int, across: int, down: int) -> Callable[[int, int], Bytes]:
    """Black and white stripes; `across` and `down` are the steps that the phase takes from pixel to pixel."""

    def picture(width: int, height: int) -> Bytes:
        x, y = grid(width, height)
        return grey_uyvy((across * x + down * y) // period % 2 * 255)

    return picture


def checkerboard(square: int) -> Callable[[int, int], Bytes]:
    """Black and white squares."""

    def picture(width: int, height: int) -> Bytes:
        x, y = grid(width, height)
        return grey_uyvy((x // square + y // square) % 2 * 255)

    return picture


def coloured_squares(square: int, bright: int) -> Callable[[int, int], Bytes]:
    """Squares of the colours of the mode and of none by turns, so that none touches another of its colour."""
    pairs = np.array([(180, 90), (60, 150), (110, 180), (128, 128)])  # U and V: blue, yellow, red, none

    def picture(width: int, height: int) -> Bytes:
        x, y = grid(width // 2, height)
        number = (2 * x // square + 2 * (y // square)) % len(pairs)
        uyvy = np.full((height, 2 * width), bright, np.uint8)
        uyvy[:, 0::4], uyvy[:, 2::4] = np.moveaxis(pairs[number], -1, 0)
        return uyvy

    return picture


def noise(values: int) -> Callable[[int, int], Bytes]:
    """Bytes by chance below `values`."""
    return lambda width, height: np.random.default_rng(values).integers(
        0, values, (height, 2 * width), np.uint8
    )


EXTREMES: dict[str, Callable[[int, int], Bytes]] = {
    "all black": lambda width, height: grey_uyvy(np.zeros((height, width), np.uint8)),
    "all white": lambda width, height: grey_uyvy(np.full((height, width), 255, np.uint8)),
    "zeros": flat(0),
    "ones": flat(255),
    "checkerboard of pixels": checkerboard(1),
    "checkerboard of two pixels": checkerboard(2),
    "checkerboard of five pixels": checkerboard(5),
    "columns": stripes(1, 1, 0),
    "columns of two pixels": stripes(2, 1, 0),
    "an edge in every third column": stripes(3, 1, 0),
    "an edge in every third row": stripes(3, 0, 1),
    "slopes": stripes(6, 1, 2),
    "flat slopes to the left": stripes(12, -1, 7),
    "coloured squares": coloured_squares(6, 100),
    "coloured columns": coloured_squares(2, 100),
    "coloured specks": coloured_squares(3, 180),
    "faint noise": noise(30),
    "noise": noise(256),
}
"""Pictures of any size that no camera takes."""
