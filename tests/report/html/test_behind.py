"""What is done behind a run: in order, never too much of it, and what fails there is told."""

from __future__ import annotations

from io import BytesIO
from threading import Event

import numpy as np
import pytest
from PIL import Image

from bfsim.report.html.behind import MOST, Behind
from bfsim.report.html.shrinking import Shrinker


def fail() -> None:
    """Do not succeed."""
    raise ValueError("no room")


def test_all_is_done_in_order() -> None:
    """At `finish` at the latest."""
    done: list[int] = []
    with Behind() as behind:
        for number in range(20):
            behind.do(lambda number=number: done.append(number))  # type: ignore[misc]
        behind.finish()
        assert done == list(range(20))


def test_who_asks_for_too_much_waits() -> None:
    """What waits is kept in memory."""
    done, may_go_on = [], Event()
    with Behind() as behind:
        behind.do(lambda: may_go_on.wait(60) and None)
        for number in range(MOST - 1):
            behind.do(lambda number=number: done.append(number))  # type: ignore[misc]
        assert not done
        may_go_on.set()
        behind.do(lambda: None)
        behind.finish()
    assert done == list(range(MOST - 1))


def test_what_fails_is_told() -> None:
    """To whoever asks for more, or in the end; and nobody waits for the rest."""
    with pytest.raises(ValueError, match="no room"), Behind() as behind:
        behind.do(fail)
        behind.finish()
    with pytest.raises(ValueError, match="no room"), Behind() as behind:
        for _ in range(10 * MOST):
            behind.do(fail)


def noise(strength: int) -> Image.Image:
    """A picture, the more of it, the harder to make small."""
    levels = np.random.default_rng(strength).integers(0, strength + 1, (300, 700, 3))
    return Image.fromarray(levels.astype(np.uint8))


def test_a_picture_is_the_best_that_is_small_enough_whatever_came_before() -> None:
    """Of noise and of hardly any, in all orders: as if each were the first."""
    first = {strength: Shrinker(6_000).webp_of(noise(strength)) for strength in (0, 20, 60, 255)}
    assert len({Image.open(BytesIO(each)).size for each in first.values()}) > 1
    shrinker = Shrinker(6_000)
    for strength in (0, 255, 20, 60, 20, 255, 0, 60):
        assert shrinker.webp_of(noise(strength)) == first[strength]
