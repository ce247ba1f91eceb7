"""A drawing colour for the bits of the 32-colour image."""

from __future__ import annotations

import math

from bfsim.api import Colour
from tinyphoon.stages.colour_reduction import BLACK, FIRST_HUE, HUES, WHITE

WHITENESS = 0.2
"""White in each drawn hue, so that blue is also bright on a dark picture. [ours]"""


def colour_of(colours: int) -> Colour:
    """Return the (red, green, blue) of a group of colours: bright, and of its mean hue."""
    hues = [hue for hue in range(HUES) if colours >> (FIRST_HUE + hue) & 1]
    if not hues:
        grey = {BLACK: 96, WHITE: 255}.get(colours, 176)
        return grey, grey, grey
    angles = [2 * math.pi * (hue + 0.5) / HUES for hue in hues]
    v, u = sum(map(math.cos, angles)), sum(map(math.sin, angles))  # a hue is the angle of (V, U)
    chroma = 1.402 * v, -0.344 * u - 0.714 * v, 1.772 * u  # BT.601, without the luma
    low, span = min(chroma), (max(chroma) - min(chroma)) or 1.0
    red, green, blue = (round(255 * (WHITENESS + (1 - WHITENESS) * (part - low) / span)) for part in chroma)
    return red, green, blue
