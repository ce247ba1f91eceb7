"""Colour reduction: black, white and 28 hues as one bit of a 32-bit word per pixel (T §5.2.3, Eq. 5.1-5.4).

It has no task of its own: it runs on the lines that the edge detection reads.

By Eq. 5.2 alone, grey gets a hue, that of its noise, and a colour with more chroma than luma is black: a red ball in
daylight. A least chroma corrects both [ours]: a pixel with less has no hue, so it is black, white or of no colour; one
with as much is never black, however dark. A least chroma of 0 is the thesis's rule.

If the light has another colour than the camera's white balance assumes, the picture is balanced first, by the gains of
red and blue that cameras have. Things in the shade lose chroma in proportion to luma: a red half as bright has half the
chroma. So the chroma of dark pixels may get a gain, too, as far as the noise leaves a hue [ours].

From here on, the colours of one kind of objects count as one [ours]: a pixel of any of them gets the bits of all. Noise
and shade shift a thing's colour to and fro between two hues, and the opening, which keeps what all nine pixels around
have in common, would leave nothing of it.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

import numpy as np

from bfsim.api import Buffer, Core, i32, kernel, u8, u32
from tinyphoon.arithmetic import angle8, isqrt32

# Numbers of the colours, and so of their bits. 0 is no colour.
BLACK_NUMBER = 1  # T Eq. 5.2 and 5.3: class 1
WHITE_NUMBER = 2
FIRST_HUE = 3
HUES = 28
COLOURS = FIRST_HUE + HUES
BLACK = 1 << BLACK_NUMBER
WHITE = 1 << WHITE_NUMBER
MOST_CHROMA = 181  # for U and V of -128
DARKEST = -MOST_CHROMA  # no luma minus its chroma is below

AS_IT_IS = 64
"""The gain that leaves a colour unchanged: gains count in 64ths."""


SINGLE_COLOURS = np.uint32(1) << np.arange(COLOURS, dtype=np.uint32)
"""The word of each colour: its own bit."""


def colour_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage for a core. Until colours are joined, each has a word of its own."""
    return (Buffer("joined_colours", u32, COLOURS, "L1_data_b", values=SINGLE_COLOURS),)


@kernel
def balance_row(uyvy: u8[:], red_gain: i32, blue_gain: i32, shade_gain: i32) -> None:
    """Multiply red, blue and the chroma of dark pixels of one row, in place, by gains in 64ths; the luma stays.

    With U = 0.564 (B - Y) and V = 0.713 (R - Y) [BT.601], a gain of g on blue turns U into g U + 0.564 (g - 1) Y. The
    two pixels of a pair share U and V, and count with the mean of their lumas. The gain in the shade is that of pixels
    without luma, and falls to 1 at a luma of 128.
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
def separate_colours(joined_colours: u32[:]) -> None:
    """Give each colour the word with only its own bit."""
    for colour in range(len(joined_colours)):
        joined_colours[colour] = u32(1) << colour


@kernel
def join_colours(joined_colours: u32[:], group: u32) -> None:
    """Give each colour of a group the word with the bits of all."""
    for colour in range(len(joined_colours)):
        if group >> colour & 1 != 0:
            joined_colours[colour] = group


@kernel
def colour_word(brightness: i32, hue: u32, eps_black: i32, eps_white: i32, joined_colours: u32[:]) -> u32:
    """Return the word of a pixel by its luma minus its chroma (T Eq. 5.2)."""
    if brightness < eps_black:
        return joined_colours[BLACK_NUMBER]
    if brightness > eps_white:
        return joined_colours[WHITE_NUMBER]
    return hue


@kernel
def colour_row(
    uyvy: u8[:],
    atan: u8[:],
    joined_colours: u32[:],
    colours: u32[:],
    eps_black: i32,
    eps_white: i32,
    least_chroma: i32,
) -> None:
    """Reduce the colours of one row: `2 * width` bytes to `width` words. `joined_colours` has the word of each colour.

    The two pixels of a pair share U and V, and so root and hue. The hue is looked up only if one of the two may have a
    colour. It is the 8-bit angle of (V, U) divided into 28 equal parts: dividing it by 10, as T Eq. 5.2 is printed,
    would give 26 hues and not the 28 of its text. A pixel of no colour is 0.
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
            hue = joined_colours[FIRST_HUE + (angle8(v, u, atan) * HUES >> 8)]
        colours[2 * pair] = colour_word(left, hue, darkest, eps_white, joined_colours)
        colours[2 * pair + 1] = colour_word(right, hue, darkest, eps_white, joined_colours)


def join_groups(core: Core, groups: Sequence[int]) -> Generator[Any, Any, None]:
    """From now on, count the colours of each group, given as bits, as one, and all others separately."""
    words = core.array("joined_colours")
    yield core.run(separate_colours, words)
    for group in groups:
        yield core.run(join_colours, words, group)


def single_colours(core: Core, _: Sequence[int]) -> Generator[Any, Any, None]:
    """Count each colour separately, whatever the groups: in the thesis each bit of a pixel is a colour [said, T §5.2.3].

    So if a thing is seen in two hues, the opening keeps only what is in one of them.
    """
    yield core.run(separate_colours, core.array("joined_colours"))
