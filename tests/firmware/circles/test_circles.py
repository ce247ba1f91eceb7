"""Circles that the firmware must find: drawn balls, whole, hidden, cut, textured, and what is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.seen_circles import see
from bfsim.recording import StereoFrame
from tests.firmware.circles.circle_rig import WHITE_RGB, YELLOW, Circles, Drawing, Seen, circles_of, seen
from tests.firmware.pictures import random_uyvy
from tinyphoon.geometry import THESIS_FOCAL_PX, THESIS_WIDTH_PX
from tinyphoon.stages.circle_detection import CIRCLE_CAPACITY, CircleThresholds
from tinyphoon.stores.circles import CIRCLE_ARC, CIRCLE_CENTRE, CIRCLE_EDGES, CIRCLE_RADIUS_SHARE
from tinyphoon.strategy.modes import FITTED_CIRCLES, INDOOR_FIELD, PLAIN_CIRCLES

BOTH = pytest.mark.parametrize("mode", [FITTED_CIRCLES, PLAIN_CIRCLES], ids=["fitted", "thesis"])
PASSED, CENTRE_ONLY, FAILED = 3, 1, 0


def checked(picture: Seen, mode: CircleThresholds) -> Circles:
    """Run the stage and compare every word with the reference."""
    found = circles_of(picture, mode)
    assert found.words.tolist() == picture.expected(YELLOW, mode)
    return found


def errors(found: Circles, *truth: tuple[float, float, float]) -> tuple[float, float]:
    """The greatest errors of centres and of radii in pixels, after all tests have passed."""
    assert found.tests == [PASSED] * len(truth)
    off = np.abs(found.places - truth)
    return float(np.hypot(off[:, 0], off[:, 1]).max()), float(off[:, 2].max())


@pytest.mark.exhaustive
@settings(max_examples=12)
@given(st.floats(36, 60), st.floats(36, 60), st.floats(5, 30), st.integers(0, 99))
def test_discs_anywhere(x: float, y: float, radius: float, seed: int) -> None:
    """To a tenth of a pixel with the fit, to 1.5 px as in the thesis; luma has the noise of a camera."""
    picture = seen(Drawing(96, 96).disc(x, y, radius).uyvy(noise=1.0, seed=seed))
    centre, size = errors(checked(picture, FITTED_CIRCLES), (x, y, radius))
    assert centre < 0.1
    assert size < 0.1
    centre, size = errors(checked(picture, PLAIN_CIRCLES), (x, y, radius))
    assert centre < 1.5
    assert size < 1.5


@pytest.mark.parametrize("half", ["left", "right", "top", "bottom"])
def test_half_hidden_disc(half: str) -> None:
    """A white thing before it, with an edge of its own: the half circle that is left has centre and radius."""
    sides = {
        "left": lambda x, _y: x < 48,
        "right": lambda x, _y: x > 48,
        "top": lambda _x, y: y < 48,
        "bottom": lambda _x, y: y > 48,
    }
    drawing = Drawing(96, 96).disc(48.3, 47.8, 22.4).paint(sides[half], WHITE_RGB)
    picture = seen(drawing.uyvy(noise=1.0))
    centre, size = errors(checked(picture, FITTED_CIRCLES), (48.3, 47.8, 22.4))
    assert centre < 0.8
    assert size < 0.6


@pytest.mark.parametrize(("x", "y"), [(2.5, 48.0), (93.0, 48.0), (48.0, 1.0), (48.0, 94.0), (6.0, 6.0)])
@BOTH
def test_disc_cut_by_the_border(x: float, y: float, mode: CircleThresholds) -> None:
    """About half of it is in the picture, in one case a quarter."""
    found = checked(seen(Drawing(96, 96).disc(x, y, 25).uyvy(noise=1.0)), mode)
    centre, size = errors(found, (x, y, 25))
    assert max(centre, size) < (0.3 if mode is FITTED_CIRCLES else 2.5)


def test_the_centre_may_lie_outside_the_picture() -> None:
    """Its coordinates are below 0 then."""
    found = checked(seen(Drawing(96, 96).disc(-6.0, 48.0, 25).uyvy(noise=1.0)), FITTED_CIRCLES)
    centre, size = errors(found, (-6.0, 48.0, 25))
    assert max(centre, size) < 0.5


@pytest.mark.parametrize(("x", "y"), [(-10.0, 48.0), (105.5, 48.0), (48.0, -10.0), (48.0, 105.5)])
def test_less_than_half_of_a_disc(x: float, y: float) -> None:
    """Its radius is 40: 30 are in the picture, and the centre of mass lies farther off than the patch reaches from edge to edge."""
    picture = seen(Drawing(96, 96).disc(x, y, 40).uyvy(noise=1.0))
    centre, size = errors(checked(picture, FITTED_CIRCLES), (x, y, 40))
    assert max(centre, size) < 1.0


def test_how_much_of_the_circle_is_seen() -> None:
    """All of a whole disc, half of a half hidden one, a third of one cut at 60 degrees from its middle; nothing where none is fitted."""
    drawings = [Drawing(96, 96).disc(48, 48, 22.4) for _ in range(2)] + [Drawing(96, 96).disc(48, 105.5, 25)]
    drawings[1].paint(lambda x, _y: x < 48, WHITE_RGB)
    arcs = [int(checked(seen(each.uyvy()), FITTED_CIRCLES).words[0, CIRCLE_ARC]) for each in drawings]
    assert arcs[0] == 256
    assert 112 <= arcs[1] <= 144
    assert 72 <= arcs[2] <= 104
    assert checked(seen(drawings[0].uyvy()), PLAIN_CIRCLES).words[0, CIRCLE_ARC] == 0


@BOTH
def test_two_balls_and_one_of_another_colour(mode: CircleThresholds) -> None:
    """Each ball has its record with the number of its blob; the blue disc has none."""
    drawing = Drawing(160, 96).disc(30, 40, 18).disc(75, 30, 16, (120, 160, 255)).disc(120, 55, 24)
    picture = seen(drawing.uyvy())
    found = checked(picture, mode)
    yellow = [number for number, blob in enumerate(picture.blobs) if blob[0] == YELLOW]
    assert len(picture.blobs) == 3
    assert found.words[:, 3].tolist() == yellow
    by_place = Circles(found.words[found.words[:, 0].argsort()], found.published)
    assert max(errors(by_place, (30, 40, 18), (120, 55, 24))) < 1.5


def lit_ball(x: float = 48, y: float = 48, radius: float = 24) -> Drawing:
    """A ball whose left side is lit, in ten steps of light, on grey ground that is darker than one side and brighter than the other."""
    drawing = Drawing(96, 96, (90, 90, 90))
    for step in range(10):
        rgb = tuple(round(level * (1 - 0.06 * step)) for level in (225, 170, 20))
        drawing.paint(
            lambda at_x, at_y, step=step: (
                (np.hypot(at_x - x, at_y - y) <= radius) & (at_x - x >= (step / 5 - 1) * radius)
            ),
            (rgb[0], rgb[1], rgb[2]),
        )
    return drawing


def golf_ball(dimples: int = 5) -> Seen:
    """A ball with dark spots all over, which are small: none reaches the outline."""
    drawing = Drawing(96, 96).disc(48, 48, 30)
    for row in range(-dimples, dimples + 1):
        for column in range(-dimples, dimples + 1):
            if np.hypot(5 * row, 5 * column) < 24:
                drawing.disc(48 + 5 * column, 48 + 5 * row, 1.3, (180, 133, 10))
    return seen(drawing.uyvy())


@pytest.mark.exhaustive
def test_filter_1_removes_the_edges_of_a_golf_ball() -> None:
    """Of its dimples hardly an edge is left, and the outline stays; without its colour they all come."""
    picture = golf_ball()
    outline = 2 * np.pi * 30
    assert len(picture.edges) > 1.7 * outline
    passed = checked(picture, FITTED_CIRCLES)
    assert passed.words[0, CIRCLE_EDGES] < 1.3 * outline
    centre, size = errors(passed, (48, 48, 30))
    assert max(centre, size) < 0.1
    uncoloured = replace(picture, opened=np.zeros_like(picture.opened))
    passed, clutter = (checked(each, PLAIN_CIRCLES) for each in (picture, uncoloured))
    assert clutter.words[0, CIRCLE_EDGES] > passed.words[0, CIRCLE_EDGES]
    assert clutter.words[0, CIRCLE_CENTRE] < passed.words[0, CIRCLE_CENTRE]


def test_filter_2_lets_pass_what_looks_at_the_ball_or_away_from_it() -> None:
    """A bright ball on dark ground, a dark one on bright ground, and one before a ground that is dark and bright by halves."""
    drawings = [
        Drawing(96, 96).disc(48, 48, 20),
        Drawing(96, 96, WHITE_RGB).disc(48, 48, 20, (150, 110, 10)),
        Drawing(96, 96).paint(lambda x, _y: x < 48, WHITE_RGB).disc(48, 48, 20),
    ]
    for drawing in drawings:
        centre, size = errors(checked(seen(drawing.uyvy()), FITTED_CIRCLES), (48, 48, 20))
        assert max(centre, size) < 0.2


def test_what_is_dark_and_far_from_the_colour_is_a_shadow() -> None:
    """On a bright floor, a grey ring 4 px wide round a ball of 20 px: its outer border is not the ball's, unless it may be."""
    ringed = seen(
        Drawing(96, 96, WHITE_RGB).disc(48, 48, 24, (90, 90, 90)).disc(48, 48, 20, (150, 110, 10)).uyvy()
    )
    anywhere = replace(FITTED_CIRCLES, beside_colour=False)
    for mode, radius in ((FITTED_CIRCLES, 20), (anywhere, 24)):
        assert max(errors(checked(ringed, mode), (48, 48, radius))) < 0.1


def test_what_most_edges_agree_on_is_a_circle() -> None:
    """A ball lit from one side: the votes are drawn to the light, and half of the edges on the outline say where it is.

    The share of them decides, from both sides.
    """
    ball = seen(lit_ball().uyvy())
    strict = replace(FITTED_CIRCLES, centre_share=255)
    centre, size = errors(checked(ball, strict), (48, 48, 24))
    assert max(centre, size) < 0.3
    assert checked(ball, replace(strict, consensus_share=256)).tests == [FAILED]


@pytest.mark.exhaustive
@pytest.mark.parametrize("lean", [0.0, 0.35, 0.785])
@pytest.mark.parametrize("sides", [(60, 9), (30, 20), (20, 20), (14, 14), (25, 10)])
def test_bars_and_squares_are_no_consensus(sides: tuple[int, int], lean: float) -> None:
    """Half of the edges that look at the middle lie on one circle, but not of all that the blob has."""
    bar = Drawing(160, 160).paint(
        lambda x, y: (
            (abs((x - 80) * np.cos(lean) + (y - 80) * np.sin(lean)) < sides[0])
            & (abs((y - 80) * np.cos(lean) - (x - 80) * np.sin(lean)) < sides[1])
        ),
        (225, 170, 20),
    )
    assert circles_of(seen(bar.uyvy()), replace(FITTED_CIRCLES, centre_share=255)).tests == [FAILED]


def test_the_centre_test_needs_lines_that_meet() -> None:
    """A disc passes T_c; a long bar has edges enough, but they look at its whole length."""
    disc, bar = (
        checked(seen(drawing.uyvy()), FITTED_CIRCLES)
        for drawing in (
            Drawing(96, 96).disc(48, 48, 20),
            Drawing(160, 96).paint(lambda x, y: (abs(x - 80) < 60) & (abs(y - 48) < 9), (225, 170, 20)),
        )
    )
    assert disc.tests == [PASSED]
    assert bar.words[0, CIRCLE_EDGES] >= FITTED_CIRCLES.min_edges
    assert bar.words[0, CIRCLE_CENTRE] < FITTED_CIRCLES.centre_share < disc.words[0, CIRCLE_CENTRE]
    assert bar.tests == [FAILED]
    assert bar.places[0] == pytest.approx([80, 48, 0], abs=0.6)  # the centre of mass


def test_the_centre_test_needs_edges() -> None:
    """The same disc, and one edge more asked for than it has."""
    picture = seen(Drawing(96, 96).disc(48, 48, 10).uyvy())
    edges = int(checked(picture, FITTED_CIRCLES).words[0, CIRCLE_EDGES])
    assert checked(picture, replace(FITTED_CIRCLES, min_edges=edges)).tests == [PASSED]
    assert checked(picture, replace(FITTED_CIRCLES, min_edges=edges + 1)).tests == [FAILED]


def test_the_radius_test_needs_one_distance() -> None:
    """A disc passes T_r; a four-pointed star has a centre, but its edges lie at all distances."""
    star = Drawing(96, 96).paint(
        lambda x, y: np.hypot(x - 48, y - 48) < 22 + 12 * np.cos(4 * np.arctan2(y - 48, x - 48)),
        (225, 170, 20),
    )
    wide = replace(FITTED_CIRCLES, angle_range=64, centre_share=20)
    disc, pointed = (checked(seen(each.uyvy()), wide) for each in (Drawing(96, 96).disc(48, 48, 20), star))
    assert disc.tests == [PASSED]
    assert pointed.tests == [CENTRE_ONLY]
    assert pointed.words[0, CIRCLE_RADIUS_SHARE] < wide.radius_share < disc.words[0, CIRCLE_RADIUS_SHARE]


def test_the_radius_test_needs_a_peak() -> None:
    """The same disc, and more edges asked for at its distance than it has."""
    picture = seen(Drawing(96, 96).disc(48, 48, 10).uyvy())
    edges = int(checked(picture, FITTED_CIRCLES).words[0, CIRCLE_EDGES])
    votes_alone = replace(FITTED_CIRCLES, consensus_share=256)
    assert checked(picture, replace(votes_alone, min_peak=edges + 1)).tests == [CENTRE_ONLY]
    assert checked(picture, replace(votes_alone, min_peak=edges // 2)).tests == [PASSED]


@BOTH
@pytest.mark.parametrize("edges", [0, 1, 2])
def test_hardly_an_edge(edges: int, mode: CircleThresholds) -> None:
    """Nothing passes by its number, nor by its share if one edge would be enough."""
    whole = seen(Drawing(64, 48).disc(30, 20, 12).uyvy())
    x, y, direction = whole.edges[0]
    counts = np.zeros(48, np.uint16)
    counts[y] = edges
    few = replace(
        whole,
        edge_data=np.array(
            [9 | direction << 8 | (x + each) << 16 for each in range(edges)] or [0], np.uint32
        ),
        edge_index=np.zeros(48, np.uint32),
        edge_counts=counts,
    )
    assert checked(few, mode).tests == [FAILED]
    checked(few, replace(mode, min_edges=0, min_peak=1))


def test_more_edges_than_have_room() -> None:
    """The first 3 x width are used, in the order of rows; the others are counted."""
    width, height = 40, 64
    whole = seen(Drawing(width, height).disc(20, 32, 15).uyvy())
    data = [9 | 64 << 8 | x << 16 for _ in range(height) for x in range(1, width - 1)]
    every = replace(
        whole,
        edge_data=np.array(data, np.uint32),
        edge_index=np.arange(height, dtype=np.uint32) * (width - 2),
        edge_counts=np.full(height, width - 2, np.uint16),
        opened=np.zeros_like(whole.opened),
    )
    found = checked(every, replace(FITTED_CIRCLES, angle_range=127, beside_colour=False))
    assert found.words[0, CIRCLE_EDGES] == 3 * width
    assert found.published["circle_edges_lost"] > 1000


def test_more_balls_than_have_room() -> None:
    """The first blobs get a circle, the others are counted."""
    whole = seen(Drawing(64, 48).disc(30, 20, 12).uyvy())
    (single,) = whole.expected(YELLOW, FITTED_CIRCLES)
    found = circles_of(replace(whole, blobs=whole.blobs * 100), FITTED_CIRCLES)
    assert found.words.tolist() == [[*single[:3], number, *single[4:]] for number in range(CIRCLE_CAPACITY)]
    assert found.published == {"circles": 64, "circles_lost": 36, "circle_edges_lost": 0}


@BOTH
@pytest.mark.parametrize("seed", range(3))
def test_pictures_of_chance(seed: int, mode: CircleThresholds) -> None:
    """Coloured squares with noise: blobs of any form, at all borders, many edges; bit-exact with lax thresholds."""
    picture = seen(random_uyvy(64, 48, seed), (YELLOW, 1 << 30), min_pixels=1)
    assert picture.blobs
    checked(picture, replace(mode, min_edges=1, centre_share=0, min_peak=0, radius_share=0))


@BOTH
def test_tiny_and_huge(mode: CircleThresholds) -> None:
    """A blob of a few pixels, and a ball larger than the picture, of which no outline is in it."""
    tiny = seen(Drawing(64, 48).disc(30, 20, 2.5).uyvy(), min_pixels=1)
    assert tiny.blobs
    checked(tiny, mode)
    assert checked(seen(Drawing(64, 48).disc(30, 20, 90).uyvy()), mode).tests == [FAILED]


def test_the_machine_finds_the_same() -> None:
    """Two pictures, one a core, through all stages: the records of the reference, and a time under the row."""
    pictures = [
        Drawing(160, 120).disc(60.3, 55.1, 20.6).uyvy(noise=2.0, seed=1),
        Drawing(160, 120).disc(20.0, 110.0, 31.0).disc(110, 40, 12).uyvy(noise=2.0, seed=2),
    ]
    for found, picture in zip(
        see([StereoFrame(0, *pictures, 0, 0, truth=None)], INDOOR_FIELD), pictures, strict=True
    ):
        focal_px = round(THESIS_FOCAL_PX * 160 / THESIS_WIDTH_PX)
        wanted = seen(picture).expected(INDOOR_FIELD.ball_colours, INDOOR_FIELD.circles, focal_px)
        assert found.words.tolist() == wanted
        assert found.results["circles"] == len(wanted)
        assert 0.1 < found.stages_ms["Shape detection"] < 10


def test_thresholds_that_cannot_be() -> None:
    """A patch larger than its memory, a peak larger than the patch, and sums beyond 32 bits."""
    with pytest.raises(ValueError, match=r"patch_reach must be peak_reach \(1\) to 32, not 33"):
        replace(FITTED_CIRCLES, patch_reach=33)
    with pytest.raises(ValueError, match=r"patch_reach must be peak_reach \(9\) to 32, not 8"):
        replace(FITTED_CIRCLES, peak_reach=9, patch_reach=8)
    with pytest.raises(ValueError, match="fit_range must be 1 to 4, not 5"):
        replace(FITTED_CIRCLES, fit_range=5)
