"""The kernels on colours: reduction, erosion and dilation, bit for bit against plain numpy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image

from benchmarks.robot.pixel_colours import pixel_colours_row
from bfsim.recording.planes import YuvPlanes
from tests.firmware import references
from tests.firmware.pictures import WIDTHS, Bytes, random_uyvy
from tinyphoon.stages.colour_reduction import (
    AS_IT_IS,
    BLACK,
    COLOURS,
    SINGLE_COLOURS,
    WHITE,
    balance_row,
    colour_row,
    join_colours,
    separate_colours,
)
from tinyphoon.stages.open_closing import dilate_row, erode_row
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.tables import arctangent_table

_EDGES = INDOOR_FIELD.edges
THRESHOLDS = [
    _EDGES.colour_limits,
    (28, 125, 0),
    (-40, 60, 1),
    (-182, 255, 0),
    (60, 59, 100),
    (28, 125, 181),
]
ANY_WORDS = st.integers(2, 30).flatmap(
    lambda width: arrays(
        np.uint32,
        (3, width),
        elements=st.sampled_from([0, 1, BLACK, WHITE, BLACK | WHITE, 1 << 30, 2**32 - 1]),
    )
)


def reduced(
    uyvy: Bytes, eps_black: int, eps_white: int, least_chroma: int = 0, groups: Sequence[int] = ()
) -> np.ndarray:
    """Return the words of one row, where the colours of groups are joined."""
    joined = np.full(COLOURS, 2**32 - 1, np.uint32)
    separate_colours(joined)
    for group in groups:
        join_colours(joined, group)
    words = np.full(len(uyvy) // 2, 2**32 - 1, np.uint32)
    colour_row(uyvy, arctangent_table(), joined, words, eps_black, eps_white, least_chroma)
    return words


def row_of_every_chroma(seed: int) -> Bytes:
    """A UYVY row with all 65536 pairs of U and V and random luma."""
    row = np.random.default_rng(seed).integers(0, 256, 4 * 65536, np.uint8)
    row[0::4], row[2::4] = np.divmod(np.arange(65536), 256)
    return row


@pytest.mark.parametrize("thresholds", THRESHOLDS)
def test_every_chroma_is_reduced_as_in_the_equations(thresholds: tuple[int, int, int]) -> None:
    """All U and V with random luma give the words of T Eq. 5.1-5.4, whatever the thresholds."""
    row = row_of_every_chroma(seed=thresholds[1])
    expected = references.colours(row[np.newaxis], *thresholds)[0]
    np.testing.assert_array_equal(reduced(row, *thresholds), expected)


@pytest.mark.parametrize("thresholds", THRESHOLDS)
def test_pixels_by_themselves_have_the_colours_of_their_pairs(thresholds: tuple[int, int, int]) -> None:
    """What benchmarks/robot times as another reading of T Eq. 5.4 leaves the same."""
    row = row_of_every_chroma(seed=4)
    words = np.zeros(len(row) // 2, np.uint32)
    pixel_colours_row(row, arctangent_table(), SINGLE_COLOURS, words, *thresholds)
    np.testing.assert_array_equal(words, reduced(row, *thresholds))


@pytest.mark.parametrize("groups", [(0b111 << 20,), (WHITE | 1 << 22, BLACK | 1 << 4 | 1 << 30)])
def test_the_colours_of_a_group_have_one_word(groups: tuple[int, ...]) -> None:
    """Of every chroma: hues, black and white of a group have the bits of all of it, the others their own."""
    row = row_of_every_chroma(seed=3)
    words = reduced(row, 28, 125, 28, groups)
    np.testing.assert_array_equal(words, references.colours(row[np.newaxis], 28, 125, 28, groups)[0])
    assert set(groups) < set(words.tolist())
    np.testing.assert_array_equal(
        reduced(row, 28, 125, 28), references.colours(row[np.newaxis], 28, 125, 28)[0]
    )


def test_colours_that_were_joined_can_be_parted_again() -> None:
    """Until they are joined anew all of them have the words that the firmware starts with."""
    words = SINGLE_COLOURS.copy()
    join_colours(words, 0b111 << 20)
    separate_colours(words)
    assert words.tolist() == [1 << colour for colour in range(31)] == SINGLE_COLOURS.tolist()


@pytest.mark.parametrize(("groups", "least", "most"), [((), 0, 0.1), ((0b11 << 22,), 1, 1)])
def test_erosion_keeps_a_thing_between_two_hues(groups: tuple[int, ...], least: float, most: float) -> None:
    """Noise moves pair after pair of a yellow from one hue to the next: it stays whole if both are of one group."""
    turns = np.radians(np.random.default_rng(2).choice([19.5, 20.5], (20, 15)) * 360 / 28)
    rows = np.full((20, 60), 150, np.uint8)
    rows[:, 0::4], rows[:, 2::4] = 128 + 60 * np.sin(turns), 128 + 60 * np.cos(turns)
    words = np.array([reduced(row, 28, 125, 28, groups) for row in rows])
    eroded = np.zeros_like(words)
    for y in range(1, 19):
        erode_row(*words[y - 1 : y + 2], eroded[y])
    assert least <= np.count_nonzero(eroded[1:-1, 1:-1]) / eroded[1:-1, 1:-1].size <= most


def test_all_28_hues_occur_and_each_pixel_has_one_colour() -> None:
    """With thresholds that nothing passes all pixels have a hue: bits 3 to 30, one each."""
    words = reduced(row_of_every_chroma(seed=1), -182, 255)
    assert set(words.tolist()) == {1 << bit for bit in range(3, 31)}


def test_luma_decides_between_black_hue_and_white() -> None:
    """Without chroma, black ends under the one threshold and white begins above the other."""
    row = np.full(8, 128, np.uint8)
    row[1::2] = [27, 28, 125, 126]
    black, dark, bright, white = reduced(row, 28, 125).tolist()
    assert (black, white) == (BLACK, WHITE)
    assert dark == bright == 1 << 3


def pair(luma: int, u: int, v: int) -> Bytes:
    """A UYVY row of two equal pixels."""
    return np.array([u, luma, v, luma], np.uint8)


def test_grey_has_no_hue_however_noisy() -> None:
    """A chroma below the least one: black, nothing or white by its luma. The thesis's rule gives the noise a hue."""
    for noise in (0, 3, -5, 19):
        shades = [reduced(pair(luma, 128 + noise, 128 - noise), 28, 125, 28)[0] for luma in (20, 90, 200)]
        assert shades == [BLACK, 0, WHITE]
        assert reduced(pair(90, 128 + noise, 128 - noise), 28, 125)[0] >= 1 << 3


@pytest.mark.parametrize("luma", [30, 60, 81])
def test_a_saturated_colour_is_never_black(luma: int) -> None:
    """A red of (200, 30, 30), and the same in the shade; the thesis's rule calls it black."""
    red = pair(luma, 128 - 25 * luma // 81, 128 + 85 * luma // 81)
    assert reduced(red, 28, 125, 28)[0] == 1 << 29
    assert reduced(red, 28, 125)[0] == BLACK


def balanced(
    uyvy: Bytes, red_gain: int = AS_IT_IS, blue_gain: int = AS_IT_IS, shade_gain: int = AS_IT_IS
) -> Bytes:
    """Return a row with its red, its blue and the chroma of its shade multiplied, in 64ths."""
    row = uyvy.copy()
    balance_row(row, red_gain, blue_gain, shade_gain)
    return row


def uyvy_of(colours: np.ndarray) -> Bytes:
    """A UYVY row of pairs of equal pixels, (pairs, RGB)."""
    return YuvPlanes.from_image(Image.fromarray(colours[None].repeat(2, axis=1))).to_uyvy()[0]


def test_gains_of_one_change_nothing() -> None:
    """Every pair of U and V stays, whatever the luma."""
    row = row_of_every_chroma(seed=7)
    np.testing.assert_array_equal(balanced(row), row)


@pytest.mark.parametrize(("red", "blue"), [(80, 50), (56, 90), (64, 128), (200, 30)])
def test_a_grey_of_any_brightness_under_other_light_becomes_grey_again(red: int, blue: int) -> None:
    """Light that divides red and blue by the gains: U and V of all its greys are none, but for rounding before the gains."""
    greens = (1 - 0.299 * 64 / red - 0.114 * 64 / blue) / 0.587  # such that the luma is that of the grey
    lit = np.arange(20, 230)[:, None] * [64 / red, greens, 64 / blue]
    lit = lit[(lit < 255).all(axis=1)]
    row = balanced(uyvy_of(lit.round().astype(np.uint8)), red, blue)
    assert np.abs(row[0::2].astype(int) - 128).max() <= 1 + max(red, blue, 64) / 64


def test_colours_are_those_of_multiplied_red_and_blue() -> None:
    """Of random colours: (R, B) are multiplied where the luma is kept, as in the equations of BT.601; clipped at the ends."""
    row = np.random.default_rng(5).integers(0, 256, 4 * 500, np.uint8)
    u, v = row[0::4].astype(float) - 128, row[2::4].astype(float) - 128
    luma = (row[1::4].astype(float) + row[3::4]) / 2
    red, blue = (luma + v / 0.713) * 80 / 64, (luma + u / 0.564) * 50 / 64
    expected = np.clip([0.564 * (blue - luma), 0.713 * (red - luma)], -128, 127)
    found = balanced(row, 80, 50)
    np.testing.assert_array_equal(found[1::2], row[1::2])
    assert np.abs([found[0::4] - 128.0, found[2::4] - 128.0] - expected).max() <= 1.5


@pytest.mark.parametrize(("luma", "gain"), [(0, 2), (64, 1.5), (127, 1), (128, 1), (255, 1)])
def test_the_shade_has_more_chroma_and_the_same_hue(luma: int, gain: float) -> None:
    """Twice as much without luma, as it is from 128 on."""
    u, _, v, _ = balanced(pair(luma, 128 - 20, 128 + 40), shade_gain=128).tolist()
    assert (u, v) == (128 - 20 * gain, 128 + 40 * gain)


def test_a_dark_red_keeps_its_hue_with_a_gain_in_the_shade() -> None:
    """A fifth of its light: black without, red with it; grey noise stays without a hue."""
    dark, noise = pair(16, 128 - 5, 128 + 17), pair(16, 128 + 5, 128 - 9)
    assert reduced(dark, 28, 125, 28)[0] == BLACK
    assert reduced(balanced(dark, shade_gain=128), 28, 125, 28)[0] == 1 << 29
    assert reduced(balanced(noise, shade_gain=128), 28, 125, 28)[0] == BLACK


@pytest.mark.parametrize("width", WIDTHS)
def test_rows_of_a_picture(width: int) -> None:
    """Narrow and wide rows with squares of colour come out as in numpy."""
    uyvy = random_uyvy(width, 8, seed=width)
    expected = references.colours(uyvy, 28, 125, 20)
    for y in range(8):
        np.testing.assert_array_equal(reduced(uyvy[y], 28, 125, 20), expected[y])


@given(ANY_WORDS)
def test_erosion_and_dilation_of_any_rows(rows: np.ndarray) -> None:
    """All 32 bits are eroded and dilated at once, down to rows of two pixels."""
    eroded, dilated = np.full_like(rows[0], 170), np.full_like(rows[0], 170)
    erode_row(*rows, eroded)
    dilate_row(*rows, dilated)
    np.testing.assert_array_equal(eroded, references.erode(rows)[1])
    np.testing.assert_array_equal(dilated, references.dilate(rows)[1])


def test_opening_removes_a_spot_and_keeps_a_square() -> None:
    """What T §2.3.1 wants of it: single pixels go, a square of three stays as it is."""
    picture = np.zeros((7, 9), np.uint32)
    picture[3, 1] = 1 << 5
    picture[2:5, 4:7] = 1 << 9
    eroded, opened = np.zeros_like(picture), np.zeros_like(picture)
    for y in range(1, 6):
        erode_row(*picture[y - 1 : y + 2], eroded[y])
    for y in range(1, 6):
        dilate_row(*eroded[y - 1 : y + 2], opened[y])
    picture[3, 1] = 0
    np.testing.assert_array_equal(opened, picture)
