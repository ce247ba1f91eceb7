"""The looks of overlays: colours and sizes, for a dark field. We chose all of them."""

from __future__ import annotations

from functools import cache

from PIL import ImageFont

from bfsim.seen import Colour

PAPER: Colour = (11, 14, 20)
WORDS: Colour = (222, 228, 238)
FAINT: Colour = (128, 140, 158)

GRID: Colour = (44, 52, 66)

BRIGHTNESS, GAMMA = 0.8, 0.85
"""Of the picture under the marks: a little darker, so that an orange ball stays orange, but no darker where it was dark
already.
"""

PANEL_WIDTH = 960
"""The approximate width of a drawn picture: small ones are magnified by a whole number."""

SMOOTH = 2
"""Marks are drawn so many times larger and then reduced, because Pillow's pen has no soft edges."""

STROKE = 2
DOT = 3.5  # radius of the mark at the start of a line
FAINTEST = 0.45
MARGIN = 20
HEAD = 46
FOOT = 44
FONT = 18
LABEL_FONT = 17
DEPTH_FONT = 15


@cache
def dark_levels() -> list[int]:
    """Return the level to draw for each level of red, then of green, then of blue."""
    return 3 * [round(255 * BRIGHTNESS * (level / 255) ** GAMMA) for level in range(256)]


def faded(colour: Colour, share: float) -> Colour:
    """Return a colour nearer to that of the paper: a `share` of 1 is the full colour, at 0 it can just be read."""
    part = FAINTEST + (1 - FAINTEST) * share
    red, green, blue = (round(low + (high - low) * part) for low, high in zip(PAPER, colour, strict=True))
    return red, green, blue


@cache
def font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Return the font of all words, `size` pixels high."""
    return ImageFont.load_default(size)
