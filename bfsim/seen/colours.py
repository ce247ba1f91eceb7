"""Colours of marks in pictures and in space, for a dark background. All of them are ours."""

from __future__ import annotations

import colorsys
import math
from dataclasses import dataclass

from bfsim.seen.frame import SeenFrame
from bfsim.seen.in_pictures import Colour

EDGE: Colour = (64, 205, 215)
LINE: Colour = (255, 92, 205)
CIRCLE: Colour = (150, 255, 90)
FAILED: Colour = (170, 110, 110)

LOSS: Colour = (255, 84, 64)

_NEAR_HUE, _FAR_HUE = 0.02, 0.62  # red to blue
_LIGHTNESS = 0.66


@dataclass(frozen=True, slots=True)
class DepthScale:
    """A scale of colours for depths in mm: red for `near_mm` and nearer, blue for `far_mm` and farther."""

    near_mm: float = 200.0
    far_mm: float = 1600.0

    def colour(self, depth_mm: float) -> Colour:
        """Return the colour of a depth."""
        return scale_colour((depth_mm - self.near_mm) / (self.far_mm - self.near_mm))


ROOM = DepthScale()
"""From the nearest depth that is in both pictures to the end of a room."""


def scale_colour(part: float) -> Colour:
    """Return the colour at a position on a scale, 0 to 1: red at its beginning, blue at its end."""
    hue = _NEAR_HUE + min(max(part, 0.0), 1.0) * (_FAR_HUE - _NEAR_HUE)
    red, green, blue = colorsys.hls_to_rgb(hue, _LIGHTNESS, 1.0)
    return round(255 * red), round(255 * green), round(255 * blue)


def depths_of(frame: SeenFrame) -> DepthScale:
    """Return a scale for the depths in a frame, without the twentieth at either end, and with round limits."""
    depths = [depth for line in frame.lines_3d for depth in (line.start_mm[2], line.end_mm[2])]
    depths += [depth for edges in frame.edges_3d() for depth in edges.places_mm[:, 2].tolist()]
    depths += [each.place_mm[2] for each in frame.objects if not each.is_direction]
    known = sorted(each for each in depths if each > 0)
    if not known:
        return ROOM
    near, far = known[len(known) // 20], known[-1 - len(known) // 20]
    step = 10.0 ** max(2, math.floor(math.log10(far)))
    near_mm = math.floor(near / 100) * 100.0
    return DepthScale(near_mm, max(math.ceil(2 * far / step) * step / 2, near_mm + 100))
