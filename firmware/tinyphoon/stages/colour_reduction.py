"""Colour reduction: black, white and 28 hues as one bit of a 32-bit word per pixel (T §5.2.3, Eq. 5.1-5.4).

It has no task of its own: it runs on the lines that the edge detection reads.

By Eq. 5.2 alone grey gets a hue, that of its noise, and what has more chroma than luma is black: a red ball in daylight. A
least chroma mends both [ours]: a pixel with less has no hue, so that it is black, white or of no colour; one with as much
is never black, however dark. A least chroma of 0 is the thesis's rule.

Light of another colour than the camera's white balance takes it for is balanced before, by the gains of red and blue that
cameras have. What lies in the shade has less chroma by as much as it has less luma: a red half as bright has half the chroma. So the
chroma of dark pixels may get a gain, too, as far as the noise leaves a hue [ours].
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


AS_IT_IS = 64
"""The gain that leaves a colour as it is: gains count in 64ths."""


@kernel
def balance_row(uyvy: u8[:], red_gain: i32, blue_gain: i32, shade_gain: i32) -> None:
    """Multiply red, blue and the chroma of what is dark of one row, in place, by gains in 64ths; the luma stays.

    With U = 0.564 (B - Y) and V = 0.713 (R - Y) [BT.601], a gain of g on blue makes g U + 0.564 (g - 1) Y of U. The two
    pixels of a pair share U and V, and give the mean of their lumas. The gain in the shade is that of pixels without luma, and
    falls to 1 at a luma of 128.
    """
    lift_u = (blue_gain - 64) * 72  # half of 0.564, in 256ths
    lift_v = (red_gain - 64) * 91  # half of 0.713
    gain_u = blue_gain << 8
    gain_v = red_gain << 8
    for pair in range(len(uyvy) >> 2):
        luma = uyvy[4 * pair + 1] + uyvy[4 * pair + 3]
        u = (uyvy[4 * pair] - 128) * gain_u + lift_u * luma >> 14
        v = (uyvy[4 * pair + 2] - 128) * gain_v + lift_v * luma >> 14
        shade = 64 + ((shade_gain - 64) * max(256 - luma, 0) >> 8)
        uyvy[4 * pair] = max(min(u * shade >> 6, 127), -128) + 128
        uyvy[4 * pair + 2] = max(min(v * shade >> 6, 127), -128) + 128


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
