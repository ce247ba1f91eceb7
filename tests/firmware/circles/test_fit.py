"""The kernels of the fit of a circle to its outline, against plain references, and their extremes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.firmware.circles import circle_fit_references as expected
from tests.tiers import exhaustive
from tinyphoon.stages.circle_fit import (
    FIT_WORDS,
    OUTSIDE_BITS,
    REFINED,
    RISE_SUM,
    SQUARE_SUM,
    arc_of,
    expect_bulge,
    fit_circle,
)
from tinyphoon.tables import arctangent_table

ATAN = arctangent_table()

points_near = st.lists(
    st.tuples(st.floats(0, 6.28), st.integers(-250, 250), st.integers(0, 255)), max_size=80
)


EVEN = 100


def words_of(weights: list[expected.Weights]) -> list[int]:
    """What points count as the kernels have it."""
    return [inside | outside << OUTSIDE_BITS for inside, outside in weights]


breadths = st.builds(
    lambda whole, square_px: (whole, whole * square_px >> 8), st.integers(0, 1 << 27), st.integers(0, 15 << 8)
)


@given(points_near, st.integers(1, 100), st.integers(0, 8), st.integers(1, 2000), breadths)
def test_rounds_of_the_fit(
    around: list[tuple[float, int, int]], radius: int, rounds: int, focal_px: int, breadth: expected.Breadth
) -> None:
    """Scattered points, arcs, a single point and none, with lenses from one pixel to 2000; it stops early where little moves."""
    points = [
        (int(8000 + (64 * radius + off) * np.cos(angle)), int(7900 + (64 * radius + off) * np.sin(angle)))
        for angle, off, _ in around
    ]
    steep = [each for _, _, each in around]
    fit = np.zeros(FIT_WORDS, np.int32)
    fit[:3] = 8010, 7890, 64 * radius
    fit[REFINED] = len(points)
    fit[RISE_SUM], fit[SQUARE_SUM] = breadth
    words = np.array([x | y << 16 for x, y in points] or [0], np.uint32)
    counts = np.array(steep or [0], np.uint16)
    circle, limit = (8010, 7890, 64 * radius), 192
    bulge = expected.bulge_of(circle, focal_px, (640, 480))
    expect_bulge(fit, np.array([16 * focal_px, *[0] * 8], np.int32), 640, 480)
    fit_circle(words, counts, fit, 3, rounds)
    wanted = expected.weights(steep)
    assert counts[: len(points)].tolist() == words_of(wanted)
    circle = expected.settled(circle, points, wanted, limit, rounds, bulge)
    assert tuple(fit[:3].tolist()) == expected.without_blur(circle, breadth)


@settings(max_examples=25)
@given(st.floats(300, 340), st.floats(200, 240), st.floats(5, 200), st.floats(0, 6.28), st.floats(2.0, 6.28))
def test_the_fit_goes_to_the_circle(x: float, y: float, radius: float, start: float, arc: float) -> None:
    """From 1.5 px off, exact points on more than a third of the circle lead to centre and radius; most words of a sum."""
    angles = start + arc * np.arange(1900) / 1900
    points = np.rint(64 * np.array([x + radius * np.cos(angles), y + radius * np.sin(angles)])).astype(int)
    fit = np.zeros(FIT_WORDS, np.int32)
    fit[:3] = 64 * (x + 1), 64 * (y - 1), 64 * (radius - 0.5)
    fit[REFINED] = points.shape[1]
    steep = np.full(points.shape[1], EVEN, np.uint16)
    fit_circle((points[0] | points[1] << 16).astype(np.uint32), steep, fit, 3, 12)
    assert np.abs(fit[:3] / 64 - (x, y, radius)).max() < 0.15


def fitted_radius(off: NDArray[np.int64], steep: NDArray[np.int64]) -> float:
    """The radius of a circle of 20 px, from points that lie off it by some 1/64 px."""
    angles = 2 * np.pi * np.arange(len(off)) / len(off)
    x, y = (np.rint(4000 + (1280 + off) * each(angles)).astype(int) for each in (np.cos, np.sin))
    fit = np.zeros(FIT_WORDS, np.int32)
    fit[:3], fit[REFINED] = (4000, 4000, 1280), len(off)
    fit_circle((x | y << 16).astype(np.uint32), steep.astype(np.uint16), fit, 3, 8)
    return float(fit[2]) / 64


def test_in_even_light_both_sides_of_the_circle_count_alike() -> None:
    """Points that scatter by half a pixel to both sides leave the radius as it is."""
    off = np.tile([-32, 32, 0, 16, -16], 24)
    assert fitted_radius(off, np.full(120, 80)) == pytest.approx(20, abs=0.02)


def test_points_in_the_shade_do_not_pull_the_circle_in() -> None:
    """A third of the outline, four times less steep, lies three quarters of a pixel further in."""
    shade = np.arange(120) % 3 == 0
    assert fitted_radius(np.where(shade, -48, 0), np.where(shade, 20, 80)) == pytest.approx(20, abs=0.1)


@pytest.mark.parametrize("seen", [(0, 6.28), (3.6, 5.8)])
@pytest.mark.parametrize(("x_px", "y_px"), [(0, 0), (120, 0), (0, -100), (-140, 90)])
def test_the_image_of_a_sphere(x_px: float, y_px: float, seen: tuple[float, float]) -> None:
    """A cone of rays round the way to a ball, cut askew by the picture: the mean of its half axes, of the whole and of a part."""
    focal, radius = 386.0, 0.15
    axis = np.array([x_px / focal, y_px / focal, 1.0])
    axis /= np.linalg.norm(axis)
    aside = np.cross(axis, [0.0, 1.0, 0.0])
    aside /= np.linalg.norm(aside)
    turns = np.linspace(0, 6.28, 900)
    rays = axis + radius * (np.cos(turns)[:, None] * aside + np.sin(turns)[:, None] * np.cross(axis, aside))
    outline = focal * rays[:, :2] / rays[:, 2:] + (319.5, 239.5)
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    from_middle = np.hypot(*(outline - middle).T)
    mean = (from_middle.max() + from_middle.min()) / 2
    angles = np.arctan2(*(outline - middle).T[::-1]) % 6.2832
    kept = outline[(angles >= seen[0]) & (angles <= seen[1])]
    points = np.rint(64 * kept).astype(int)
    fit = np.zeros(FIT_WORDS, np.int32)
    fit[:3], fit[REFINED] = (*np.rint(64 * (middle + 1)), 64 * (mean - 1)), len(points)
    expect_bulge(fit, np.array([16 * focal, *[0] * 8], np.int32), 640, 480)
    fit_circle(
        (points[:, 0] | points[:, 1] << 16).astype(np.uint32),
        np.full(len(points), EVEN, np.uint16),
        fit,
        3,
        12,
    )
    assert fit[2] / 64 == pytest.approx(mean, abs=0.4)
    assert np.hypot(*(fit[:2] / 64 - middle)) < 0.4


@pytest.mark.parametrize("off", [250, *exhaustive(1, 64, 148)])
def test_sums_of_the_largest_picture_stay_in_32_bits(off: int) -> None:
    """All edges that a picture 640 wide has room for, outside a circle as far as it can be, with nearly the largest weight."""
    count = 1920
    points = np.full(count, 40_900 | 30_600 << 16, np.uint32)
    for steep in ([255] * count, [255, 1] * (count // 2)):
        fit = np.zeros(FIT_WORDS, np.int32)
        fit[REFINED] = count
        start = 0, 0, expected.distance((40_900, 30_600), (0, 0)) - off
        fit[:3] = start
        counts = expected.weights(steep)
        circle = expected.refined(start, [(40_900, 30_600)] * count, counts, 256)
        fit_circle(points, np.array(steep, np.uint16), fit, 4, 1)
        assert tuple(fit[:3].tolist()) == circle


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 64 * 640), st.integers(0, 64 * 480)), max_size=12),
    st.lists(st.tuples(st.floats(0, 7), st.integers(-80, 80)), max_size=40),
    st.integers(64, 64 * 200),
)
def test_the_arc_that_is_seen(
    points: list[tuple[int, int]], near: list[tuple[float, int]], radius: int
) -> None:
    """Points of chance, and some a little off the circle."""
    centre = 64 * 300, 64 * 230
    points = points + [
        (max(round(centre[0] + (radius + off) * np.cos(angle)), 0), max(round(centre[1] + (radius + off) * np.sin(angle)), 0))
        for angle, off in near
    ]  # fmt: skip
    fit = np.zeros(FIT_WORDS, np.int32)
    fit[:3] = *centre, radius
    fit[REFINED] = len(points)
    words = np.array([x | y << 16 for x, y in points] or [0], np.uint32)
    assert arc_of(words, fit, ATAN) == expected.arc((*centre, radius), points)
