"""The steps that the thesis describes leave what the built-in ones leave; its scan for lines is another one."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bfsim.api import Calibration, Core, Firmware, FrameSize
from bfsim.machine.board import Board
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.shipped import RECORDING
from tests.firmware.lenses import nearest, source_points
from tests.firmware.pictures import EXTREMES, grey_uyvy
from tests.firmware.whole_pictures import buffer, random_frames, run, stereo
from tests.tiers import exhaustive
from tinyphoon import thesis, tinyphoon
from tinyphoon.areas import WHOLE_PICTURE
from tinyphoon.features import PLAIN, Steps
from tinyphoon.stages.circle_erosion import has_ball_form
from tinyphoon.stages.colour_reduction import join_groups
from tinyphoon.stages.line_ends import continued_line
from tinyphoon.stages.line_segments import (
    DIRECTION,
    EDGES,
    END_X,
    END_Y,
    NONE,
    SEGMENT_WORDS,
    START_X,
    START_Y,
    TURN,
)
from tinyphoon.stages.rosenfeld_blobs import label_row, met, rename_and_count_row
from tinyphoon.stages.sdram_rectification import move_row, untouched
from tinyphoon.stages.strong_gradients import direct_strong_row
from tinyphoon.stores.blobs import ACROSS, BLOB_WORDS, COLOURS, DOWN, PIXELS, pair
from tinyphoon.stores.circles import CIRCLE_BLOB, CIRCLE_WORDS
from tinyphoon.stores.edges import EDGE_DATA
from tinyphoon.strategy.models import BLUE, MODELS, YELLOW, model_words
from tinyphoon.strategy.modes import THESIS_FIELD
from tinyphoon.tables import arctangent_table
from tinyphoon.variants import THESIS

SAME = ("edges", "edges_lost", "edge_groups_shared", "blobs", "blobs_lost", "labels_lost", "circles")
MODE = THESIS_FIELD
RECTIFIED = Calibration()


def left_by(board: Board, core: str, counts: dict[str, int]) -> list[list[int]]:
    """Edges, colours and blobs of a core."""
    edges = buffer(board, core, EDGE_DATA[core])[0, : counts[f"edges_{core}"]]
    blobs = buffer(board, core, "blob_data")[0, : counts[f"blobs_{core}"] * BLOB_WORDS]
    pictures = (buffer(board, core, name).ravel() for name in ("edge_image", "opened_image"))
    rows = (buffer(board, core, name)[0] for name in ("edge_index", "edge_counts"))
    return [each.tolist() for each in (edges, blobs, *pictures, *rows)]


def circles_by(board: Board, core: str, counts: dict[str, int], size: tuple[int, int]) -> list[list[int]]:
    """Circles of the blobs that have a ball's form: the thesis looks for no others."""
    blobs, models = (buffer(board, core, name)[0] for name in ("blob_data", "models"))
    circles = buffer(board, core, "circles")[0].reshape(-1, CIRCLE_WORDS)[: counts[f"circles_{core}"]]
    return [each.tolist() for each in circles if has_ball_form(blobs, each[CIRCLE_BLOB], models, *size)]


def up_to_circles(firmware: Firmware, steps: Steps) -> Firmware:
    """The firmware without lines, which differ, and what is made of them."""

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            with core.stage("Edge detection"):
                seen = yield from steps.rectification(core, frame, WHOLE_PICTURE)
                yield from join_groups(core, MODE.blobs.colour_groups)
                yield from steps.edge_detection(core, seen, MODE.edges, WHOLE_PICTURE)
                yield from steps.open_closing(core, seen, MODE.noise)
                blobs = yield from steps.blob_detection(core, seen, MODE.blobs)
                yield from steps.circle_detection(core, seen, blobs, MODE.ball_colours, MODE.circles)

    return replace(firmware, mains={"A": main, "B": main})


def check_same(frames: Sequence[StereoFrame], calibration: Calibration = RECTIFIED) -> int:
    """Compare what both firmwares leave of the last frame, on both cores; returns how many circles there are."""
    height, double_width = frames[0].left.shape
    plain, of_plain = run(frames, up_to_circles(tinyphoon, PLAIN).calibrated(calibration))
    other, of_other = run(frames, up_to_circles(thesis, THESIS).calibrated(calibration))
    counts, others = (dict(each.frames[-1].results) for each in (of_plain, of_other))
    found = 0
    for core in "AB":
        assert [counts[f"{name}_{core}"] for name in SAME] == [others[f"{name}_{core}"] for name in SAME]
        assert left_by(plain, core, counts) == left_by(other, core, counts)
        circles = circles_by(plain, core, counts, (double_width // 2, height))
        assert circles == circles_by(other, core, counts, (double_width // 2, height))
        found += len(circles)
    return found


@pytest.mark.parametrize(("width", "height"), [(4, 3), (10, 5), (34, 50), *exhaustive((160, 121))])
def test_pictures_of_any_size(width: int, height: int) -> None:
    """Coloured squares: many groups of edges and blobs of all colours, after another frame."""
    check_same(random_frames(width, height, count=2))


@pytest.mark.exhaustive
def test_the_built_in_recording() -> None:
    """Its second frame: the ball is in it."""
    with RecordingReader(RECORDING) as reader:
        assert (
            check_same(list(reader.frames(2)), Calibration(size=FrameSize(reader.width, reader.height))) == 2
        )


@pytest.mark.parametrize("width", [6, 34, *exhaustive(160)])
def test_pictures_that_a_table_rectifies(width: int) -> None:
    """Tables with pixels from nowhere; each core has its own."""
    sources = {
        "A": nearest(*source_points(width, 50, barrel=0.06, turn_deg=1.0, down_px=2.5)),
        "B": nearest(*source_points(width, 50, barrel=0.03, turn_deg=-0.7, down_px=-3)),
    }
    check_same(random_frames(width, 50, count=1), Calibration(sources=sources))


def test_pictures_that_are_rectified_have_a_table_too() -> None:
    """As the robot's always had; it leaves each pixel where it is."""
    rng = np.random.default_rng(3)
    camera, sources = rng.integers(0, 256, 2 * 8 * 2, np.uint8), untouched(FrameSize(8, 2))
    places = (sources.rows * 8 + sources.columns).astype(np.int32)
    moved = np.empty(4, np.uint32)
    move_row(camera, camera.view(np.uint32), places[1], moved)
    np.testing.assert_array_equal(moved.view(np.uint8), camera[16:])


@pytest.mark.parametrize(("firmware", "is_kept"), [(tinyphoon, True), (thesis, False)])
def test_the_opening_knows_no_models(firmware: Firmware, is_kept: bool) -> None:
    """Pairs of two hues in turn, both of the ball: the thesis erodes bit by bit (T §5.2.3), so that nothing is left of it."""
    turns = np.radians(np.tile([21.5, 22.5], (20, 5)) * 360 / 28)
    picture = np.full((20, 40), 150, np.uint8)
    picture[:, 0::4], picture[:, 2::4] = 128 + 60 * np.sin(turns), 128 + 60 * np.cos(turns)
    board, _ = run(stereo((picture, picture)), firmware)
    opened = buffer(board, "A", "opened_image")[1:-1, 1:-1] & YELLOW
    assert opened.all() if is_kept else not opened.any()


@pytest.mark.parametrize(("firmware", "blobs"), [(tinyphoon, 0), (thesis, 1)])
def test_the_marks_of_both_teams_are_sought(firmware: Firmware, blobs: int) -> None:
    """The rules give each team a colour (T §2.3): red, and cyan."""
    turn = np.radians(12.5 * 360 / 28)
    picture = np.full((20, 40), 150, np.uint8)
    picture[:, 0::4], picture[:, 2::4] = 128 + 60 * np.sin(turn), 128 + 60 * np.cos(turn)
    _, outcome = run(stereo((picture, picture)), firmware)
    assert dict(outcome.frames[0].results)["blobs_A"] == blobs


def test_the_circles_of_the_balls_that_the_thesis_erodes_for() -> None:
    """A blob without a ball's form costs no erosion, and no circle is found for it."""
    form = np.zeros(BLOB_WORDS, np.uint32)
    form[COLOURS], form[DOWN] = YELLOW, pair(10, 29)
    models = model_words(MODELS)
    for right, is_ball in ((23, 0), (24, 1), (35, 1), (36, 0)):  # 14, 15, 26 and 27 columns by 20 rows
        form[ACROSS] = pair(10, right)
        assert has_ball_form(form, 0, models, 64, 64) == is_ball
    form[COLOURS] = BLUE
    form[ACROSS] = pair(10, 29)
    assert has_ball_form(form, 0, models, 64, 64) == 0


@pytest.mark.parametrize("name", ["checkerboard of five pixels", "slopes", "coloured columns", "noise"])
def test_extremes(name: str) -> None:
    """As far as the stores have room for what they show."""
    picture = EXTREMES[name](40, 30)
    check_same(stereo((picture, picture[::-1].copy())))


def test_edges_beyond_the_store_are_those_at_the_bottom() -> None:
    """The store fills from the top, as the thesis has it; the built-in firmware thins edges out everywhere."""
    noise = np.random.default_rng(5).integers(0, 256, (240, 640), np.uint8)
    board, outcome = run(stereo((noise, np.zeros_like(noise))), thesis)
    counts = buffer(board, "A", "edge_counts")[0]
    assert dict(outcome.frames[0].results)["edges_lost_A"] > 1000
    assert "those at the bottom" in thesis.losses["edges_lost"]
    assert counts[20:40].min() > 0
    assert counts[-20:].max() == 0


def labels_of(picture: Sequence[str]) -> list[list[int]]:
    """Labels of the pixels that are not blank, renamed by the table; all of them are counted."""
    words = np.array([[int(pixel != " ") for pixel in row] for row in picture], np.uint32)
    labels, table = np.zeros(words.shape, np.uint16), np.zeros(64, np.uint16)
    used = 0
    for y in range(1, len(words) - 1):
        used = label_row(words[y], labels[y - 1], labels[y], table, 1, used)
    numbers, records, segments = np.zeros(64, np.uint16), np.zeros(8 * BLOB_WORDS, np.uint32), 0
    for y, row in enumerate(labels):
        segments = rename_and_count_row(row, table, numbers, records, 1, y, segments)
    assert records[PIXELS::BLOB_WORDS][1 : segments + 1].sum() == (words != 0).sum()
    return labels.tolist()


def test_labels_that_meet_become_the_smaller_one() -> None:
    """T Figure 2.7.b: two arms meet below; what touches by a corner only belongs to it, too."""
    found = labels_of(["       ", " #   # ", " #   # ", "  ###  ", "     # ", "       "])
    assert found == [
        [0, 0, 0, 0, 0, 0, 0],
        [0, 1, 0, 0, 0, 1, 0],
        [0, 1, 0, 0, 0, 1, 0],
        [0, 0, 1, 1, 1, 0, 0],
        [0, 0, 0, 0, 0, 1, 0],
        [0, 0, 0, 0, 0, 0, 0],
    ]


def test_labels_are_renamed_from_the_pixel_above_to_the_one_on_the_left() -> None:
    """T Figure 2.7.b: no pixel to come has a neighbour outside of that; and as far as the table is in use."""
    above, here = np.full(5, 2, np.uint16), np.array([2, 2, 0, 0, 0], np.uint16)
    table = np.array([0, 1, 2, 3, 2], np.uint16)
    assert met(2, 1, above, here, 2, table, 4) == 1
    assert above.tolist() == [2, 2, 1, 1, 1]
    assert here.tolist() == [1, 1, 0, 0, 0]
    assert table.tolist() == [0, 1, 1, 3, 2]


def test_weak_gradients_have_no_direction() -> None:
    """T §2.1.4: step 3 has removed them before step 4 asks for one."""
    gx, gy = np.zeros(3, np.int16), np.full(3, 40, np.int16)
    directions = np.full(3, 7, np.uint8)
    direct_strong_row(gx, gy, np.array([9, 10, 11], np.uint8), arctangent_table(), directions, 10)
    assert directions.tolist() == [7, 64, 64]


def segment(direction: int, start: tuple[int, int], end: tuple[int, int]) -> np.ndarray:
    """A table with one line of four edges behind an empty place."""
    table = np.zeros((2, SEGMENT_WORDS), np.int32)
    table[1, [EDGES, DIRECTION, TURN]] = 4, direction, 0
    table[1, [START_X, START_Y, END_X, END_Y]] = *start, *end
    return table.ravel()


@pytest.mark.parametrize(
    ("direction", "x", "y", "place"),
    [
        (0, 21, 31, 1),  # a steep line: below its end
        (8, 21, 31, 1),  # within the angle range
        (9, 21, 31, NONE),
        (0, 22, 31, NONE),  # not next to the end
        (0, 10, 10, NONE),  # its start is none of the ends that are compared
    ],
)
def test_an_edge_continues_the_line_whose_end_it_lies_next_to(
    direction: int, x: int, y: int, place: int
) -> None:
    """T §5.2.2, step 1."""
    table = segment(0, (10, 10), (20, 30))
    assert continued_line(table, x, y, direction, 8, 4) == place


def test_a_line_that_becomes_flat_from_the_right_to_the_left_is_continued_at_its_start() -> None:
    """The special case of T §5.2.2: the scan goes from the left to the right."""
    table = segment(64, (10, 30), (40, 28))
    assert continued_line(table, 9, 31, 64, 8, 4) == 1
    assert continued_line(table, 41, 28, 64, 8, 4) == 1


def test_the_borders_of_a_square_are_four_lines() -> None:
    """By both scans."""
    luma = np.full((80, 80), 40, np.uint8)
    luma[20:60, 20:60] = 200
    frames = stereo((grey_uyvy(luma), grey_uyvy(luma)))
    for firmware in (tinyphoon, thesis):
        _, outcome = run(frames, firmware)
        assert dict(outcome.frames[0].results)["lines_A"] == 4
