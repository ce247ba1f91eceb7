"""How heat is drawn: a translucent colour over each pixel for its cost, from dark violet to light yellow."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from bfsim.seen.in_pictures import SeenHeat

SHARE = 0.55
"""Opacity of the colour over the picture."""

WITHIN = 0.98
"""Share of the pixels with a cost that the scale covers. More expensive ones get its last colour."""

_STEPS = 256
_LIGHTNESS, _CHROMA, _HUE_DEG = (0.22, 0.94), (0.10, 0.19, 0.15), (300.0, 465.0)
"""In OKLCH: lightness rises evenly for the eye, while the hue goes from violet over red to yellow."""

# OKLab to linear sRGB: Björn Ottosson, "A perceptual color space for image processing", 2020
_TO_LMS = np.array(
    [[1, 0.3963377774, 0.2158037573], [1, -0.1055613458, -0.0638541728], [1, -0.0894841775, -1.2914855480]]
)
_TO_RGB = np.array(
    [
        [4.0767416621, -3.3077115913, 0.2309699292],
        [-1.2684380046, 2.6097574011, -0.3413193965],
        [-0.0041960863, -0.7034186147, 1.7076147010],
    ]
)


def _scale() -> NDArray[np.uint8]:
    part = np.linspace(0, 1, _STEPS)
    lightness = np.interp(part, (0, 1), _LIGHTNESS)
    chroma = np.interp(part, (0, 0.5, 1), _CHROMA)
    hue = np.radians(np.interp(part, (0, 1), _HUE_DEG))
    lab = np.stack([lightness, chroma * np.cos(hue), chroma * np.sin(hue)], axis=1)
    linear = np.clip((lab @ _TO_LMS.T) ** 3 @ _TO_RGB.T, 0, 1)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.asarray((255 * srgb).round(), np.uint8)


COLOURS = _scale()
"""The colours of heat, of shape (256, 3), from none to the most."""


def row_us(heat: SeenHeat) -> NDArray[np.float64]:
    """Return for each pixel the cost of its row in µs if every pixel in it cost as much."""
    total = heat.total_us()
    total *= total.shape[1]
    return total


def hottest_row_us(heats: Iterable[SeenHeat]) -> float:
    """Return the end of a scale for pictures side by side, in µs per row: WITHIN of the pixels with a cost have at most this.

    The few others are equally bright: on a scale up to the most expensive edge, everything else would be dark.
    """
    costs = [row_us(each).ravel() for each in heats]
    costly = np.concatenate(costs) if costs else np.zeros(0)
    costly = costly[costly > 0]
    return float(np.quantile(costly, WITHIN)) if costly.size else 0.0


def heated(image: Image.Image, heat: SeenHeat, hottest_us: float) -> Image.Image:
    """Return a picture, magnified or not, under its heat. The scale ends at `hottest_us` per row, 0 if no work had a place."""
    if not hottest_us:
        return image
    parts = np.clip(row_us(heat) / hottest_us, 0, 1)
    paint = Image.fromarray(COLOURS[(parts * (_STEPS - 1)).round().astype(int)], "RGB")
    return Image.blend(image, paint.resize(image.size, Image.Resampling.NEAREST), SHARE)
