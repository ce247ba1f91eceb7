"""The refinement of lines: bit for bit against the reference, and how near it comes to the truth."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Frame
from tests.firmware.lines import refinement_references as references
from tests.firmware.lines.line_rig import BareCore, edges_of, find_lines
from tests.tiers import exhaustive
from tinyphoon.stages.line_refinement import RefinementThresholds, line_refinement
from tinyphoon.stages.line_segments import SEGMENT_WORDS
from tinyphoon.stores.lines import LINE_WORDS
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.tables import arctangent_table

GARBAGE = 77
REACH, MIN_STEP = INDOOR_FIELD.refinement.reach, INDOOR_FIELD.refinement.min_step


class PictureCore(BareCore):
    """Has the lines of a picture for a ring, too."""

    def input_ring(self, rows: np.ndarray, name: str) -> PictureCore:
        """The ring of these lines, of which there is at least one."""
        assert len(rows)
        self.coming = iter(rows)
        return self

    def line(self) -> Generator[Any, Any, np.ndarray]:
        """The next line; there must be one."""
        return next(self.coming)
        yield


def refined(
    lines: Sequence[Sequence[int]], picture: np.ndarray, reach: int = REACH, min_step: int = MIN_STEP
) -> tuple[list[list[int]], int]:
    """What the stage makes of lines in a grey picture."""
    height, width = picture.shape
    uyvy = np.full((height, 2 * width), GARBAGE, np.uint8)
    uyvy[:, 1::2] = picture
    core = PictureCore(
        {
            "lines": [np.array(lines or [[0] * LINE_WORDS], np.int16).reshape(-1)],
            "segments": [np.full(max(len(lines), 1) * SEGMENT_WORDS, GARBAGE, np.int32)],
            "atan": [arctangent_table()],
        }
    )
    thresholds = RefinementThresholds(reach=reach, min_step=min_step)
    core.play(line_refinement(core, Frame(0, uyvy, width, height), len(lines), thresholds))
    table = core.array("lines").reshape(-1, LINE_WORDS)
    return table[: len(lines)].tolist(), core.published["lines_refined"]


@settings(max_examples=60)
@given(
    st.integers(2, 40),
    st.integers(2, 60),
    st.integers(0, 1 << 30),
    st.integers(1, 5),
    st.integers(1, 60),
    st.data(),
)
def test_any_lines_in_any_picture(
    width: int, height: int, seed: int, reach: int, min_step: int, data: st.DataObject
) -> None:
    """Steps here and there, lines anywhere, also beyond the border."""
    rng = np.random.default_rng(seed)
    picture = np.cumsum(rng.integers(-40, 41, (height, width)), axis=1).clip(0, 255).astype(np.uint8)
    xs, ys = st.integers(-40, 16 * width + 20), st.integers(-160, 16 * height + 160)
    lines = data.draw(st.lists(st.tuples(xs, ys, xs, ys, *[st.integers(0, 255)] * 5), max_size=4))
    assert refined(lines, picture, reach, min_step) == references.refined(lines, picture, reach, min_step)


def leaning(
    column: float, lean: float, height: int = 100, width: int = 80, dark: int = 60, bright: int = 180
) -> np.ndarray:
    """A picture that becomes bright at `column` in its middle row, and farther right by `lean` with each row below.

    Pixels are squares, so those on the edge have a share of both.
    """
    fine = 16
    x = (np.arange(width * fine) + 0.5) / fine - 0.5
    y = (np.arange(height * fine) + 0.5) / fine - 0.5
    is_bright = x > column + lean * (y[:, None] - (height - 1) / 2)
    share = is_bright.reshape(height, fine, width, fine).mean(axis=(1, 3))
    return np.rint(dark + (bright - dark) * share).astype(np.uint8)


def off_px(picture: np.ndarray, column: float, lean: float, *, is_refined: bool) -> float:
    """How far the farther end of the only line is beside the edge."""
    (line,) = find_lines(edges_of(picture), picture.shape[1]).lines.tolist()
    if is_refined:
        ((line,), _) = refined([line], picture)
    middle = (len(picture) - 1) / 2
    return max(
        abs(x / 16 - column - lean * (y / 16 - middle)) for x, y in (line[0:2], line[2:4])
    )  # fmt: skip


@pytest.mark.parametrize("contrast", [(60, 180), *exhaustive(((180, 60),), ((100, 125),))])
@pytest.mark.parametrize("lean", [0.0, 0.013, -0.11, 0.4])
def test_edges_anywhere_in_a_pixel(lean: float, contrast: tuple[int, int]) -> None:
    """To a sixteenth of a pixel and the rounding of both ends, wherever in its pixel the edge is."""
    dark, bright = contrast
    columns = 40 + np.arange(16) / 16
    pictures = [leaning(each, lean, dark=dark, bright=bright) for each in columns]
    pairs = list(zip(pictures, columns, strict=True))
    assert max(off_px(*each, lean, is_refined=True) for each in pairs) < 0.13
    if lean == 0:
        assert max(off_px(*each, lean, is_refined=False) for each in pairs) > 0.4


def test_ends_stay_in_their_rows() -> None:
    """Lines move to the side only: their rows say how long they are."""
    picture = leaning(40.3, 0.013)
    (before,) = find_lines(edges_of(picture), 80).lines.tolist()
    ((after,), moved) = refined([before], picture)
    assert moved == 1
    assert (after[1], after[3], after[5:7]) == (before[1], before[3], before[5:7])


UPRIGHT = [640, 80, 640, 1440, 64, 85, 255, 0, 0]
"""Downwards in column 40, dark on the left of it on the picture: bright to the right."""


@pytest.mark.parametrize(
    ("line", "picture"),
    [
        ([160, 800, 1120, 800, 0, 60, 255, 0, 0], leaning(40, 0)),  # level
        ([160, 700, 1120, 800, 0, 60, 255, 0, 0], leaning(40, 0)),  # nearly
        (UPRIGHT, leaning(40, 0, dark=180, bright=60)),  # the bright side is the other one
        (UPRIGHT, leaning(40, 0, dark=100, bright=103)),  # a step as small as the noise
        (UPRIGHT, leaning(42.6, 0)),  # farther away than a line can be wrong
        ([640, 80, 640, 160, 64, 6, 255, 0, 0], leaning(40, 0)),  # too short
    ],
)
def test_lines_that_stay(line: list[int], picture: np.ndarray) -> None:
    """What is seen beside them is not theirs, or says nothing."""
    assert refined([line], picture) == ([line], 0)


def test_a_line_half_covered() -> None:
    """An edge in fewer than half of the rows moves no line; in more, it does."""
    picture = leaning(40.25, 0)
    covered = picture.copy()
    covered[:45] = 99
    assert refined([UPRIGHT], covered)[1] == 1
    covered[:60] = 99
    assert refined([UPRIGHT], covered)[1] == 0
