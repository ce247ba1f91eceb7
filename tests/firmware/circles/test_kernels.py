"""The kernels of the circle detection against plain references, and their extremes."""

from __future__ import annotations

from collections.abc import Sequence
from math import erf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.firmware.circles import circle_references as expected
from tests.firmware.circles.circle_references import Edge
from tests.firmware.pictures import random_uyvy
from tinyphoon.stages.circle_consensus import agree_on_side, find_consensus
from tinyphoon.stages.circle_edges import (
    AREA_WORDS,
    BORDERING,
    REACH,
    edge_x,
    edge_y,
    is_near_colour,
    looks_along,
    looks_away,
    middle_beyond,
    next_blob,
    open_area,
    select_edges_row,
)
from tinyphoon.stages.circle_fit import FIT_WORDS, REFINED, RISE_SUM, SQUARE_SUM
from tinyphoon.stages.circle_judging import share_of, sixteenths
from tinyphoon.stages.circle_outline import (
    LUMA_LINES,
    REACH_LINES,
    RISES,
    clear_points,
    flank,
    luma_row,
    outline_offset,
    refine_row,
    steepest,
)
from tinyphoon.stages.circle_radius import edges_round, fill_histogram, find_radius, mean_radius
from tinyphoon.stages.circle_votes import (
    clear_votes,
    draw_lines,
    find_peak,
    gradient_slope,
    mean_offset,
    votes_round,
)
from tinyphoon.tables import arctangent_table, tangent_table

ATAN, TANGENTS = arctangent_table(), tangent_table()
SIZE = 64

edges_in_picture = st.lists(
    st.tuples(st.integers(1, SIZE - 2), st.integers(0, SIZE - 1), st.integers(0, 255)), max_size=60
).map(lambda edges: sorted(edges, key=lambda edge: edge[1]))
places = st.integers(0, SIZE - 1)


def words(edges: Sequence[Edge]) -> np.ndarray:
    """Edges as the selection has them; one that must not be read behind them."""
    return np.array([d | y << 8 | x << 20 for x, y, d in edges] + [0xFFFFFFFF], np.uint32)


def area_of(box: tuple[int, int, int, int], mass: tuple[int, int], reach: int) -> np.ndarray:
    """The words of an area."""
    return np.array([*box, *mass, reach, 0], np.int32)


@given(st.integers(0, 255), st.integers(-SIZE, SIZE), st.integers(-SIZE, SIZE), st.integers(0, 64))
def test_a_gradient_looks_along_the_way_to_a_place(direction: int, dx: int, dy: int, limit: int) -> None:
    """All quadrants and the wrap of angles, towards the place and away from it."""
    to_place = int(expected.references.angle(np.array([dx]), np.array([dy]))[0])
    off = expected.turn(direction, to_place)
    assert looks_along(direction, dx, dy, limit, ATAN) == (
        1 if off <= limit else -1 if off >= 128 - limit else 0
    )


def test_colour_is_near_up_to_two_columns_away() -> None:
    """A single coloured pixel in each row and column in turn; at the ends of a row nothing beyond it is read."""
    for row in range(3):
        for column in range(9):
            lines = np.zeros((3, 9), np.uint32)
            lines[row, column] = 4
            near = [is_near_colour(*lines, x, 6) for x in range(9)]
            assert near == [abs(x - column) <= 2 for x in range(9)]
            assert is_near_colour(*lines, column, 3) == 0


@settings(max_examples=40)
@given(edges_in_picture, st.integers(0, 2**32 - 1), places, places, st.booleans(), st.integers(0, 60))
def test_selected_edges(edges: list[Edge], seed: int, x: int, y: int, near: bool, room: int) -> None:
    """Every row of a picture of chance: the first ones are stored, all are counted."""
    opened = np.random.default_rng(seed).choice(
        np.array([2, 4, 6, 8], np.uint32), (SIZE, SIZE), p=[0.45, 0.5, 0, 0.05]
    )
    box = 3, 57, 0, SIZE - 1
    counts = np.bincount([edge[1] for edge in edges], minlength=SIZE)
    store = (
        np.array([9 | d << 8 | at << 16 for at, _, d in edges] or [0], np.uint32),
        np.cumsum([0, *counts])[:-1].astype(np.uint32),
        counts.astype(np.uint16),
    )
    selected, found = np.zeros(room, np.uint32), 0
    area = area_of(box, (x, y), 9)
    for row in range(SIZE):
        lines = [opened[min(max(each, 0), SIZE - 1)] for each in (row - 1, row, row + 1)]
        found = select_edges_row(*store, row, *lines, 6, area, 40, int(near), ATAN, selected, found)
    wanted, away, bordering = expected.selected(edges, opened, 6, box, (x, y), 40, near)
    assert (found, area[BORDERING]) == (len(wanted), bordering)
    stored = min(found, room)
    assert [(edge_x(each), edge_y(each)) for each in selected[:stored]] == [
        each[:2] for each in wanted[:room]
    ]
    assert [looks_away(each) for each in selected[:stored]] == away[:room]
    left = agree_on_side(selected, stored, area, np.zeros(FIT_WORDS, np.int32))
    kept = expected.agreeing_on_side(wanted[:room], away[:room], (x, y), 9)
    assert [(edge_x(each), edge_y(each)) for each in selected[:left]] == [each[:2] for each in kept]


@pytest.mark.parametrize(("stray", "left"), [(0, 40), (2, 40), (3, 32), (8, 32)])
def test_three_quarters_of_the_other_side_decide(stray: int, left: int) -> None:
    """Eight of forty look the other way: with two of them off the circle of all they stay, with three they are left out."""
    turns = 2 * np.pi * np.arange(40) / 40
    places = np.rint(30 + 20 * np.array([np.cos(turns), np.sin(turns)])).astype(int).T.tolist()
    other = set(range(16, 24))
    for number in range(16, 16 + stray):
        places[number] = [25, 30 + number - 16]
    edges = sorted((y, x, number in other) for number, (x, y) in enumerate(places))
    selected = np.array([x << 20 | away << 19 | y << 8 for y, x, away in edges], np.uint32)
    assert (
        agree_on_side(selected, 40, area_of((0, 0, 0, 0), (30, 30), 9), np.zeros(FIT_WORDS, np.int32)) == left
    )


def test_without_a_circle_one_side_is_left() -> None:
    """Edges in a column have no circle: of 15, 6 look away, and 9 stay."""
    edges = np.array([3 << 20 | (number < 6) << 19 | number << 8 for number in range(15)], np.uint32)
    assert agree_on_side(edges, 15, area_of((0, 0, 0, 0), (3, 7), 9), np.zeros(FIT_WORDS, np.int32)) == 9


def test_slopes_of_all_directions() -> None:
    """The table unfolded by octants."""
    assert [gradient_slope(each, TANGENTS) for each in range(256)] == [
        expected.slope(each) for each in range(256)
    ]


@settings(max_examples=60)
@given(edges_in_picture, places, places, st.integers(0, 32), st.integers(0, 2))
def test_votes_and_their_peak(edges: list[Edge], x: int, y: int, reach: int, around: int) -> None:
    """Patches of all sizes, edges inside and outside, the patch beyond the picture."""
    around = min(around, reach)
    votes = np.full(65 * 65, 77, np.uint16)
    area = area_of((0, 0, 0, 0), (x, y), reach)
    clear_votes(votes, area)
    draw_lines(words(edges), len(edges), votes, area, TANGENTS)
    patch = expected.votes(edges, (x, y), reach)
    side = 2 * reach + 1
    assert votes[: side * side].tolist() == patch.ravel().tolist()
    row, column, size = expected.peak(patch, around)
    place = find_peak(votes, reach, around)
    if size == 0:
        assert votes_round(votes, side, place, around) == 0
        return
    assert (place, votes_round(votes, side, place, around)) == (row * side + column, size)
    square = patch[row - around : row + around + 1, column - around : column + around + 1]
    assert mean_offset(votes, place, 1, side, around) == expected.mean_offset(square.sum(axis=0).tolist())
    assert mean_offset(votes, place, side, 1, around) == expected.mean_offset(square.sum(axis=1).tolist())


@given(edges_in_picture, st.integers(-500, 4600), st.integers(-500, 4600), st.integers(0, 2))
def test_radius_histogram_and_its_peak(edges: list[Edge], x: int, y: int, around: int) -> None:
    """Centres in 1/64 px, also outside the picture; edges beyond the last bin are left out."""
    histogram, fit = np.full(40, 77, np.uint16), np.zeros(FIT_WORDS, np.int32)
    fit[:2] = x, y
    fill_histogram(words(edges), len(edges), fit, histogram)
    counts = expected.histogram(edges, (x, y), 40)
    assert histogram.tolist() == counts
    radius, size, mean = expected.radius_peak(counts, around)
    assert find_radius(histogram, around) == radius
    assert edges_round(histogram, radius, around) == size
    if size:
        assert mean_radius(histogram, radius, around) == mean


@settings(max_examples=40)
@given(edges_in_picture, st.integers(0, 99), places, places, st.integers(0, 40))
def test_points_on_the_outline(edges: list[Edge], seed: int, x: int, y: int, radius: int) -> None:
    """Edges at the border of the picture too; what lies further than 3 px from the circle becomes no point."""
    uyvy = random_uyvy(SIZE, SIZE, seed)
    fit = np.zeros(FIT_WORDS, np.int32)
    fit[:3] = 64 * x + 7, 64 * y - 9, 64 * radius
    clear_points(fit)
    selected, luma = words(edges), np.full(LUMA_LINES * SIZE, 77, np.uint8)
    rises, steep = np.zeros(RISES, np.int32), np.full(len(edges), 77, np.uint16)
    for ahead in range(SIZE + REACH_LINES):
        if ahead < SIZE:
            luma_row(uyvy[ahead], luma, ahead, area_of((0, SIZE - 1, 0, SIZE - 1), (x, y), 9))
        if ahead >= REACH_LINES:
            refine_row(selected, len(edges), ahead - REACH_LINES, luma, SIZE, fit, 3, rises, steep)
    away = [expected.distance((64 * each[0], 64 * each[1]), (64 * x + 7, 64 * y - 9)) for each in edges]
    close = [edge for edge, each in zip(edges, away, strict=True) if abs(each - 64 * radius) <= 192]
    wanted = [expected.point_of(edge, expected.references.luma(uyvy)) for edge in close]
    assert [(word & 0xFFFF, word >> 16) for word in selected[: fit[REFINED]].tolist()] == [
        point for point, *_ in wanted
    ]
    assert steep[: fit[REFINED]].tolist() == [rise for _, rise, _ in wanted]
    assert (fit[RISE_SUM], fit[SQUARE_SUM]) == expected.breadths(wanted)


@settings(max_examples=60)
@given(
    edges_in_picture.filter(lambda edges: len(edges) > 2),
    places,
    places,
    st.integers(0, 32),
    st.integers(0, 2000),
)
def test_the_consensus(edges: list[Edge], x: int, y: int, reach: int, radius: int) -> None:
    """Edges of chance and on a circle, with and without a circle to begin with, and a patch that leaves centres out."""
    on_circle = [
        (round(30 + 20 * np.cos(each)), round(33 + 20 * np.sin(each)), 0) for each in np.arange(0, 6.2, 0.2)
    ]
    for every in (edges, sorted(edges + on_circle, key=lambda edge: edge[1])):
        fit = np.zeros(FIT_WORDS, np.int32)
        fit[:3] = 64 * 31, 64 * 30, radius
        share = find_consensus(words(every), len(every), area_of((0, 0, 0, 0), (x, y), reach), fit)
        start = (64 * 31, 64 * 30, radius) if radius else None
        circle, wanted = expected.consensus(every, (x, y), reach, start)
        assert share == wanted
        if circle:
            assert tuple(fit[:3].tolist()) == circle


@pytest.mark.parametrize("sigma", [0.3, 0.7, 1.5, 2.5])
@pytest.mark.parametrize("shift", [-1.3, -0.5, -0.1, 0.0, 0.25, 0.7, 1.4])
def test_a_blurred_step_is_found_where_it_is(sigma: float, shift: float) -> None:
    """To a third of a pixel, wherever it lies between pixels, and on a slope."""
    places = np.arange(-7, 9)
    step = np.array([0.5 * (1 + erf((place - shift) / (sigma * 2**0.5))) for place in places])
    for slope in (0.0, 2.0):
        rises = np.diff(np.rint(40 + 120 * step + slope * places).astype(np.int32))
        at = steepest(rises)
        beside = flank(rises, at, -1), flank(rises, at, 1)
        off = outline_offset(rises, at, *beside, np.zeros(FIT_WORDS, np.int32)) / 64 - shift
        assert abs(off) < 0.3


@pytest.mark.parametrize(("part", "whole", "share"), [(0, 5, 0), (1, 2, 128), (5, 5, 255), (9, 3, 255)])
def test_shares(part: int, whole: int, share: int) -> None:
    """In 1/256, and 255 for all."""
    assert share_of(part, whole) == share


@given(st.integers(1, 307_200), st.floats(0, 639))
def test_mean_of_a_blob_in_sixteenths(pixels: int, mean: float) -> None:
    """The sum of a picture of 640 x 480 is near to 32 bits already."""
    total = int(pixels * mean)
    assert sixteenths(total, pixels) == (32 * total + pixels) // (2 * pixels)


def test_areas_end_at_the_picture() -> None:
    """A blob in the corner, and the second of three with the colours asked for."""
    blobs = np.zeros((4, 8), np.uint32)
    blobs[:, 0] = 1, 6, 8, 4
    blobs[1, 4:6] = 2 | 40 << 16, 1 | 29 << 16
    blobs[1, 7] = 20 | 15 << 16
    records = blobs.ravel()
    assert [next_blob(records, each, 4, 4) for each in range(5)] == [1, 1, 3, 3, -1]
    assert next_blob(records, 2, 3, 4) == -1
    area = np.zeros(AREA_WORDS, np.int32)
    assert open_area(records, 1, area, 4, 32, 43, 31) == 0 | 30 << 16
    assert area.tolist() == [0, 42, 0, 30, 20, 15, 19, 0]
    open_area(records, 1, area, 4, 7, 43, 31)
    assert area[REACH] == 7


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 639), st.integers(0, 639), st.integers(1, 640), st.integers(0, 639))
def test_the_middle_of_what_the_border_cuts(one: int, other: int, chord: int, mass: int) -> None:
    """Any blob of a picture 640 wide: the centre of mass, or what the height over the chord says."""
    span = min(one, other), max(one, other)
    found = middle_beyond(span[0] | span[1] << 16, chord, 640, mass)
    assert found == expected.middle(span, chord, 640, mass)
    assert -640 < found < 1280


@pytest.mark.parametrize(
    ("span", "pixels", "middle"),
    [
        ((200, 238), 240, 265),  # 39 px high over a chord of 120: the radius is 65
        ((200, 237), 240, 219),  # not cut
        ((1, 39), 240, -26),
        ((1, 39), 41, 20),  # cut at both ends
        ((178, 238), 240, 219),  # more than half of it
        ((222, 238), 240, 219),  # hardly any of it
    ],
)
def test_a_middle_beyond_the_border(span: tuple[int, int], pixels: int, middle: int) -> None:
    """What is cut, by how much; else the centre of mass, here 219 or 20."""
    mass = 20 if pixels == 41 else 219
    assert middle_beyond(span[0] | span[1] << 16, 120, pixels, mass) == middle
