"""Open & closing on the simulated machine: each order of operations, by the plain, the fast and the thesis's steps."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.api import Core, Firmware
from tests.firmware.references import Picture, closed, opened
from tests.firmware.whole_pictures import buffer, run, stereo
from tinyphoon import fast, thesis, tinyphoon
from tinyphoon.features import PLAIN, Steps
from tinyphoon.stages.open_closing import NoiseOrder, NoiseRemoval
from tinyphoon.variants import FAST, THESIS

WANTED = {
    NoiseOrder.OPENING: opened,
    NoiseOrder.CLOSING: closed,
    NoiseOrder.CLOSING_OPENING: lambda picture: opened(closed(picture)),
    NoiseOrder.OPENING_CLOSING: lambda picture: closed(opened(picture)),
}


def removed(colours: Picture, order: NoiseOrder, firmware: Firmware, steps: Steps) -> Picture:
    """What the stage makes of a colour image on core A."""
    height, width = colours.shape

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            for row, words in zip(core.rows("colour_image"), colours, strict=True):
                row.array[:] = words
            with core.stage("Open & closing"):
                yield from steps.open_closing(core, frame, NoiseRemoval(order=order))

    blank = np.zeros((height, 2 * width), np.uint8)
    board, _ = run(stereo((blank, blank)), replace(firmware, mains={"A": main, "B": main}))
    return buffer(board, "A", "opened_image")


@pytest.mark.parametrize("order", NoiseOrder)
@pytest.mark.parametrize(
    ("firmware", "steps"),
    [(tinyphoon, PLAIN), (fast, FAST), (thesis, THESIS)],
    ids=["plain", "fast", "thesis"],
)
def test_each_order(order: NoiseOrder, firmware: Firmware, steps: Steps) -> None:
    """Blotches of three colours with noise in them and around them, bit for bit."""
    rng = np.random.default_rng(17)
    blotches = np.kron(rng.integers(0, 3, (5, 7)), np.ones((5, 6), int))
    noisy = np.where(rng.random(blotches.shape) < 0.1, rng.integers(0, 3, blotches.shape), blotches)
    colours = np.array([0, 1 << 4, 1 << 20 | 1 << 21], np.uint32)[noisy]
    np.testing.assert_array_equal(removed(colours, order, firmware, steps), WANTED[order](colours))


def picture_with(value: int) -> Picture:
    """A picture all of the other value, but for one pixel."""
    picture = np.full((9, 12), 1 - value, np.uint32)
    picture[4, 5] = value
    return picture


def test_what_each_operation_is_for() -> None:
    """An opening removes a single pixel, a closing fills a single gap and stays off the border (T §2.3.1)."""
    assert not opened(picture_with(1)).any()
    assert closed(picture_with(0))[:, 1:-1].all()
    assert closed(picture_with(1))[4, 5] == 1
    assert opened(picture_with(0))[4, 5] == 0


@given(st.integers(0, 2**32 - 1))
def test_to_repeat_an_operation_changes_nothing(seed: int) -> None:
    """So the thesis's "multiple times" is not offered."""
    picture = np.random.default_rng(seed).integers(0, 8, (9, 20), np.uint32)
    for operation in (opened, closed):
        once = operation(picture)
        np.testing.assert_array_equal(operation(once)[:, 4:-4], once[:, 4:-4])
