"""Edge detection and colour reduction with the instructions for four pixels at once, the same to the bit as `edge_detection.py`.

Most pixels are no edge. So a row is scanned in words of four pixels, whose gradients are two pairs of 16-bit numbers; a root is taken,
from a table, where the sum of both components says that the gradient may reach the threshold, and a direction only of edges.
A gradient below the threshold counts as 0: no pixel that reaches it loses or gains by that.

A row of words has one word more than its pixels need, so that a loop may look ahead. What lies behind the last pixel is of no
account.
"""

from __future__ import annotations

from bfsim.api import (
    abs_fr2x16,
    add_i2x16,
    add_i4x8,
    align16,
    bytepack,
    compose_fr2x16,
    high_of_fr2x16,
    i16,
    i32,
    kernel,
    low_of_fr2x16,
    mac_i2x16,
    max_fr2x16,
    min_fr2x16,
    shr_fr2x16,
    sub_i2x16,
    sub_i4x8,
    u8,
    u16,
    u32,
)
from tinyphoon.stages.colour_reduction import (
    BLACK_NUMBER,
    DARKEST,
    FIRST_HUE,
    HUES,
    WHITE_NUMBER,
    colour_word,
)
from tinyphoon.tables import arctangent_table

EVEN_BYTES = 0x00FF00FF
"""Where U and V of a UYVY word are, and its two lumas, when it is shifted by a byte."""

GREY_PAIR = 0x00800080
"""The U and V of no colour."""

SMALL = 256
"""Squares below have a root of their own in the table."""

LONGEST = 255
"""The greatest magnitude, in the unit of `magnitude_row`."""

FLAT = int((arctangent_table() < 16).sum())
"""The least slope, in 256ths, whose angle is a sixteenth of a turn, where neighbours are no longer those of the row."""

FLATTER = int((arctangent_table() < 17).sum())
"""The least slope whose angle is more than that."""


def words_of(width: int) -> int:
    """Return how many words a row of `width` pixels has."""
    return -(-width // 4) + 1


@kernel
def grey_words(uyvy: i32[:], grey: i32[:]) -> None:
    """Take the luma of one UYVY row, of two pixels a word, to words of four."""
    whole = len(uyvy) >> 1
    for i in range(whole):
        grey[i] = bytepack((uyvy[2 * i] >> 8) & EVEN_BYTES, (uyvy[2 * i + 1] >> 8) & EVEN_BYTES)
    if (len(uyvy) & 1) != 0:
        rest = (uyvy[len(uyvy) - 1] >> 8) & EVEN_BYTES
        grey[whole] = bytepack(rest, rest)


@kernel
def root8(square: i32, roots: u8[:]) -> i32:
    """Return the root of `square`, below 65,536, rounded down: that of its 16th, which may lack 1. A small square is in the table."""
    if square < SMALL:
        return roots[square]
    root = roots[SMALL + (square >> 4)] + 1
    if root * root > square:
        root = root - 1
    return root


@kernel
def slope8(minor: i32, major: i32, reciprocals: u32[:]) -> i32:
    """Return `minor / major` in 256ths, rounded down, of 0 <= minor <= major <= 1020, by a multiplication; 0 of 0 and 0."""
    return i32(u32(minor) * reciprocals[major] >> 20)


@kernel
def fast_angle8(x: i32, y: i32, atan: u8[:], reciprocals: u32[:]) -> i32:
    """Return what `angle8` does, of a vector with components up to 1020."""
    ax = abs(x)
    ay = abs(y)
    if ax >= ay:
        angle = atan[slope8(ay, ax, reciprocals)]
    else:
        angle = 64 - atan[slope8(ax, ay, reciprocals)]
    if x < 0:
        angle = 128 - angle
    if y < 0:
        angle = 256 - angle
    return angle & 255


@kernel
def hue_of(
    vu: i32,
    brightness: i32,
    chroma: i32,
    atan: u8[:],
    reciprocals: u32[:],
    joined_colours: u32[:],
    darkest: i32,
    eps_white: i32,
    least_chroma: i32,
) -> u32:
    """Return the word of the hue of a pair of V and U, or 0 if it has none; `brightness`: luma less chroma of its two pixels."""
    brightest = max(low_of_fr2x16(brightness), high_of_fr2x16(brightness))
    darker = min(low_of_fr2x16(brightness), high_of_fr2x16(brightness))
    if chroma < least_chroma or brightest < darkest or darker > eps_white:
        return 0
    angle = fast_angle8(high_of_fr2x16(vu), low_of_fr2x16(vu), atan, reciprocals)
    return joined_colours[FIRST_HUE + (angle * HUES >> 8)]


@kernel
def colour_words(
    uyvy: i32[:],
    roots: u8[:],
    atan: u8[:],
    reciprocals: u32[:],
    joined_colours: u32[:],
    colours: u32[:],
    eps_black: i32,
    eps_white: i32,
    least_chroma: i32,
) -> None:
    """Reduce the colours of one row as `colour_row` does. Most pairs have little chroma, and both pixels the same word."""
    grey = min(least_chroma * least_chroma, SMALL)
    black = compose_fr2x16(eps_black - 1, eps_black - 1)
    white = compose_fr2x16(eps_white + 1, eps_white + 1)
    for pair in range(len(uyvy)):
        word = uyvy[pair]
        vu = sub_i2x16(word & EVEN_BYTES, GREY_PAIR)
        luma = word >> 8 & EVEN_BYTES
        square = mac_i2x16(0, vu, vu)
        if square < grey:
            chroma = i32(roots[square])
            brightness = sub_i2x16(luma, compose_fr2x16(chroma, chroma))
            if max_fr2x16(brightness, black) == black:
                colours[2 * pair] = joined_colours[BLACK_NUMBER]
                colours[2 * pair + 1] = joined_colours[BLACK_NUMBER]
            elif min_fr2x16(brightness, white) == white:
                colours[2 * pair] = joined_colours[WHITE_NUMBER]
                colours[2 * pair + 1] = joined_colours[WHITE_NUMBER]
            else:
                colours[2 * pair] = colour_word(
                    low_of_fr2x16(brightness), 0, eps_black, eps_white, joined_colours
                )
                colours[2 * pair + 1] = colour_word(
                    high_of_fr2x16(brightness), 0, eps_black, eps_white, joined_colours
                )
        else:
            chroma = root8(square, roots)
            darkest = eps_black
            if least_chroma != 0 and chroma >= least_chroma:
                darkest = DARKEST
            brightness = sub_i2x16(luma, compose_fr2x16(chroma, chroma))
            hue = hue_of(
                vu, brightness, chroma, atan, reciprocals, joined_colours, darkest, eps_white, least_chroma
            )
            colours[2 * pair] = colour_word(
                low_of_fr2x16(brightness), hue, darkest, eps_white, joined_colours
            )
            colours[2 * pair + 1] = colour_word(
                high_of_fr2x16(brightness), hue, darkest, eps_white, joined_colours
            )


@kernel
def gauss3_words(above: i32[:], here: i32[:], below: i32[:], smooth: i32[:], last: i32) -> None:
    """Smooth one row as `gauss3_row` does; its last pixel is number `last`."""
    outer_upper, outer_lower = add_i4x8(above[0], below[0])
    twice_upper, twice_lower = add_i4x8(here[0], here[0])
    upper = add_i2x16(outer_upper, twice_upper)
    lower = add_i2x16(outer_lower, twice_lower)
    before = lower
    for i in range(len(here) - 1):
        outer_upper, outer_lower = add_i4x8(above[i + 1], below[i + 1])
        twice_upper, twice_lower = add_i4x8(here[i + 1], here[i + 1])
        after = add_i2x16(outer_lower, twice_lower)
        middle = align16(upper, lower)
        inner = add_i2x16(lower, middle)
        outer = add_i2x16(middle, upper)
        left = add_i2x16(add_i2x16(align16(lower, before), lower), inner)
        right = add_i2x16(outer, add_i2x16(upper, align16(after, upper)))
        smooth[i] = bytepack(shr_fr2x16(left, 4), shr_fr2x16(right, 4))
        before = upper
        lower = after
        upper = add_i2x16(outer_upper, twice_upper)
    smooth[0] = smooth[0] & -256 | here[0] & 255
    kept = 255 << ((last & 3) << 3)
    smooth[last >> 2] = smooth[last >> 2] & ~kept | here[last >> 2] & kept


@kernel
def magnitude8(gx: i32, gy: i32, roots: u8[:], least: i32) -> i32:
    """Return the magnitude of a gradient as `magnitude_row` has it, or 0 if its square is below `least`."""
    square = gx * gx + gy * gy >> 4
    if square < least:
        return 0
    if square >= LONGEST * LONGEST:
        return LONGEST
    return root8(square, roots)


@kernel
def slope_words(
    above: i32[:],
    here: i32[:],
    below: i32[:],
    roots: u8[:],
    threshold: i32,
    last: i32,
    gx: i32[:],
    gy: i32[:],
    magnitude: i32[:],
) -> None:
    """Magnitudes of one smoothed row, those that reach the threshold, and the Sobel gradients of words that have one.

    Two words of `gx` and of `gy` go with a word of pixels; those of words without a magnitude are left as they were.
    """
    limit = (4 * threshold - 1) * 0x00010001
    least = threshold * threshold
    outer_upper, outer_lower = add_i4x8(above[0], below[0])
    twice_upper, twice_lower = add_i4x8(here[0], here[0])
    down_upper, down_lower = sub_i4x8(below[0], above[0])
    upper = add_i2x16(outer_upper, twice_upper)
    lower = add_i2x16(outer_lower, twice_lower)
    before = lower
    down_before = down_lower
    for i in range(len(here) - 1):
        outer_upper, outer_lower = add_i4x8(above[i + 1], below[i + 1])
        twice_upper, twice_lower = add_i4x8(here[i + 1], here[i + 1])
        next_down_upper, down_after = sub_i4x8(below[i + 1], above[i + 1])
        after = add_i2x16(outer_lower, twice_lower)
        middle = align16(upper, lower)
        gx_lower = sub_i2x16(middle, align16(lower, before))
        gx_upper = sub_i2x16(align16(after, upper), middle)
        middle = align16(down_upper, down_lower)
        inner = add_i2x16(down_lower, middle)
        outer = add_i2x16(middle, down_upper)
        gy_lower = add_i2x16(add_i2x16(align16(down_lower, down_before), down_lower), inner)
        gy_upper = add_i2x16(outer, add_i2x16(down_upper, align16(down_after, down_upper)))
        left = add_i2x16(abs_fr2x16(gx_lower), abs_fr2x16(gy_lower))
        right = add_i2x16(abs_fr2x16(gx_upper), abs_fr2x16(gy_upper))
        four = 0
        if max_fr2x16(max_fr2x16(left, right), limit) != limit:
            gx[2 * i] = gx_lower
            gx[2 * i + 1] = gx_upper
            gy[2 * i] = gy_lower
            gy[2 * i + 1] = gy_upper
            four = magnitude8(low_of_fr2x16(gx_lower), low_of_fr2x16(gy_lower), roots, least)
            four = four | magnitude8(high_of_fr2x16(gx_lower), high_of_fr2x16(gy_lower), roots, least) << 8
            four = four | magnitude8(low_of_fr2x16(gx_upper), low_of_fr2x16(gy_upper), roots, least) << 16
            four = four | magnitude8(high_of_fr2x16(gx_upper), high_of_fr2x16(gy_upper), roots, least) << 24
        magnitude[i] = four
        before = upper
        lower = after
        upper = add_i2x16(outer_upper, twice_upper)
        down_before = down_upper
        down_lower = down_after
        down_upper = next_down_upper
    magnitude[0] = magnitude[0] & -256
    magnitude[last >> 2] = magnitude[last >> 2] & ((1 << ((last & 3) << 3)) - 1)


@kernel
def octant_of(x: i32, y: i32) -> i32:
    """Return where the neighbours across an edge of gradient (x, y) are, as `suppress_row` numbers it by the direction.

    0: left and right, 1: above left and below right, 2: above and below, 3: above right and below left.
    """
    ax = abs(x)
    ay = abs(y)
    flat = FLATTER if (x ^ y) < 0 else FLAT
    if ay << 8 < ax * flat:
        return 0
    steep = FLAT if (x ^ y) < 0 else FLATTER
    if ax < ay and ax << 8 < ay * steep:
        return 2
    return 3 if (x ^ y) < 0 else 1


@kernel
def peak_words(
    words: i32[:],
    above: u8[:],
    here: u8[:],
    below: u8[:],
    gx: i16[:],
    gy: i16[:],
    atan: u8[:],
    reciprocals: u32[:],
    begin: i32,
    end: i32,
    y: i32,
    candidates: u32[:],
    edge_counts: u16[:],
    levels: u16[:],
    band: i32,
) -> None:
    """Store the edges of row `y`, from column `begin` to before `end`: magnitudes that are a maximum across their edge.

    `words` and `here` are the same row. Edges are stored as `store_edges_row` does, and counted as `count_levels` does.
    """
    found = 0
    first_level = band << 8
    for i in range(begin >> 2, end + 3 >> 2):
        if words[i] != 0:
            for x in range(max(4 * i, begin), min(4 * i + 4, end)):
                gradient = i32(here[x])
                if gradient != 0:
                    octant = octant_of(gx[x], gy[x])
                    if octant == 0:
                        before = here[x - 1]
                        after = here[x + 1]
                    elif octant == 1:
                        before = above[x - 1]
                        after = below[x + 1]
                    elif octant == 2:
                        before = above[x]
                        after = below[x]
                    else:
                        before = above[x + 1]
                        after = below[x - 1]
                    if gradient >= before and gradient > after:
                        candidates[found] = u32(
                            gradient | fast_angle8(gx[x], gy[x], atan, reciprocals) << 8 | x << 16
                        )
                        level = first_level + gradient
                        levels[level] = levels[level] + 1
                        found = found + 1
    edge_counts[y] = found


@kernel
def first_sighted(first: u16[:], y: i32, x: i32) -> i32:
    """Return the first column of row `y` behind the rim of a rectified picture and behind the border; a row begins at column `x`."""
    return max(first[y] - x, 1)


@kernel
def after_sighted(last: u16[:], y: i32, x: i32, border: i32) -> i32:
    """Return the column behind the last one of row `y` before the rim, or `border` if that comes first."""
    return min(last[y] + 1 - x, border)
