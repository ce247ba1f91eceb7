"""Gradients of rows of words of four pixels: luma, smoothed luma, and steepness.

A row has one word more than its pixels need, so that a loop may look ahead. Anything after the last pixel does not matter.
"""

from __future__ import annotations

from bfsim.api import (
    abs_fr2x16,
    add_i2x16,
    add_i4x8,
    align16,
    bytepack,
    i32,
    kernel,
    max_fr2x16,
    shr_fr2x16,
    sub_i2x16,
    sub_i4x8,
)

EVEN_BYTES = 0x00FF00FF
"""Selects U and V of a UYVY word, or its two lumas if it is shifted by a byte."""


def words_of(width: int) -> int:
    """Return the number of words of a row of `width` pixels."""
    return -(-width // 4) + 1


@kernel
def grey_words(uyvy: i32[:], grey: i32[:]) -> None:
    """Take the luma of one UYVY row, with two pixels a word, into words of four."""
    whole = len(uyvy) >> 1
    for i in range(whole):
        grey[i] = bytepack((uyvy[2 * i] >> 8) & EVEN_BYTES, (uyvy[2 * i + 1] >> 8) & EVEN_BYTES)
    if (len(uyvy) & 1) != 0:
        rest = (uyvy[len(uyvy) - 1] >> 8) & EVEN_BYTES
        grey[whole] = bytepack(rest, rest)


@kernel
def gauss3_words(above: i32[:], here: i32[:], below: i32[:], smooth: i32[:], last: i32) -> None:
    """Smooth one row as `gauss3_row` does; its last pixel is number `last`.

    `between`: the last column sum of a word and the first of the next one.
    """
    outer_upper, outer_lower = add_i4x8(above[0], here[0])
    inner_upper, inner_lower = add_i4x8(here[0], below[0])
    upper = add_i2x16(outer_upper, inner_upper)
    lower = add_i2x16(outer_lower, inner_lower)
    between = align16(lower, lower)
    for i in range(len(here) - 1):
        outer_upper, outer_lower = add_i4x8(above[i + 1], here[i + 1])
        inner_upper, inner_lower = add_i4x8(here[i + 1], below[i + 1])
        middle = align16(upper, lower)
        left = add_i2x16(add_i2x16(between, lower), add_i2x16(lower, middle))
        lower = add_i2x16(outer_lower, inner_lower)
        between = align16(lower, upper)
        right = add_i2x16(add_i2x16(middle, upper), add_i2x16(upper, between))
        upper = add_i2x16(outer_upper, inner_upper)
        smooth[i] = bytepack(shr_fr2x16(left, 4), shr_fr2x16(right, 4))
    smooth[0] = smooth[0] & -256 | here[0] & 255
    kept = 255 << ((last & 3) << 3)
    smooth[last >> 2] = smooth[last >> 2] & ~kept | here[last >> 2] & kept


@kernel
def sobel_words(
    above: i32[:], here: i32[:], below: i32[:], gx: i32[:], gy: i32[:], steepness: i32[:]
) -> None:
    """Sobel gradients of a smoothed row, two words of `gx` and `gy` for a word of pixels, and the most steepness of its words.

    That is the greater sum of both components, for pixels 0 and 2 and for 1 and 3. What pixels in a column have goes
    from word to word, as in `gauss3_words`.
    """
    outer_upper, outer_lower = add_i4x8(above[0], here[0])
    inner_upper, inner_lower = add_i4x8(here[0], below[0])
    upper = add_i2x16(outer_upper, inner_upper)
    lower = add_i2x16(outer_lower, inner_lower)
    between = align16(lower, lower)
    down_upper, down_lower = sub_i4x8(below[0], above[0])
    down_between = align16(down_lower, down_lower)
    for i in range(len(here) - 1):
        middle = align16(down_upper, down_lower)
        gy_lower = add_i2x16(add_i2x16(down_between, down_lower), add_i2x16(down_lower, middle))
        next_upper, down_lower = sub_i4x8(below[i + 1], above[i + 1])
        down_between = align16(down_lower, down_upper)
        gy_upper = add_i2x16(add_i2x16(middle, down_upper), add_i2x16(down_upper, down_between))
        down_upper = next_upper
        gy[2 * i] = gy_lower
        gy[2 * i + 1] = gy_upper
        middle = align16(upper, lower)
        gx_lower = sub_i2x16(middle, between)
        outer_upper, outer_lower = add_i4x8(above[i + 1], here[i + 1])
        inner_upper, inner_lower = add_i4x8(here[i + 1], below[i + 1])
        lower = add_i2x16(outer_lower, inner_lower)
        between = align16(lower, upper)
        gx_upper = sub_i2x16(between, middle)
        upper = add_i2x16(outer_upper, inner_upper)
        gx[2 * i] = gx_lower
        gx[2 * i + 1] = gx_upper
        left = add_i2x16(abs_fr2x16(gx_lower), abs_fr2x16(gy_lower))
        right = add_i2x16(abs_fr2x16(gx_upper), abs_fr2x16(gy_upper))
        steepness[i] = max_fr2x16(left, right)
