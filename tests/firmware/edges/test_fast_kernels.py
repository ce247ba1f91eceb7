"""The kernels that take four pixels at once, bit for bit against the plain ones, and the numbers that they save a division or root by."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.firmware.pictures import Bytes, three_rows
from tinyphoon.arithmetic import angle8
from tinyphoon.stages.colour_reduction import BLACK, SINGLE_COLOURS, colour_row, join_colours
from tinyphoon.stages.edge_detection import gauss3_row, grey_row, magnitude_row, sobel_row
from tinyphoon.stages.fast_edges import colour_words, fast_angle8, magnitude_words, octant_of, root8
from tinyphoon.stages.fast_gradients import gauss3_words, grey_words, sobel_words, words_of
from tinyphoon.stages.fast_opening import dilate_columns, erode_columns
from tinyphoon.stages.open_closing import dilate_row, erode_row
from tinyphoon.tables import arctangent_table, reciprocal_table, root_table

ATAN, ROOTS, RECIPROCALS = arctangent_table(), root_table(), reciprocal_table()
ROWS = [rows for width in (4, 6, 18, 322, 320) for rows in three_rows(width)]
LONGEST = 1020  # a component of a Sobel gradient


def in_words(row: Bytes) -> np.ndarray:
    """The words of a row; what lies behind its last pixel is garbage."""
    garbage = np.full(4 * words_of(len(row)) - len(row), 170, np.uint8)
    return np.concatenate((row, garbage)).view(np.int32)


def pixels(words: np.ndarray, width: int) -> Bytes:
    """The pixels of a row of words."""
    return words.view(np.uint8)[:width]


def uyvy_of(rows: Bytes) -> Bytes:
    """A row of a camera: its lumas are the first of the rows, its colours those of the second."""
    line = np.empty(2 * rows.shape[1], np.uint8)
    line[1::2], line[::2] = rows[0], rows[1]
    return line


@pytest.mark.parametrize("rows", ROWS)
def test_grey_and_gauss_are_those_of_single_pixels(rows: Bytes) -> None:
    """At both borders, and for widths that fill no last word."""
    width = rows.shape[1]
    grey, smooth = np.zeros((2, width), np.uint8)
    grey_words_, smooth_words = np.zeros((2, words_of(width)), np.int32)
    grey_row(uyvy_of(rows), grey)
    grey_words(uyvy_of(rows).view(np.int32), grey_words_)
    assert pixels(grey_words_, width).tolist() == grey.tolist()
    gauss3_row(*rows, smooth)
    gauss3_words(*map(in_words, rows), smooth_words, width - 1)
    assert pixels(smooth_words, width).tolist() == smooth.tolist()


@pytest.mark.parametrize("threshold", [1, 8, 100, 255])
@pytest.mark.parametrize("rows", ROWS)
def test_slopes_are_those_of_single_pixels_where_they_reach_the_threshold(
    rows: Bytes, threshold: int
) -> None:
    """A magnitude below it is 0. The first and the last pixel of a row have no gradient."""
    width = rows.shape[1]
    (gx, gy), magnitude = np.zeros((2, width), np.int16), np.zeros(width, np.uint8)
    sobel_row(*rows, gx, gy)
    magnitude_row(gx, gy, magnitude)
    found = np.zeros((2, 2 * words_of(width)), np.int32)
    words = np.zeros(words_of(width), np.int32)
    sobel_words(*map(in_words, rows), *found, words)
    magnitude_words(*found, ROOTS, threshold, width - 1, words)
    strong = magnitude >= threshold
    assert pixels(words, width).tolist() == np.where(strong, magnitude, 0).tolist()
    for plain, fast in zip((gx, gy), found, strict=True):
        assert fast.view(np.int16)[1 : width - 1].tolist() == plain[1:-1].tolist()


@pytest.mark.parametrize(
    "limits", [(40, 150, 0), (40, 150, 12), (-182, 255, 181), (255, 255, 0), (10, 200, 40)]
)
@pytest.mark.parametrize("spread", [3, 20, 128])
def test_colours_are_those_of_single_pairs(limits: tuple[int, int, int], spread: int) -> None:
    """From pixels almost without colour to all that there are, black, white and between."""
    rng = np.random.default_rng(spread)
    uyvy = np.empty(4096, np.uint8)
    uyvy[::2] = rng.integers(128 - spread, 128 + spread, 2048)
    uyvy[1::2] = rng.integers(0, 256, 2048)
    plain, fast = np.zeros((2, 2048), np.uint32)
    joined = SINGLE_COLOURS.copy()
    join_colours(joined, BLACK | 0b111 << 20)
    colour_row(uyvy, ATAN, joined, plain, *limits)
    colour_words(uyvy.view(np.int32), ROOTS, ATAN, RECIPROCALS, joined, fast, *limits)
    assert fast.tolist() == plain.tolist()


def test_every_root_is_exact() -> None:
    """Of all squares of 16 bits."""
    assert all(root8(square, ROOTS) == math.isqrt(square) for square in range(1 << 16))


def test_every_slope_is_exact() -> None:
    """For all components of a gradient, as 32 bits hold them."""
    for major in range(1, LONGEST + 1):
        minor = np.arange(major + 1, dtype=np.uint64)
        product = minor * np.uint64(RECIPROCALS[major])
        assert product.max() < 1 << 32
        assert (product >> np.uint64(20) == (minor << np.uint64(8)) // np.uint64(major)).all()


COMPONENTS = st.integers(-LONGEST, LONGEST)


@settings(max_examples=500)
@given(COMPONENTS, COMPONENTS)
def test_angles_and_octants_are_those_of_the_division(x: int, y: int) -> None:
    """The octant is that which `suppress_row` finds by the direction."""
    direction = angle8(x, y, ATAN)
    assert fast_angle8(x, y, ATAN, RECIPROCALS) == direction
    if (x, y) != (0, 0):
        assert octant_of(x, y) == (direction + 16 >> 5) & 3


def test_octants_of_all_short_gradients() -> None:
    """Near the borders of the octants, of which the short ones have most."""
    short = [(x, y) for x in range(-40, 41) for y in range(-40, 41) if (x, y) != (0, 0)]
    assert all(octant_of(x, y) == (angle8(x, y, ATAN) + 16 >> 5) & 3 for x, y in short)


@pytest.mark.parametrize("width", [2, 3, 7, 320])
def test_opening_by_columns_is_that_of_single_pixels(width: int) -> None:
    """Both halves of it, on words with most bits set and with few."""
    rng = np.random.default_rng(width)
    many = rng.integers(0, 1 << 32, (3, width), np.uint32) | rng.integers(0, 1 << 32, (3, width), np.uint32)
    for rows in (many, ~many, ~many & many[::-1]):
        for plain, fast in ((erode_row, erode_columns), (dilate_row, dilate_columns)):
            one, other = np.ones((2, width), np.uint32)
            plain(*rows, one)
            fast(*rows, other)
            assert one.tolist() == other.tolist()
