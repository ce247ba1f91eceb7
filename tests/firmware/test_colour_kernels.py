"""The kernels on colours: reduction, erosion and dilation, bit for bit against plain numpy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tests.firmware import references
from tests.firmware.pictures import WIDTHS, Bytes, random_uyvy
from tinyphoon.stages.colour_reduction import BLACK, WHITE, colour_row
from tinyphoon.stages.open_closing import dilate_row, erode_row
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.tables import arctangent_table

THRESHOLDS = [(INDOOR_FIELD.edges.eps_black, INDOOR_FIELD.edges.eps_white), (-40, 60), (-182, 255), (60, 59)]
ANY_WORDS = st.integers(2, 30).flatmap(
    lambda width: arrays(
        np.uint32,
        (3, width),
        elements=st.sampled_from([0, 1, BLACK, WHITE, BLACK | WHITE, 1 << 30, 2**32 - 1]),
    )
)


def reduced(uyvy: Bytes, eps_black: int, eps_white: int) -> np.ndarray:
    """Return the words of one row."""
    words = np.full(len(uyvy) // 2, 2**32 - 1, np.uint32)
    colour_row(uyvy, arctangent_table(), words, eps_black, eps_white)
    return words


def row_of_every_chroma(seed: int) -> Bytes:
    """A UYVY row with all 65536 pairs of U and V and random luma."""
    row = np.random.default_rng(seed).integers(0, 256, 4 * 65536, np.uint8)
    row[0::4], row[2::4] = np.divmod(np.arange(65536), 256)
    return row


@pytest.mark.parametrize(("eps_black", "eps_white"), THRESHOLDS)
def test_every_chroma_is_reduced_as_in_the_equations(eps_black: int, eps_white: int) -> None:
    """All U and V with random luma give the words of T Eq. 5.1-5.4, whatever the thresholds."""
    row = row_of_every_chroma(seed=eps_white)
    expected = references.colours(row[np.newaxis], eps_black, eps_white)[0]
    np.testing.assert_array_equal(reduced(row, eps_black, eps_white), expected)


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


@pytest.mark.parametrize("width", WIDTHS)
def test_rows_of_a_picture(width: int) -> None:
    """Narrow and wide rows with squares of colour come out as in numpy."""
    uyvy = random_uyvy(width, 8, seed=width)
    expected = references.colours(uyvy, 28, 125)
    for y in range(8):
        np.testing.assert_array_equal(reduced(uyvy[y], 28, 125), expected[y])


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
