"""Colours of marks in pictures and in space, for a dark field. All of them are ours."""

from __future__ import annotations

import colorsys

from bfsim.seen.features import Colour

EDGE: Colour = (64, 205, 215)
LINE: Colour = (255, 92, 205)
CIRCLE: Colour = (150, 255, 90)
FAILED: Colour = (170, 110, 110)

NEAR_MM, FAR_MM = 200.0, 1600.0
"""Of the scale of depths: from what just fits into both pictures to the end of a room."""

_NEAR_HUE, _FAR_HUE = 0.02, 0.62  # red to blue
_LIGHTNESS = 0.66


def depth_colour(depth_mm: float) -> Colour:
    """Return the colour of a depth: red for near, blue for far."""
    part = min(max((depth_mm - NEAR_MM) / (FAR_MM - NEAR_MM), 0.0), 1.0)
    red, green, blue = colorsys.hls_to_rgb(_NEAR_HUE + part * (_FAR_HUE - _NEAR_HUE), _LIGHTNESS, 1.0)
    return round(255 * red), round(255 * green), round(255 * blue)
