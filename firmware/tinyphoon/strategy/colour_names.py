"""Colours by name and by hue in degrees, as bits of the 32-colour image.

The degrees are those of the firmware's own colour circle: the angle of (V, U), from V towards U. Grey has no U and no V,
so the angle of a colour depends only on its HSV hue, however dark or pale it is. In BT.601, for R, G and B from 0 to 1:

    U = -0.169 R - 0.331 G + 0.500 B        V = 0.500 R - 0.419 G - 0.081 B

Red lies at 341 degrees, orange (255, 128, 0) at 311, yellow at 279, green at 218, cyan at 161, blue at 99, magenta at 38.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from operator import or_

from tinyphoon.stages.blob_detection import hues
from tinyphoon.stages.colour_reduction import BLACK, HUES, WHITE

HUE_DEG = 360 / HUES
"""The width of a hue: 12.86 degrees."""

NARROWEST_DEG = 13
"""A range of this width contains the middle of a hue, wherever it lies."""

# Where one name ends the next one begins, at a border between two of the 28 hues. In brackets are the HSV hues of
# everyday things of that name: tomatoes and poppies, carrots and golf balls, lemons and bananas, grass and limes.
NAMED_DEG: Mapping[str, tuple[int, int]] = {
    "red": (334, 13),  # 327 to 8
    "orange": (296, 334),  # 8 to 43
    "yellow": (257, 296),  # 43 to 82
    "green": (193, 257),  # 82 to 147
    "cyan": (141, 193),  # 147 to 201
    "blue": (90, 141),  # 201 to 250
    "purple": (51, 90),  # 250 to 285
    "magenta": (13, 51),  # 285 to 327
}

WITHOUT_HUE: Mapping[str, int] = {"black": BLACK, "white": WHITE}

COLOUR_NAMES = (*NAMED_DEG, *WITHOUT_HUE)


def width_deg(first: float, last: float) -> float:
    """Return how many degrees lie from `first` up to `last`, 0 to 360; a range may extend past 360."""
    return last - first if last >= first else last - first + 360


def colours_between(first: float, last: float) -> int:
    """Return the hues, as bits, whose middles lie from `first` up to `last` degrees."""
    inside = (hue for hue in range(HUES) if ((hue + 0.5) * HUE_DEG - first) % 360 <= width_deg(first, last))
    return reduce(or_, (hues(hue, hue) for hue in inside), 0)


def colours_named(name: str) -> int:
    """Return the colours of one of `COLOUR_NAMES`, as bits."""
    return WITHOUT_HUE[name] if name in WITHOUT_HUE else colours_between(*NAMED_DEG[name])


def names_of(colours: int) -> list[str]:
    """Return the names with at least one colour among the bits."""
    return [name for name in COLOUR_NAMES if colours & colours_named(name)]
