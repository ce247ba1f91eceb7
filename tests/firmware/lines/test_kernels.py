"""The line detection, word for word against plain Python on lists of edges."""

from __future__ import annotations

from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.firmware import references
from tests.firmware.lines import line_references
from tests.firmware.lines.line_references import Row, Thresholds
from tests.firmware.lines.line_rig import edge_across, edges_of, find_lines
from tinyphoon.stages.line_fit import foot, slope, spread
from tinyphoon.stages.line_segments import turn_between
from tinyphoon.strategy.modes import INDOOR_FIELD


def check(rows: list[Row], width: int, *, capacity: int = 192, **thresholds: int) -> int:
    """Compare all words of all lines, and the edges lost; return how many lines there are."""
    mode = replace(INDOOR_FIELD.lines, **thresholds)
    found = find_lines(rows, width, mode, capacity)
    wanted = Thresholds(**asdict(mode))
    expected, lost = line_references.lines(rows, (width, len(rows)), capacity, wanted, references.angle_of)
    assert found.lines.tolist() == expected
    assert found.lost == lost
    return len(expected)


@st.composite
def edge_rows(draw: st.DrawFn) -> tuple[list[Row], int]:
    """Edges anywhere, with few different directions, so that many agree."""
    width, height = draw(st.integers(1, 24)), draw(st.integers(1, 12))
    some = st.sampled_from(draw(st.lists(st.integers(0, 255), min_size=1, max_size=4)))
    rows = []
    for _ in range(height):
        places = sorted(draw(st.sets(st.integers(0, width - 1))))
        rows.append([(x, (draw(some) + draw(st.integers(-3, 3))) % 256) for x in places])
    return rows, width


@settings(max_examples=150)
@given(edge_rows(), st.sampled_from([1, 2, 3, 20]), st.integers(1, 6), st.integers(1, 9))
def test_any_edges(picture: tuple[list[Row], int], capacity: int, min_length: int, mean_edges: int) -> None:
    """Any edges at all, in tables that overflow and in one that does not."""
    rows, width = picture
    check(rows, width, capacity=capacity, min_length=min_length, mean_edges=mean_edges, muff_range=12)


@settings(max_examples=30)
@given(st.lists(st.tuples(*[st.integers(0, 47)] * 4, st.integers(0, 255)), max_size=8))
def test_any_triangles(triangles: list[tuple[int, int, int, int, int]]) -> None:
    """Triangles over each other, through the edge detection."""
    x, y = np.meshgrid(np.arange(48), np.arange(48))
    picture = np.full((48, 48), 128, np.uint8)
    for x0, y0, x1, y1, grey in triangles:
        inside = ((x - x0) * (y1 - y0) > (y - y0) * (x1 - x0)) & (x > y0 // 2) & (y < 24 + x1 // 2)
        picture[inside] = grey
    check(edges_of(picture), 48)


@pytest.mark.parametrize("seed", range(3))
def test_noise(seed: int) -> None:
    """Nothing but noise fills the table; what has no place is counted."""
    noise = np.random.default_rng(seed).integers(0, 256, (40, 120)).astype(np.uint8)
    rows = edges_of(noise)
    check(rows, 120)
    check(rows, 120, capacity=9, min_length=3)
    assert find_lines(rows, 120, replace(INDOOR_FIELD.lines, min_length=3), capacity=9).lost > 100


def test_faint_noise_has_no_lines() -> None:
    """The noise of a camera on a grey wall stays below the edge threshold."""
    noise = np.random.default_rng(1).normal(128, 1.5, (60, 80)).round().astype(np.uint8)
    assert len(find_lines(edges_of(noise), 80).lines) == 0


@pytest.mark.parametrize(("width", "height"), [(1, 1), (2, 1), (7, 3), (33, 21), (640, 5), (5, 480)])
def test_pictures_without_edges(width: int, height: int) -> None:
    """An empty store has no lines, whatever the size and whatever the memory held before."""
    found = find_lines([[]] * height, width)
    assert (len(found.lines), found.lost) == (0, 0)


@pytest.mark.parametrize(("width", "height"), [(9, 40), (41, 9), (31, 33), (640, 12), (10, 480)])
def test_every_pixel_an_edge(width: int, height: int) -> None:
    """A store with an edge in every pixel, as no picture has it: sums of all of them keep in 32 bits."""
    assert check([[(x, 64) for x in range(width)]] * height, width) == 1


@pytest.mark.parametrize("degrees", [0, 30, 45, 77, 90, 135, 200, 315])
def test_one_edge_through_the_picture(degrees: int) -> None:
    """A straight edge of any direction, bit for bit."""
    assert check(edges_of(edge_across(degrees)), 64) == 1


def test_single_edge_is_a_pixel_long() -> None:
    """The shortest line there can be goes across its pixel."""
    found = find_lines([[(3, 192)]], 8, replace(INDOOR_FIELD.lines, min_length=1))
    assert found.lines[:, :7].tolist() == [[40, 0, 56, 0, 0, 1, 255]]


@given(st.integers(0, 255), st.integers(0, 255))
def test_turn_is_the_shorter_way(one: int, other: int) -> None:
    """The turn leads from one angle to the other and is half a turn at most."""
    turned = turn_between(one, other)
    assert -128 <= turned < 128
    assert (other + turned) % 256 == one


@given(st.lists(st.tuples(st.integers(0, 723), st.integers(0, 723)), min_size=1, max_size=4096))
def test_spread_of_any_points(points: list[tuple[int, int]]) -> None:
    """The largest pictures and fullest stores stay exact in 32 bits."""
    a, b = zip(*points, strict=True)
    for one, other in ((a, a), (a, b), (b, b)):
        products = sum(x * y for x, y in zip(one, other, strict=True))
        assert spread(products, sum(one), sum(other), len(points)) == line_references.spread(one, other)


@given(st.integers(1, 2**31 - 1), st.floats(-1, 1))
def test_slope_is_right_to_a_fraction(along: int, ratio: float) -> None:
    """A slope of any spread, 1 at most, is off by less than two units."""
    across = int(along * ratio)
    assert abs(slope(along, across) - 4096 * across / along) < 2


@given(st.integers(-11584, 11584), st.integers(-11584, 11584), st.integers(-4096, 4096))
def test_foot_is_the_nearest_point(along: int, across: int, rise: int) -> None:
    """The foot of a point on a line, anywhere in the largest picture, is right to a sixteenth and rounding."""
    gradient = rise / 4096
    exact = (along + gradient * across) / (1 + gradient**2)
    assert abs(foot(along, across, rise) - exact) < 3.5


@pytest.mark.parametrize("quarter", range(4))
def test_every_direction_has_its_side(quarter: int) -> None:
    """A level and an upright line of each of the 256 directions start where the reference says."""
    for direction in range(64 * quarter, 64 * quarter + 64):
        assert check([[(x, direction) for x in range(2, 14)]], 16) <= 1
        assert check([[(5, direction)] for _ in range(12)], 16) <= 1


def test_of_two_pieces_equally_near_the_first_is_taken() -> None:
    """A line may go on in the row above or in the one below, six pixels on."""
    rows: list[Row] = [[] for _ in range(20)]
    rows[10] = [(x, 192) for x in range(5, 31)]
    rows[9] = [(x, 192) for x in range(36, 60)]
    rows[11] = [(x, 192) for x in range(36, 60)]
    assert check(rows, 64) == 2
