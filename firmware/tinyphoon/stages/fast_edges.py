"""Colour reduction and edges with instructions for four pixels at once, bit-identical to `edge_detection.py`.

Most pixels are no edge. So a row is scanned in words of four pixels (`fast_gradients.py`), whose gradients are two pairs
of 16-bit numbers; a root is looked up only if the sum of both components says that the gradient may reach the threshold,
and a direction only for edges. A gradient below the threshold counts as 0: this changes nothing for pixels that reach it.
"""

from __future__ import annotations

from bfsim.api import (
    compose_fr2x16,
    high_of_fr2x16,
    i16,
    i32,
    kernel,
    low_of_fr2x16,
    mac_i2x16,
    max_fr2x16,
    min_fr2x16,
    sub_i2x16,
    u8,
    u16,
    u32,
)
from tinyphoon.stages.colour_reduction import (
    BLACK_NUMBER,
    DARKEST,
    FIRST_HUE,
    HUES,
    colour_word,
)
from tinyphoon.stages.fast_gradients import EVEN_BYTES
from tinyphoon.tables import arctangent_table

GREY_PAIR = 0x00800080
"""The U and V of no colour."""

SMALL = 256
"""Smaller squares have a root of their own in the table."""

LONGEST = 255
"""The greatest magnitude, in the unit of `magnitude_row`."""

FLAT = int((arctangent_table() < 16).sum())
"""The least slope, in 256ths, with an angle of a sixteenth of a turn: neighbours are no longer in the row."""

FLATTER = int((arctangent_table() < 17).sum())
"""The least slope with a greater angle than that."""


@kernel
def root8(square: i32, roots: u8[:]) -> i32:
    """Return the root of `square` < 65,536, rounded down: from its 16th, maybe 1 too low; small ones by the table."""
    if square < SMALL:
        return roots[square]
    root = roots[SMALL + (square >> 4)] + 1
    if root * root > square:
        root = root - 1
    return root


@kernel
def slope8(minor: i32, major: i32, reciprocals: u32[:]) -> i32:
    """Return `minor / major` in 256ths, rounded down, for 0 <= minor <= major <= 1020, by a product; 0 for 0 / 0."""
    return i32(u32(minor) * reciprocals[major] >> 20)


@kernel
def fast_angle8(x: i32, y: i32, atan: u8[:], reciprocals: u32[:]) -> i32:
    """Return the same as `angle8`, for a vector with components up to 1020."""
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
    """Return the word of a V and U pair's hue, 0 if it has none; `brightness`: luma minus chroma of its pixels."""
    brightest = max(low_of_fr2x16(brightness), high_of_fr2x16(brightness))
    darker = min(low_of_fr2x16(brightness), high_of_fr2x16(brightness))
    if chroma < least_chroma or brightest < darkest or darker > eps_white:
        return 0
    angle = fast_angle8(high_of_fr2x16(vu), low_of_fr2x16(vu), atan, reciprocals)
    return joined_colours[FIRST_HUE + (angle * HUES >> 8)]


@kernel
def chroma_square(word: i32) -> i32:
    """Return the square of the chroma of a UYVY word."""
    vu = sub_i2x16(word & EVEN_BYTES, GREY_PAIR)
    return mac_i2x16(0, vu, vu)


@kernel
def brightness_of(word: i32, chroma: i32) -> i32:
    """Return the luma of both pixels of a UYVY word, minus its chroma."""
    return sub_i2x16(word >> 8 & EVEN_BYTES, compose_fr2x16(chroma, chroma))


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
    """Reduce the colours of one row as `colour_row` does.

    Most pairs have little chroma and are black: a run of these has a loop of its own, which needs few registers. Of the
    others, most are neither black nor white.
    """
    grey = min(least_chroma * least_chroma, SMALL)
    black = compose_fr2x16(eps_black - 1, eps_black - 1)
    brightest = compose_fr2x16(eps_white, eps_white)
    pairs = len(uyvy)
    pair = 0
    while pair < pairs:
        while pair < pairs:
            square = chroma_square(uyvy[pair])
            if square >= grey or max_fr2x16(brightness_of(uyvy[pair], i32(roots[square])), black) != black:
                break
            colours[2 * pair] = joined_colours[BLACK_NUMBER]
            colours[2 * pair + 1] = joined_colours[BLACK_NUMBER]
            pair = pair + 1
        while pair < pairs:
            word = uyvy[pair]
            square = chroma_square(word)
            darkest = eps_black
            hue: u32 = 0
            if square < grey:
                brightness = brightness_of(word, i32(roots[square]))
                if max_fr2x16(brightness, black) == black:
                    break
            else:
                chroma = root8(square, roots)
                if least_chroma != 0 and chroma >= least_chroma:
                    darkest = DARKEST
                brightness = brightness_of(word, chroma)
                vu = sub_i2x16(word & EVEN_BYTES, GREY_PAIR)
                hue = hue_of(
                    vu,
                    brightness,
                    chroma,
                    atan,
                    reciprocals,
                    joined_colours,
                    darkest,
                    eps_white,
                    least_chroma,
                )
            at_least = max_fr2x16(brightness, compose_fr2x16(darkest, darkest))
            if min_fr2x16(at_least, brightest) == brightness:
                colours[2 * pair] = hue
                colours[2 * pair + 1] = hue
            else:
                colours[2 * pair] = colour_word(
                    low_of_fr2x16(brightness), hue, darkest, eps_white, joined_colours
                )
                colours[2 * pair + 1] = colour_word(
                    high_of_fr2x16(brightness), hue, darkest, eps_white, joined_colours
                )
            pair = pair + 1


@kernel
def magnitude8(gx: i32, gy: i32, roots: u8[:], least: i32) -> i32:
    """Return the magnitude of a gradient as in `magnitude_row`, or 0 if its square is below `least`."""
    square = gx * gx + gy * gy >> 4
    if square < least:
        return 0
    if square >= LONGEST * LONGEST:
        return LONGEST
    return root8(square, roots)


@kernel
def magnitude_words(
    gx: i32[:], gy: i32[:], roots: u8[:], threshold: i32, last: i32, magnitude: i32[:]
) -> None:
    """Replace the steepness of a row's words by the magnitudes that reach the threshold."""
    limit = (4 * threshold - 1) * 0x00010001
    least = threshold * threshold
    words = len(magnitude) - 1
    i = 0
    while i < words:
        while i < words and max_fr2x16(magnitude[i], limit) == limit:  # most words, and few registers
            magnitude[i] = 0
            i = i + 1
        if i < words:
            gx_lower = gx[2 * i]
            gy_lower = gy[2 * i]
            gx_upper = gx[2 * i + 1]
            gy_upper = gy[2 * i + 1]
            four = magnitude8(low_of_fr2x16(gx_lower), low_of_fr2x16(gy_lower), roots, least)
            four = four | magnitude8(high_of_fr2x16(gx_lower), high_of_fr2x16(gy_lower), roots, least) << 8
            four = four | magnitude8(low_of_fr2x16(gx_upper), low_of_fr2x16(gy_upper), roots, least) << 16
            four = four | magnitude8(high_of_fr2x16(gx_upper), high_of_fr2x16(gy_upper), roots, least) << 24
            magnitude[i] = four
            i = i + 1
    magnitude[0] = magnitude[0] & -256
    magnitude[last >> 2] = magnitude[last >> 2] & ((1 << ((last & 3) << 3)) - 1)


@kernel
def octant_of(x: i32, y: i32) -> i32:
    """Return where the neighbours across an edge of gradient (x, y) are, numbered as in `suppress_row`.

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
    i = begin >> 2
    after_last = end + 3 >> 2
    while i < after_last:
        while i < after_last and words[i] == 0:  # most words have no edge
            i = i + 1
        if i < after_last:
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
            i = i + 1
    edge_counts[y] = found


@kernel
def first_sighted(first: u16[:], y: i32, x: i32) -> i32:
    """Return the first column of row `y` inside a rectified picture's rim and the border; a row begins at `x`."""
    return max(first[y] - x, 1)


@kernel
def after_sighted(last: u16[:], y: i32, x: i32, border: i32) -> i32:
    """Return the column after the last one of row `y` before the rim, or `border` if that comes first."""
    return min(last[y] + 1 - x, border)
