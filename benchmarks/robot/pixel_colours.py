"""Colours as T Eq. 5.1 to 5.4 are written: of each pixel its own root and its own hue."""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u32
from tinyphoon.arithmetic import angle8, isqrt32
from tinyphoon.stages.colour_reduction import DARKEST, FIRST_HUE, HUES, MOST_CHROMA, colour_word


@kernel
def pixel_colour(
    luma: i32, u: i32, v: i32, atan: u8[:], joined_colours: u32[:], eps_black: i32, eps_white: i32, least: i32
) -> u32:
    """Return the word of a pixel (T Eq. 5.1 to 5.3); one with less chroma than `least` has no hue, as in `colour_row`."""
    chroma = i32(isqrt32(u32(v * v + u * u)))
    brightness = luma - chroma
    never_black = least if least != 0 else MOST_CHROMA + 1
    darkest = eps_black if chroma < never_black else DARKEST
    hue: u32 = 0
    if chroma >= least and darkest <= brightness <= eps_white:
        hue = joined_colours[FIRST_HUE + (angle8(v, u, atan) * HUES >> 8)]
    return colour_word(brightness, hue, darkest, eps_white, joined_colours)


@kernel
def pixel_colours_row(
    uyvy: u8[:],
    atan: u8[:],
    joined_colours: u32[:],
    colours: u32[:],
    eps_black: i32,
    eps_white: i32,
    least_chroma: i32,
) -> None:
    """Reduce the colours of one row as `colour_row` does, pixel by pixel (T Eq. 5.4)."""
    for x in range(len(colours)):
        pair = 2 * x & -4
        u = uyvy[pair] - 128
        v = uyvy[pair + 2] - 128
        colours[x] = pixel_colour(
            uyvy[2 * x + 1], u, v, atan, joined_colours, eps_black, eps_white, least_chroma
        )
