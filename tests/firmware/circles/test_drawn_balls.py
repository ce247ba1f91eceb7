"""Balls in any light, drawn by formulas: the circle detection measures their radius without bias."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.ball_radii import CONDITIONS, errors_of
from benchmarks.drawn.balls import Ball, Condition, frame_of, picture_of

MEASURED = [each for each in CONDITIONS if each.name != "between two hues, noisy"]
"""A ball whose hue is between two falls to pieces in the opening, before its circle is looked for."""

IN_EVERY_RUN = ("bright ball", "ambient of a tenth")
"""Of 24 lights, those that say most; the others are as many whole frames. In the second one the shaded half has no outline."""


@pytest.mark.parametrize(
    "condition",
    [
        pytest.param(each, id=each.name, marks=() if each.name in IN_EVERY_RUN else pytest.mark.exhaustive)
        for each in MEASURED
    ],
)
def test_radii_have_no_bias(condition: Condition) -> None:
    """Bright and dark, sharp and blurred, lit from all sides, on textured floors with shadows: 0.3 px in the mean of twelve."""
    errors = errors_of(condition, frames=1)
    assert errors.found.sum() >= 9
    assert abs(errors.off[errors.found, 2].mean()) < 0.3


@pytest.mark.parametrize("blur", [0.7, 1.5])
def test_blur_makes_no_small_ball_smaller(blur: float) -> None:
    """Of 4 to 7 px, to a twentieth of a pixel in the mean of twelve: their outlines bend, and lie further in as blur mixes them."""
    errors = errors_of(Condition("blurred", blur=blur), frames=1, radii_px=(4, 7))
    assert errors.found.all()
    assert abs(errors.off[:, 2].mean()) < 0.05


def test_a_drawn_ball_is_as_large_as_it_is_said_to_be() -> None:
    """The area of a bright disc on black, blurred or not, is that of its radius; its middle is where it was put."""
    for blur in (0.0, 2.0):
        lamp = Condition("lamp", ball=(200, 200, 200), floor=(0, 0, 0), blur=blur, noise=0.0)
        luma = np.asarray(picture_of([Ball(60.3, 50.7, 12.4)], lamp, seed=0), float)[:, :, 0]
        rows, columns = np.indices(luma.shape)
        assert (luma.sum() / 200 / np.pi) ** 0.5 == pytest.approx(12.4, abs=0.02)
        assert (luma * columns).sum() / luma.sum() == pytest.approx(60.3, abs=0.02)
        assert (luma * rows).sum() / luma.sum() == pytest.approx(50.7, abs=0.02)


def test_a_drawn_ball_is_the_image_of_a_sphere() -> None:
    """In the corner of the picture an ellipse that is longer along the way to the middle, as the tangents of a sphere are."""
    ball = Ball(280.0, 200.0, 38.0)
    lamp = Condition("lamp", ball=(200, 200, 200), floor=(0, 0, 0), blur=0.0, noise=0.0)
    luma = np.asarray(picture_of([ball], lamp, seed=0), float)[:, :, 0]
    rows, columns = np.indices(luma.shape)
    places = np.array([columns.ravel() - ball.x, rows.ravel() - ball.y])
    lengths, ways = np.linalg.eigh(np.cov(places, aweights=luma.ravel(), bias=True))
    short, long = 2 * np.sqrt(lengths)
    outwards = np.array([280 - 159.5, 200 - 119.5])
    off = np.hypot(*outwards)
    assert (short + long) / 2 == pytest.approx(38, abs=0.02)
    assert abs(ways[:, 1] @ outwards) == pytest.approx(off, rel=1e-3)
    # the nearest and the farthest ray that touch the sphere are as many degrees to either side of its middle
    near, far = (np.arctan((off + side * long) / 386) for side in (-1, 1))
    wide = (far - near) / 2
    aside = (far + near) / 2
    across = 386 * np.sin(wide) / np.sqrt(np.cos(aside) ** 2 - np.sin(wide) ** 2)
    assert short == pytest.approx(across, abs=0.03)


@pytest.mark.exhaustive
def test_the_same_numbers_draw_the_same_frame() -> None:
    """And each camera has balls of its own."""
    one, other = (frame_of(CONDITIONS[0], 4, 40, 3) for _ in range(2))
    assert (one.left == other.left).all()
    assert one.truth == other.truth
    assert (one.left != one.right).any()
