"""Lines that the firmware must find: where they are, which way they go, and what they cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.quality.seen import see_pictures
from benchmarks.table_6_1 import SQUARES, differences, sides, squares_picture, turned_squares
from tests.firmware.lines.line_references import Row
from tests.firmware.lines.line_rig import edge_across, edges_of, find_lines
from tests.firmware.lines.refinement_references import refined
from tests.firmware.pictures import random_uyvy
from tests.firmware.references import luma
from tinyphoon.strategy.modes import INDOOR_FIELD

THESIS_MEAN_PX = 2.11  # T Table 6.1

UP, DOWN, LEFT, RIGHT = 192, 64, 128, 0
"""Gradient directions."""


def store(height: int, *runs: tuple[int, Sequence[int], int]) -> list[Row]:
    """Rows of edges from (row, columns, direction)."""
    rows: list[dict[int, int]] = [{} for _ in range(height)]
    for y, columns, direction in runs:
        rows[y] |= dict.fromkeys(columns, direction)
    return [sorted(row.items()) for row in rows]


def test_level_line_in_closed_form() -> None:
    """Edges in columns 10 to 29 of row 7: twenty pixels, each end half a pixel beyond the middle of its edge."""
    found = find_lines(store(20, (7, range(10, 30), UP)), 40)
    # it leaves a picture of 40 x 20 on the left at 39 + 19 + 39 + (19 - 7), on the right at 39 + 7
    assert found.lines.tolist() == [[152, 112, 472, 112, 0, 20, 255, 109, 46]]


def test_upright_line_in_closed_form() -> None:
    """Bright on the left: it goes up, from the bottom border at 39 + 19 + (39 - 5) to the top border at 5."""
    found = find_lines(store(20, *((y, [5], LEFT) for y in range(4, 16))), 40)
    assert found.lines.tolist() == [[80, 248, 80, 56, 192, 12, 255, 92, 5]]


@pytest.mark.parametrize("sixteenth", range(16))
@pytest.mark.parametrize("contrast", [(60, 180), (0, 255), (100, 125)])
def test_sixteen_directions_both_ways(sixteenth: int, contrast: tuple[int, int]) -> None:
    """An edge through the middle is one line, exact to half a pixel, with the bright side on the left of its way."""
    degrees = 22.5 * sixteenth
    found = find_lines(edges_of(edge_across(degrees, 64, *contrast)), 64)
    assert len(found.lines) == 1
    (x0, y0, x1, y1), middle = found.ends[0], 31.5
    towards_bright = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    way = np.array([-towards_bright[1], towards_bright[0]])  # bright on the left, with y downwards
    assert np.dot([x1 - x0, y1 - y0], way) > 55
    for x, y in ((x0, y0), (x1, y1)):
        assert abs(np.dot([x - middle, y - middle], towards_bright)) < 0.7
    assert abs((found.lines[0, 4] - (16 * sixteenth + 64) + 128) % 256 - 128) <= 1
    assert found.lines[0, 6] >= 240


@pytest.mark.parametrize("slope", [1 / 3, 1 / 8, 1 / 15])
@pytest.mark.parametrize("falls_to_the_left", [False, True])
def test_flat_lines(slope: float, falls_to_the_left: bool) -> None:
    """A line that falls to the left comes from the right end of each row: it is as whole as its mirror image."""
    direction = round(64 + np.arctan(slope) * 128 / np.pi)
    columns = range(2, 92)
    runs = [(y, [x for x in columns if round(x * slope) == y], direction) for y in range(40)]
    if falls_to_the_left:
        runs = [(y, [93 - x for x in reversed(xs)], 128 - direction) for y, xs, _ in runs]
    found = find_lines(store(40, *runs), 94)
    assert len(found.lines) == 1
    assert found.lines[0, 5] == len(columns)
    # bright below: it goes to the left
    assert found.ends[0, 0] - found.ends[0, 2] == pytest.approx(90, abs=0.6)


def test_flat_arc_is_cut() -> None:
    """The mean of the first edges only does not follow a curve: a quarter of a circle is several lines."""
    x, y = np.meshgrid(np.arange(100), np.arange(100))
    disc = np.where(np.hypot(x - 5, y - 5) < 80, 50, 200).astype(np.uint8)
    found = find_lines(edges_of(disc), 100)
    lengths = np.hypot(*(found.ends[:, 2:] - found.ends[:, :2]).T)
    assert len(lengths) >= 3
    assert max(lengths) < 70


@pytest.mark.parametrize("missing", [1, 3])
def test_near_connector(missing: int) -> None:
    """Rows without edges cut an upright line in two; the local connector joins it up to its gap."""
    pieces = [*range(5, 20), *range(20 + missing, 40)]
    rows = store(45, *((y, [9], RIGHT) for y in pieces))
    mode = replace(INDOOR_FIELD.lines, near_gap=missing + 1, far_gap=0)
    (line,) = find_lines(rows, 20, mode).lines
    assert line[[0, 1, 2, 3]].tolist() == [144, 72, 144, 632]
    assert line[6] == 256 * len(pieces) // 35
    assert len(find_lines(rows, 20, replace(mode, near_gap=missing)).lines) == 2


def test_near_connector_leaves_corners() -> None:
    """Two lines that meet at a right angle stay two."""
    corner = store(30, (5, range(5, 20), UP), *((y, [20], RIGHT) for y in range(6, 25)))
    assert len(find_lines(corner, 30).lines) == 2


def test_far_connector() -> None:
    """Pieces of one line far from each other are connected by their Muff parameters, up to the largest gap."""
    pieces = (7, range(10, 30), UP), (7, range(50, 70), UP)
    (line,) = find_lines(store(20, *pieces), 100).lines
    assert line[[0, 1, 2, 3, 5]].tolist() == [152, 112, 1112, 112, 40]
    assert line[6] == 256 * 40 // 60
    assert len(find_lines(store(20, *pieces), 100, replace(INDOOR_FIELD.lines, far_gap=20)).lines) == 2


def test_far_connector_tells_parallels_and_directions_apart() -> None:
    """Not connected: a line ten rows further down, and one in the same row that goes the other way."""
    first = (7, range(10, 30), UP)
    assert len(find_lines(store(40, first, (17, range(40, 60), UP)), 100).lines) == 2
    opposite = find_lines(store(40, first, (7, range(40, 60), DOWN)), 100)
    assert sorted(opposite.lines[:, 4].tolist()) == [0, 128]


def test_crossing_edges() -> None:
    """Four fields of a chessboard: the contrast turns round at the crossing, so there are four lines."""
    board = np.full((60, 60), 40, np.uint8)
    board[:30, :30] = board[30:, 30:] = 220
    found = find_lines(edges_of(board), 60)
    ways = found.ends[:, 2:] - found.ends[:, :2]
    assert sorted(map(tuple, np.sign(ways).astype(int).tolist())) == [(-1, 0), (0, -1), (0, 1), (1, 0)]


def test_ladder_is_no_line() -> None:
    """Edges below each other whose gradients look down are many, but no line of any length."""
    rows = store(30, *((y, [7, 8], DOWN) for y in range(30)))
    assert len(find_lines(rows, 20).lines) == 0


def test_full_table_counts_the_edges_it_leaves_out() -> None:
    """Of five upright lines three have a place; the edges of the others are counted, all of them."""
    rows = store(20, *((y, range(4, 44, 8), RIGHT) for y in range(20)))
    found = find_lines(rows, 50, capacity=3)
    assert found.ends[:, 0].tolist() == [4, 12, 20]
    assert found.lost == 2 * 20


def test_short_segments_give_their_places_back() -> None:
    """A table for three holds the lines of a picture whose every row begins segments that come to nothing."""
    crumbs = [(y, [2 + 5 * (y % 3)], 37 * y % 256) for y in range(40)]
    rows = store(40, *crumbs, *((y, [30], RIGHT) for y in range(40)))
    found = find_lines(rows, 40, capacity=3)
    assert (len(found.lines), found.lost) == (1, 0)


def test_table_6_1() -> None:
    """All 16 sides, start to end in a loop round each square, nearer than the thesis's on average."""
    lines = see_pictures([squares_picture()])[0].lines
    found = differences(lines, sides())
    assert len(lines) == 4 * len(SQUARES)
    assert np.isfinite(found).all()
    assert found.mean() < THESIS_MEAN_PX / 2
    assert found.max() < 2


def test_squares_by_chance() -> None:
    """So it is for squares of other sizes, places and angles."""
    many = turned_squares(12, seed=6)
    seen = see_pictures([squares_picture(each) for each in many])
    found = [differences(each.lines, sides(squares)) for each, squares in zip(seen, many, strict=True)]
    assert np.isfinite(found).all()
    assert np.mean(found) < 1.3


@pytest.mark.parametrize(("width", "height"), [(4, 3), (62, 7), (34, 50), (100, 61)])
def test_on_the_board(width: int, height: int) -> None:
    """On the simulated board, after another picture, it finds what it finds without one; so does the other core."""
    pictures = [luma(random_uyvy(width, height, seed)) for seed in range(4)]
    limits = INDOOR_FIELD.refinement.reach, INDOOR_FIELD.refinement.min_step
    for picture, each in zip(pictures, see_pictures(pictures), strict=True):
        lines, _ = refined(find_lines(edges_of(picture), width).lines.tolist(), picture, *limits)
        assert each.lines.tolist() == [[word / 16 for word in line[:4]] for line in lines]
