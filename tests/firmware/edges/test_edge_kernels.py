"""The kernels of the edge detection, bit for bit against plain numpy."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from benchmarks.robot.tur94_roots import tur94_root
from tests.firmware import references
from tests.firmware.pictures import WIDTHS, Bytes, random_uyvy, three_rows
from tinyphoon.arithmetic import isqrt32
from tinyphoon.stages.edge_detection import (
    direction_row,
    gauss3_row,
    grey_row,
    magnitude_row,
    sobel_row,
    suppress_row,
)
from tinyphoon.stages.edge_storing import store_edges_row
from tinyphoon.tables import arctangent_table

ROWS = [rows for width in WIDTHS for rows in three_rows(width)]
ANY_ROWS = st.integers(2, 40).flatmap(lambda width: arrays(np.uint8, (3, width)))
GARBAGE = 170
"""What output rows hold before: a kernel must write every pixel."""


def filled(width: int, dtype: type[np.generic] = np.uint8) -> np.ndarray:
    """A row of garbage."""
    return np.full(width, GARBAGE, dtype)


@given(st.integers(0, 2**32 - 1))
@example(0)
@example(1)
@example(2**32 - 1)
@example(65535**2 - 1)
@example(65535**2)
def test_square_root_is_exact(square: int) -> None:
    """Both long-hand roots are the integer root of every unsigned word."""
    assert isqrt32(square) == math.isqrt(square)
    assert tur94_root(square) == math.isqrt(square)


def test_arctangent_table_rises_to_an_eighth_of_a_turn() -> None:
    """The table goes from 0 to 32 without a step of more than 1, and is half-way to its tangent in the middle."""
    table = arctangent_table()
    assert (table[0], table[-1]) == (0, 32)
    assert set(np.diff(table.astype(int))) == {0, 1}
    assert table[round(256 * math.tan(math.pi / 8))] == 16


@pytest.mark.parametrize("width", WIDTHS)
def test_grey_is_the_luma(width: int) -> None:
    """Grey is every second byte of a UYVY row."""
    uyvy, grey = random_uyvy(width, 1, seed=width), filled(width)
    grey_row(uyvy[0], grey)
    np.testing.assert_array_equal(grey, references.luma(uyvy)[0])


def check_gauss(rows: Bytes) -> None:
    """Compare the smoothed middle row."""
    smooth = filled(rows.shape[1])
    gauss3_row(*rows, smooth)
    np.testing.assert_array_equal(smooth, references.gauss3(rows)[1])


def check_sobel(rows: Bytes) -> None:
    """Compare both gradients of the middle row."""
    width = rows.shape[1]
    gx, gy = filled(width, np.int16), filled(width, np.int16)
    sobel_row(*rows, gx, gy)
    for found, expected in zip((gx, gy), references.sobel(rows), strict=True):
        np.testing.assert_array_equal(found, expected[1])


def check_suppression(rows: Bytes, direction: Bytes, threshold: int) -> None:
    """Compare the edges of the middle row."""
    edges = filled(rows.shape[1])
    suppress_row(*rows, direction, edges, threshold)
    expected = references.suppress(rows, np.broadcast_to(direction, rows.shape), threshold)
    np.testing.assert_array_equal(edges, expected[1])


@pytest.mark.parametrize("rows", ROWS)
def test_gauss_and_sobel_of_hard_rows(rows: Bytes) -> None:
    """Flat, steep, noisy and narrow rows come out as in numpy."""
    check_gauss(rows)
    check_sobel(rows)


@given(ANY_ROWS)
def test_gauss_and_sobel_of_any_rows(rows: Bytes) -> None:
    """So do any rows at all, down to two pixels."""
    check_gauss(rows)
    check_sobel(rows)


def test_magnitude_of_every_gradient_that_bytes_can_have() -> None:
    """All pairs on a grid over -1020..1020 with its ends, and the longest one: a quarter, saturated."""
    axis = np.append(np.arange(-1020, 1020, 7), [0, 1, 1020]).astype(np.int16)
    gx, gy = (each.ravel() for each in np.meshgrid(axis, axis))
    found = filled(len(gx))
    magnitude_row(gx, gy, found)
    np.testing.assert_array_equal(found, references.magnitude(gx, gy))


def test_longest_gradient_is_a_corner_of_1140() -> None:
    """No window of bytes has a gradient longer than 255·√20; it is stored as 255, where a straight step fits."""
    windows = np.array(list(itertools.product((0, 255), repeat=9)), np.uint8).reshape(-1, 3, 3)
    gradients = [tuple(int(each[1, 1]) for each in references.sobel(window)) for window in windows]
    assert max(math.hypot(*each) for each in gradients) == pytest.approx(255 * math.sqrt(20))
    stored = filled(2)
    magnitude_row(np.array([1020, 1020], np.int16), np.array([510, 0], np.int16), stored)
    assert stored.tolist() == [255, 255]


def test_direction_is_exact_and_within_a_unit_of_the_true_angle() -> None:
    """The table's angle is bit-exact in all octants, and less than 1/256 of a turn from the arctangent."""
    axis = np.append(np.arange(-1020, 1020, 7), [-1, 0, 1, 1020]).astype(np.int16)
    gx, gy = (each.ravel() for each in np.meshgrid(axis, axis))
    found = filled(len(gx))
    direction_row(gx, gy, arctangent_table(), found)
    np.testing.assert_array_equal(found, references.angle(gx, gy))
    error = found - np.arctan2(gy.astype(float), gx) * 128 / np.pi
    error = (error + 128) % 256 - 128
    assert abs(error[(gx != 0) | (gy != 0)]).max() < 1


@pytest.mark.parametrize(
    ("gx", "gy", "expected"),
    [
        (0, 0, 0),
        (5, 0, 0),
        (5, 5, 32),
        (0, 5, 64),
        (-5, 5, 96),
        (-5, 0, 128),
        (-5, -5, 160),
        (0, -5, 192),
        (5, -5, 224),
    ],
)
def test_direction_turns_from_right_to_down(gx: int, gy: int, expected: int) -> None:
    """The eight main directions, clockwise on the picture."""
    found = filled(1)
    direction_row(np.array([gx], np.int16), np.array([gy], np.int16), arctangent_table(), found)
    assert found[0] == expected


@pytest.mark.parametrize("rows", ROWS)
@pytest.mark.parametrize("threshold", [1, 8, 255])
def test_suppression_of_hard_rows(rows: Bytes, threshold: int) -> None:
    """Removing weak edges with the suppression gives what the thesis's two steps give."""
    width = rows.shape[1]
    check_suppression(rows, np.random.default_rng(width).integers(0, 256, width, np.uint8), threshold)
    check_suppression(rows, (np.arange(width) * 16).astype(np.uint8), threshold)


@given(st.data(), st.integers(1, 255))
def test_suppression_of_any_rows(data: st.DataObject, threshold: int) -> None:
    """Any magnitudes, directions and thresholds; few different values, so that many are equal."""
    width = data.draw(st.integers(2, 30))
    rows = data.draw(arrays(np.uint8, (3, width), elements=st.sampled_from([0, 1, 8, 9, 100, 254, 255])))
    direction = data.draw(arrays(np.uint8, width))
    check_suppression(rows, direction, threshold)


def test_edge_between_two_equal_pixels_is_one_pixel_wide() -> None:
    """A plateau of two keeps the second pixel in the direction's axis, a ridge keeps its top."""
    flat = np.array([0, 0, 50, 50, 0, 0, 90, 0], np.uint8)
    edges = filled(8)
    suppress_row(flat, flat, flat, np.zeros(8, np.uint8), edges, 8)
    assert edges.tolist() == [0, 0, 0, 50, 0, 0, 90, 0]


@settings(max_examples=50)
@given(st.data(), st.integers(0, 40))
def test_store_keeps_what_fits_and_counts_the_rest(data: st.DataObject, capacity: int) -> None:
    """Rows of edges fill the store in order; a full one is not written beyond its end, and nothing is forgotten."""
    height, width = data.draw(st.integers(1, 5)), data.draw(st.integers(4, 20))
    edges = data.draw(arrays(np.uint8, (height, width), elements=st.sampled_from([0, 0, 8, 255])))
    direction = data.draw(arrays(np.uint8, (height, width)))
    memory, index, counts = filled(64, np.uint32), filled(height, np.uint32), filled(height, np.uint16)
    found = 0
    for y in range(height):
        found = store_edges_row(edges[y], direction[y], memory[:capacity], index, counts, y, found)
    expected = references.edge_store(edges, direction, capacity)
    used = len(expected.data)
    assert memory[:used].tolist() == expected.data
    assert set(memory[used:].tolist()) == {GARBAGE}
    assert (index.tolist(), counts.tolist()) == (expected.index, expected.counts)
    assert found - used == expected.lost


def test_stored_edge_has_the_bytes_of_the_thesis() -> None:
    """An edge lies in memory as t_EdgeDataElement of T Listing 5.1: gradient, direction, x, little-endian."""
    edges, direction = np.zeros(640, np.uint8), np.zeros(640, np.uint8)
    edges[600], direction[600] = 200, 255
    data, index, counts = np.zeros(1, np.uint32), np.zeros(1, np.uint32), np.zeros(1, np.uint16)
    assert store_edges_row(edges, direction, data, index, counts, 0, 0) == 1
    element = data.view([("gradient", "u1"), ("direction", "u1"), ("x", "<u2")])[0]
    assert element.tolist() == (200, 255, 600)
