"""What the cycles of the stages depend on: lines on what is in the picture, the others hardly (T §6.6)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from benchmarks.quality.seen import Seen, see, see_recording
from bfsim.shipped import RECORDING
from tests.firmware.pictures import Bytes, grey_uyvy, random_uyvy, stripes
from tests.firmware.whole_pictures import stereo

pytestmark = pytest.mark.exhaustive

WIDTH, HEIGHT = 320, 240


@pytest.fixture(scope="module")
def shipped() -> list[Seen]:
    """The right picture of every frame of the built-in recording: core A's stages have the stereo in them, too."""
    return see_recording(RECORDING, 8)[1::2]


def covered() -> Bytes:
    """What a camera with its cap on sends: black and noise."""
    noise = np.random.default_rng(0).normal(16, 2, (HEIGHT, WIDTH))
    return grey_uyvy(noise.round().astype(np.uint8))


@pytest.fixture(scope="module")
def far_apart() -> list[Seen]:
    """Pictures as unlike as a camera can send them: dark, over-exposed, many lines, and coloured clutter all over."""
    pictures = (
        covered(),
        grey_uyvy(np.full((HEIGHT, WIDTH), 255)),
        stripes(12, 1, 0)(WIDTH, HEIGHT),
        random_uyvy(WIDTH, HEIGHT, seed=1),
    )
    return see(stereo(*((each, each) for each in pictures)))[1::2]


def ratio(seen: Sequence[Seen], stage: str) -> float:
    """Most by least cycles of a stage."""
    cycles = [each.stages_cclk[stage] for each in seen]
    return max(cycles) / min(cycles)


@pytest.mark.parametrize(
    ("stage", "most"), [("Edge detection", 1.01), ("Open & closing", 1.005), ("Blob detection", 1.05)]
)
def test_steady_stages_over_the_built_in_recording(shipped: list[Seen], stage: str, most: float) -> None:
    """From frame to frame they differ by 0.4, 0.2 and 1.6 percent."""
    assert ratio(shipped, stage) < most


@pytest.mark.parametrize(("stage", "most"), [("Edge detection", 1.5), ("Open & closing", 1.005)])
def test_steady_stages_between_nothing_and_clutter(far_apart: list[Seen], stage: str, most: float) -> None:
    """They differ by 46 and 0 percent: flat and grey pixels are spared the divisions for direction and hue."""
    assert ratio(far_apart, stage) < most


def test_blobs_of_clutter_cost_as_much_as_they_ever_did(far_apart: list[Seen]) -> None:
    """50 cycles a pixel, and 10 in a black picture, whose pixels have a loop of their own: both cost no more than without that, 53 and 16."""
    dark, white, _, clutter = (each.stages_cclk["Blob detection"] / (WIDTH * HEIGHT) for each in far_apart)
    assert max(dark, white) < 16
    assert clutter < 53


def test_lines_depend_on_the_picture(shipped: list[Seen], far_apart: list[Seen]) -> None:
    """An empty picture costs little but to look at its rows; field, stripes and clutter over thirty times as much."""
    dark, white, lines, clutter = (each.stages_cclk["Line detection"] for each in far_apart)
    field = min(each.stages_cclk["Line detection"] for each in shipped)
    assert dark == white
    assert field > 30 * white
    assert min(lines, clutter) > 30 * white
    assert ratio(shipped, "Line detection") > 1.05
