"""Rectification: kernel and stage, bit for bit against numpy, and how far one table is from four weighted ones."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from bfsim.api import Calibration, FirmwareError, SourcePixels
from bfsim.recording import RecordingReader
from bfsim.shipped import RECORDING
from tests.firmware.lenses import bilinear, nearest, rectified, sighted, source_points
from tests.firmware.pictures import random_uyvy
from tests.firmware.whole_pictures import buffer, check_core, random_frames, run
from tests.tiers import exhaustive
from tinyphoon import tinyphoon
from tinyphoon.stages.rectification import (
    BLACK_PAIR,
    places_in_window,
    rectification_buffers,
    rectify_row,
    window_lines,
)

GARBAGE = 170
CAMERA = {"barrel": 0.06, "turn_deg": 1.0, "down_px": 2.5}
"""A wide lens in a camera that sits a little askew."""


def play(uyvy: np.ndarray, sources: SourcePixels) -> np.ndarray:
    """Rectify row after row, with a window that forgets every line as soon as it may."""
    height, width = sources.rows.shape
    depth = window_lines(sources.rows)
    places = places_in_window(sources, depth).astype(np.uint16)
    lines = np.full((depth, 2 * width), GARBAGE, np.uint8)
    result = np.full_like(uyvy, GARBAGE)
    came = 0
    for y in range(height):
        while came <= sources.rows[: y + 1].max():
            lines[came % depth] = uyvy[came]
            lines[(came + 1) % depth] = GARBAGE  # the next one is on its way
            came += 1
        rectify_row(np.append(lines.ravel(), np.array(BLACK_PAIR, np.uint8)), places[y], result[y])
    return result


@settings(max_examples=50)
@given(st.data())
def test_any_table(data: st.DataObject) -> None:
    """Pixels from anywhere and from nowhere, in any order."""
    height, width = data.draw(st.integers(1, 6)), 2 * data.draw(st.integers(1, 6))
    rows = data.draw(arrays(np.int32, (height, width), elements=st.integers(-1, height - 1)))
    columns = data.draw(arrays(np.int32, (height, width), elements=st.integers(0, width - 1)))
    sources = SourcePixels(rows, np.where(rows < 0, -1, columns))
    uyvy = random_uyvy(width, height, seed=height)
    np.testing.assert_array_equal(play(uyvy, sources), rectified(uyvy, sources))


@pytest.mark.parametrize(("width", "height"), [(6, 5), (62, 33), (160, 121)])
def test_cameras(width: int, height: int) -> None:
    """A window as deep as the table needs, and no deeper than an upright camera's."""
    sources = nearest(*source_points(width, height, **CAMERA))
    uyvy = random_uyvy(width, height, seed=1)
    np.testing.assert_array_equal(play(uyvy, sources), rectified(uyvy, sources))


def test_window_is_as_deep_as_the_lines_of_a_row_and_one_more() -> None:
    """An identity needs the line itself and the one that comes; a row that reaches over five lines needs six."""
    rows = np.repeat(np.arange(8, dtype=np.int32)[:, None], 4, axis=1)
    assert window_lines(rows) == 2
    rows[3, 1] = 7
    assert window_lines(rows) == 6
    assert window_lines(np.full_like(rows, -1)) == 2


def test_table_that_needs_too_many_lines_is_refused() -> None:
    """Places have 16 bits; a table that is upside down needs the whole picture at once."""
    rows = np.repeat(np.arange(480, dtype=np.int32)[::-1, None], 640, axis=1)
    columns = np.repeat(np.arange(640, dtype=np.int32)[None], 480, axis=0)
    with pytest.raises(
        FirmwareError, match="core B must not need more than 101 camera lines at once, but needs 481"
    ):
        rectification_buffers({"B": SourcePixels(rows, columns)})


def tables(width: int, height: int) -> Mapping[str, SourcePixels]:
    """Tables of two cameras that are not mounted alike."""
    return {
        "A": nearest(*source_points(width, height, **CAMERA)),
        "B": nearest(*source_points(width, height, barrel=0.03, turn_deg=-0.7, down_px=-3)),
    }


@pytest.mark.parametrize(("width", "height"), [(6, 4), (34, 50), *exhaustive((160, 121), (640, 16))])
def test_stages_see_the_rectified_picture(width: int, height: int) -> None:
    """On the board both cores rectify by their own tables, and all that follows is of the rectified pictures."""
    frames = random_frames(width, height, count=2)
    sources = tables(width, height)
    board, outcome = run(frames, tinyphoon.calibrated(Calibration(sources=sources)))
    results = dict(outcome.frames[-1].results)
    for core, uyvy in (("A", frames[-1].left), ("B", frames[-1].right)):
        expected = rectified(uyvy, sources[core])
        np.testing.assert_array_equal(buffer(board, core, "rectified_image"), expected)
        check_core(board, core, expected, results, sighted(sources[core]))


@pytest.mark.parametrize(("width", "height"), [(320, 240), *exhaustive((640, 480))])
def test_rectification_needs_few_cycles(width: int, height: int) -> None:
    """It has a row of its own, and its window never lies in SDRAM: where L1 is full, the LDF has it spill to L2."""
    frames = random_frames(width, height, count=1)
    board, outcome = run(frames, tinyphoon.calibrated(Calibration(sources=tables(width, height))))
    assert board.cores["A"].array("camera_window").memory in {"COREA_L1_DATA_A", "COREA_L1_DATA_B", "L2"}
    costs = {each.stage: each.elapsed_cclk for each in outcome.frames[0].cores[0].stages}
    assert width * height < costs["Rectification"] < 0.1 * costs["Edge detection"]


def test_one_table_is_two_grey_levels_from_four_weighted_ones() -> None:
    """The luma of the built-in recording's first picture: mean absolute difference between the nearest pixel and the bilinear one."""
    with RecordingReader(RECORDING) as reader:
        (frame,) = reader.frames(1)
        rows, columns = source_points(reader.width, reader.height, **CAMERA)
    sources = nearest(rows, columns)
    found = rectified(frame.left, sources)[:, 1::2]
    weighted = bilinear(frame.left[:, 1::2].astype(float), rows, columns)
    difference = abs(found - weighted)[sources.rows >= 0].mean()
    assert difference == pytest.approx(2.28, abs=0.01)
