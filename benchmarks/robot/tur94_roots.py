"""Square roots by the routine that [Tur94] prints, which T §1.3.4 cites, for the lengths of gradients and for chroma.

Two bits of the number come from a low word into a high one each turn, and what is tried is twice the root so far, and one.
`isqrt32` finds the same roots by a bit that moves down, and needs no second word. Without bits behind the point there are 16 turns.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u8, u32
from tinyphoon.arithmetic import angle8
from tinyphoon.stages.colour_reduction import DARKEST, FIRST_HUE, HUES, MOST_CHROMA, colour_word


@kernel
def tur94_root(square: u32) -> u32:
    """Return the root of `square`, rounded down, as `isqrt32` does."""
    root: u32 = 0
    high: u32 = 0
    low = square
    for _ in range(16):
        high = high << 2 | low >> 30
        low = low << 2
        root = root << 1
        trial = (root << 1) + 1
        if high >= trial:
            high = high - trial
            root = root + 1
    return root


@kernel
def tur94_magnitude_row(gx: i16[:], gy: i16[:], magnitude: u8[:]) -> None:
    """Gradient magnitude of one row, as `magnitude_row` makes it."""
    for x in range(len(magnitude)):
        square = gx[x] * gx[x] + gy[x] * gy[x]
        magnitude[x] = min(i32(tur94_root(u32(square))) >> 2, 255)


@kernel
def tur94_colour_row(
    uyvy: u8[:],
    atan: u8[:],
    joined_colours: u32[:],
    colours: u32[:],
    eps_black: i32,
    eps_white: i32,
    least_chroma: i32,
) -> None:
    """Reduce the colours of one row, as `colour_row` does."""
    never_black = least_chroma if least_chroma != 0 else MOST_CHROMA + 1
    for pair in range(len(colours) >> 1):
        u = uyvy[4 * pair] - 128
        v = uyvy[4 * pair + 2] - 128
        chroma = i32(tur94_root(u32(v * v + u * u)))
        left = uyvy[4 * pair + 1] - chroma
        right = uyvy[4 * pair + 3] - chroma
        darkest = eps_black if chroma < never_black else DARKEST
        hue: u32 = 0
        if chroma >= least_chroma and max(left, right) >= darkest and min(left, right) <= eps_white:
            hue = joined_colours[FIRST_HUE + (angle8(v, u, atan) * HUES >> 8)]
        colours[2 * pair] = colour_word(left, hue, darkest, eps_white, joined_colours)
        colours[2 * pair + 1] = colour_word(right, hue, darkest, eps_white, joined_colours)
