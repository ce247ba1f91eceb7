"""3-D lines: bit for bit against the reference, and what must and must not correspond."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.seen_stereo import see_stereo
from bfsim.api import Calibration
from bfsim.recording import RecordingReader
from bfsim.shipped import RECORDING
from tests.firmware.stereo import stereo_references as references
from tests.firmware.stereo.stereo_edge_references import partners_of
from tests.firmware.stereo.stereo_edge_rig import limits_of, rows_of
from tests.firmware.stereo.stereo_references import Line3D, Rig, Words
from tests.firmware.whole_pictures import buffer, run
from tinyphoon.arithmetic import angle8
from tinyphoon.geometry import GEOMETRY_WORDS, disparity_at
from tinyphoon.stages.line_correspondence import line_slopes
from tinyphoon.stages.stereo_lines import Correspondence, StereoLineThresholds, mutual_lines, nearest_lines
from tinyphoon.stores.lines import LINE_WORDS
from tinyphoon.stores.lines3d import LINE3D_WORDS
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.tables import arctangent_table

GARBAGE = 77
ATAN = arctangent_table()
ROBOT = Rig(focal=386 * 16, baseline=30470, width=320, height=240)
MODE = INDOOR_FIELD.stereo_lines


def line(x0: float, y0: float, x1: float, y1: float) -> list[int]:
    """A t_Line from start to end, in pixels."""
    ends = [round(16 * each) for each in (x0, y0, x1, y1)]
    return [*ends, angle8(ends[2] - ends[0], ends[3] - ends[1], ATAN), 20, 255, 0, 0]


def found(
    left: Sequence[Words], right: Sequence[Words], mode: StereoLineThresholds = MODE, rig: Rig = ROBOT
) -> list[Line3D]:
    """What the kernels make of lines."""
    tables, slopes = [], []
    for lines in (left, right):
        table = np.array([*lines, [GARBAGE] * LINE_WORDS], np.int16).ravel()
        slope = np.full(len(lines) + 1, GARBAGE, np.int32)
        line_slopes(table, len(lines), slope, mode.min_rise)
        tables.append(table)
        slopes.append(slope)
    geometry = np.array([rig.focal, rig.baseline, *[0] * (GEOMETRY_WORDS - 2)], np.int32)
    lines_3d = np.full((len(left) + 1) * LINE3D_WORDS, GARBAGE, np.int16)
    pictures = tables[0], slopes[0], len(left), tables[1], slopes[1], len(right)
    if mode.correspondence is Correspondence.NEAREST:
        count = nearest_lines(geometry, *pictures, mode.angle_range, rig.width, rig.height, lines_3d)
    else:
        disparities = (disparity_at(geometry, depth) for depth in (mode.farthest_mm, mode.nearest_mm))
        limits = mode.angle_range, *disparities, mode.min_common
        count = mutual_lines(geometry, *pictures, *limits, rig.width, rig.height, lines_3d)
    return [tuple(each) for each in lines_3d.reshape(-1, LINE3D_WORDS)[:count].tolist()]


def expected(
    left: Sequence[Words], right: Sequence[Words], mode: StereoLineThresholds = MODE, rig: Rig = ROBOT
) -> list[Line3D]:
    """What the reference makes of them."""
    result = []
    limits = mode.angle_range, mode.min_rise
    common = (rig.disparity(mode.farthest_mm), rig.disparity(mode.nearest_mm)), mode.min_common
    for number, each in enumerate(left):
        if references.is_level(each, mode.min_rise):
            continue
        if mode.correspondence is Correspondence.NEAREST:
            other = references.nearest(each, right, *limits)
        else:
            other = references.best(each, right, 1, *limits, *common)
            if other is not None and references.best(right[other], left, -1, *limits, *common) != number:
                other = None
        ends = None if other is None else references.line_3d(rig, each, right[other])
        if ends is not None:
            result.append((*ends[0], *ends[1], number, other))
    return result


points = st.tuples(st.integers(0, 16 * 640), st.integers(0, 16 * 480))
any_line = st.tuples(points, points, st.integers(0, 255)).map(
    lambda each: [*each[0], *each[1], each[2], 9, 9, 9, 9]
)


@st.composite
def seen_from_the_right(draw: st.DrawFn, left: Sequence[Words]) -> list[Words]:
    """The left lines as another camera may see them: moved, cut and turned a little, and some of its own."""
    lines = [
        [
            each[0] - draw(st.integers(-100, 900)),
            each[1] + draw(st.integers(-60, 60)),
            each[2] - draw(st.integers(-100, 900)),
            each[3] + draw(st.integers(-60, 60)),
            (each[4] + draw(st.integers(-10, 10))) % 256,
            *each[5:],
        ]
        for each in left
    ]
    return [*draw(st.permutations(lines)), *draw(st.lists(any_line, max_size=3))]


@pytest.mark.exhaustive
@settings(max_examples=200)
@given(st.data(), st.sampled_from(Correspondence))
def test_any_lines(data: st.DataObject, correspondence: Correspondence) -> None:
    """Both ways of choosing, over pictures of 640x480 and all thresholds."""
    left = data.draw(st.lists(any_line, max_size=6))
    right = data.draw(seen_from_the_right(left))
    nearest = data.draw(st.integers(1, 2000))
    mode = StereoLineThresholds(
        correspondence=correspondence,
        angle_range=data.draw(st.integers(0, 30)),
        min_rise=data.draw(st.integers(16, 300)),
        nearest_mm=nearest,
        farthest_mm=nearest + data.draw(st.integers(0, 30000)),
        min_common=data.draw(st.integers(0, 256)),
        edge_range=0,
    )
    rig = Rig(
        focal=data.draw(st.integers(1000, 20000)),
        baseline=data.draw(st.integers(1000, 100000)),
        width=640,
        height=480,
    )
    assert found(left, right, mode, rig) == expected(left, right, mode, rig)


BOTH = [replace(MODE, correspondence=each) for each in Correspondence]


@pytest.mark.parametrize("mode", BOTH)
def test_upright_line_in_closed_form(mode: StereoLineThresholds) -> None:
    """20 pixels to the left in the right picture: 386 * 30.47 / 20 = 588 mm; ends as far off as the picture shows."""
    assert found([line(200, 60, 200, 180)], [line(180, 60, 180, 180)], mode) == [
        (62, -91, 588, 62, 92, 588, 0, 0)
    ]


@pytest.mark.parametrize("mode", BOTH)
def test_line_that_goes_away(mode: StereoLineThresholds) -> None:
    """The disparity of each end is its own: 60 pixels near the robot, 12 far from it."""
    (near_to_far,) = found(
        [line(170, 220, 160, 130)], [line(110, 220, 148, 130)], replace(mode, angle_range=40)
    )
    assert (near_to_far[2], near_to_far[5]) == (196, 980)


@pytest.mark.parametrize("mode", BOTH)
def test_the_other_line_is_continued(mode: StereoLineThresholds) -> None:
    """Of the right line the lower third is missing; both ends of the left one have their depth all the same."""
    (whole,) = found([line(200, 60, 206, 180)], [line(180, 60, 184, 140)], mode)
    assert (whole[2], whole[5]) == (588, 588)


@pytest.mark.parametrize("mode", BOTH)
@pytest.mark.parametrize(
    "other",
    [
        line(180, 180, 180, 60),  # the dark side is the other one
        line(180, 60, 230, 180),  # another angle
        line(180, 10, 180, 50),  # in other rows
        line(220, 60, 220, 180),  # nothing is behind infinity
    ],
)
def test_pairs_that_must_not_match(mode: StereoLineThresholds, other: Words) -> None:
    """Neither way takes them."""
    assert found([line(200, 60, 200, 180)], [other], mode) == []


@pytest.mark.parametrize("mode", BOTH)
def test_nearly_horizontal_lines_are_left_out(mode: StereoLineThresholds) -> None:
    """Rows say nothing about them, on either side."""
    flat, steep = line(100, 100, 200, 120), line(100, 100, 120, 200)
    assert found([flat], [line(80, 100, 180, 120)], mode) == []
    assert found([steep], [line(80, 100, 100, 200)], mode) != []


def test_the_nearest_may_be_the_wrong_one_and_the_mutual_one_is_not() -> None:
    """A long line and a short one, 30 px apart in both pictures: the right picture's short one has come to where the
    left picture's long one is. The nearest makes nothing of the long line and puts the short one 6 m away."""
    left = [line(150, 60, 150, 180), line(180, 80, 180, 160)]
    right = [line(178, 60, 178, 180), line(120, 60, 120, 180), line(150, 80, 150, 160)]
    assert [each[6:] for each in found(left, right, BOTH[Correspondence.NEAREST])] == [(1, 0)]
    assert [each[6:] for each in found(left, right, BOTH[Correspondence.MUTUAL])] == [(0, 1), (1, 2)]


def test_a_line_belongs_to_one_line_only() -> None:
    """Where the right camera sees one line less, only the one that agrees better has depth."""
    left = [line(200, 60, 200, 150), line(230, 60, 230, 180)]
    assert [each[6:] for each in found(left, [line(190, 60, 190, 180)])] == [(1, 0)]


def test_a_rise_that_32_bits_cannot_hold_is_refused() -> None:
    """The slope of the flattest line must go into a word."""
    with pytest.raises(ValueError, match="min_rise must be 16 or more, not 15"):
        replace(MODE, min_rise=15)


@pytest.mark.parametrize(("disparity_px", "number"), [(2, 0), (3, 1), (29, 1), (30, 0)])
def test_lines_out_of_the_range(disparity_px: int, number: int) -> None:
    """The range is in mm, known to a sixteenth of a pixel: 30 px are 392 mm, 2 px 5881 mm."""
    mode = replace(MODE, nearest_mm=393, farthest_mm=5700)
    right = line(200 - disparity_px, 60, 200 - disparity_px, 180)
    assert len(found([line(200, 60, 200, 180)], [right], mode)) == number


def test_depths_that_contradict_each_other_are_refused() -> None:
    """The nearest must not be farther than the farthest."""
    with pytest.raises(ValueError, match="depths must be 1 mm or more and rise, not 11 to 10"):
        replace(MODE, nearest_mm=11, farthest_mm=10)


@pytest.mark.exhaustive
@pytest.mark.parametrize("mode", BOTH)
def test_rendered_lines(mode: StereoLineThresholds) -> None:
    """On the board: the 3-D lines of a rendered scene are those of the lines that both cores left."""
    with RecordingReader(RECORDING) as reader:
        frames = list(reader.frames(2))
    board, outcome = run(frames)
    results = dict(outcome.frames[-1].results)
    lines = [
        buffer(board, core, name)[0, : LINE_WORDS * results[f"lines_{core}"]].reshape(-1, LINE_WORDS).tolist()
        for core, name in (("A", "lines"), ("B", "lines"))
    ]
    every = expected(*lines, mode)
    assert found(*lines, mode) == every
    edges = [rows_of(board, core) for core in ("A", "B")]
    partners = partners_of(ROBOT, *edges, limits_of(INDOOR_FIELD.stereo_edges))
    wanted = references.elected(every, *lines, partners, mode.edge_range)
    assert len(wanted) > 3
    (seen,) = see_stereo(
        [replace(frames[-1], index=0)], Calibration(), replace(INDOOR_FIELD, stereo_lines=mode)
    )
    assert seen.lines_mm.reshape(-1, 6).tolist() == [list(each[:6]) for each in wanted]
    if mode == MODE:
        assert results["lines_3d_A"] == len(wanted)
        words = buffer(board, "A", "lines_3d")[0, : LINE3D_WORDS * len(wanted)]
        assert words.reshape(-1, LINE3D_WORDS).tolist() == [list(each) for each in wanted]
