"""Colour reduction: black, white and 28 hues as one bit of a 32-bit word per pixel (T §5.2.3, Eq. 5.1-5.4).

It has no task of its own: it runs on the lines that the edge detection reads.

By Eq. 5.2 alone grey gets a hue, that of its noise, and what has more chroma than luma is black: a red ball in daylight. A
least chroma mends both [ours]: a pixel with less has no hue, so that it is black, white or of no colour; one with as much
is never black, however dark. A least chroma of 0 is the thesis's rule.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u32
from tinyphoon.arithmetic import angle8, isqrt32

BLACK = 1 << 1  # T Eq. 5.2 and 5.3: class 1
WHITE = 1 << 2
FIRST_HUE = 3
HUES = 28
MOST_CHROMA = 181  # of U and V of -128
DARKEST = -MOST_CHROMA  # no luma less its chroma is below


@kernel
def colour_word(brightness: i32, hue: u32, eps_black: i32, eps_white: i32) -> u32:
    """Return the word of a pixel by its luma less its chroma (T Eq. 5.2)."""
    if brightness < eps_black:
        return BLACK
    if brightness > eps_white:
        return WHITE
    return hue


@kernel
def colour_row(
    uyvy: u8[:], atan: u8[:], colours: u32[:], eps_black: i32, eps_white: i32, least_chroma: i32
) -> None:
    """Reduce the colours of one row: `2 * width` bytes to `width` words.

    The two pixels of a pair share U and V, and with them root and hue. The hue is looked up only if one of
    the two may have a colour. It is the 8-bit angle of (V, U) cut into 28 equal parts: dividing it by 10, as
    T Eq. 5.2 is printed, would make 26 hues and not the 28 of its text. A pixel of no colour is 0.
    """
    never_black = least_chroma if least_chroma != 0 else MOST_CHROMA + 1
    for pair in range(len(colours) >> 1):
        u = uyvy[4 * pair] - 128
        v = uyvy[4 * pair + 2] - 128
        chroma = i32(isqrt32(u32(v * v + u * u)))
        left = uyvy[4 * pair + 1] - chroma
        right = uyvy[4 * pair + 3] - chroma
        darkest = eps_black if chroma < never_black else DARKEST
        hue: u32 = 0
        if chroma >= least_chroma and max(left, right) >= darkest and min(left, right) <= eps_white:
            hue = u32(1) << (FIRST_HUE + (angle8(v, u, atan) * HUES >> 8))
        colours[2 * pair] = colour_word(left, hue, darkest, eps_white)
        colours[2 * pair + 1] = colour_word(right, hue, darkest, eps_white)
